"""Bad inputs of all kinds of files, drawn by Hypothesis: one sentence, or finite numbers. The rest
is the bench's."""

from __future__ import annotations

from pathlib import Path

import pytest
import tomli_w
from hypothesis import HealthCheck, given, settings

from support.bad_inputs import (
    BadInput,
    Outcome,
    attempt,
    bad_inputs,
    draw_inputs,
    is_sentence,
)
from support.bad_sections import bad_sections
from support.right_files import newer_sections, right_files

COUNT = 250


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("inputs")


@pytest.mark.parametrize("kind", right_files())
def test_what_is_changed_is_right_at_first(folder: Path, kind: str) -> None:
    for table in right_files()[kind]:
        content = tomli_w.dumps(table).encode()
        outcome = attempt(BadInput(kind, {"input.toml": content}, "nothing"), folder)
        assert (outcome.status, outcome.fault) == ("accepted", ""), (outcome.sentence, table)


def test_newer_sections_are_right_at_first(folder: Path) -> None:
    """And their changes are the same for the same number."""
    for name, section in newer_sections().items():
        content = tomli_w.dumps(section.table).encode()
        outcome = attempt(BadInput(section.kind, {"input.toml": content}, "nothing"), folder)
        assert (outcome.status, outcome.fault) == ("accepted", ""), (name, outcome.sentence)
    first, again = (list(bad_sections(46, 3)) for _ in range(2))
    assert first == again and {bad.section for bad in first} == set(newer_sections())


def test_bad_inputs_are_refused_or_make_sense(
    tmp_path_factory: pytest.TempPathFactory, folder: Path
) -> None:
    @settings(
        derandomize=True,
        max_examples=COUNT,
        deadline=None,
        database=None,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
    )
    @given(bad_inputs(tmp_path_factory.mktemp("right")))
    def each(bad: BadInput) -> None:
        outcome = attempt(bad, folder)
        assert not outcome.fault, (outcome, outcome.content)

    each()


def test_the_same_number_draws_the_same_inputs(folder: Path) -> None:
    drawn: list[list[BadInput]] = [[], []]
    for inputs in drawn:
        draw_inputs(20, 5, folder, inputs.append)
    assert drawn[0] == drawn[1] and len(drawn[0]) == 20


def test_faults_are_found(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is no sentence, an unexpected error and a number that is not finite are faults."""
    assert (
        not is_sentence("two\nlines of text")
        and not is_sentence(2000 * "x")
        and not is_sentence("\x1b[31m red text")
    )

    def outcome(use: object) -> Outcome:
        monkeypatch.setitem(attempt.__globals__["USES"], "drive", use)
        return attempt(BadInput("drive", {"input.toml": b""}, ""), folder)

    assert outcome(lambda _: 1 / 0).status == "traceback"
    assert outcome(lambda _: "not finite: x").fault == "not finite: x"
    assert outcome(lambda _: "").fault == ""
