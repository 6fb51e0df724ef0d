"""The views of the table of answers: terminal, report, quantities and summary.json have the same
numbers."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

import swgpar
from support.paths import DATA
from swgpar.answers.answer import NO_ESTIMATE, declared_answers, joined_error, known_quotient
from swgpar.drive_results.report_checks import checks
from swgpar.drive_results.summary import ANSWER_GROUPS
from swgpar.drive_results.summary_file import summary_from, summary_to_json
from swgpar.presentation import terminal
from swgpar.presentation.answer_text import error_text, value_text
from swgpar.presentation.drive_report import drive_report
from swgpar.results import history
from swgpar.results.folder import StoredSummary
from swgpar.systems.drive import DRIVE

FOLDERS = sorted((DATA / "first_format").iterdir())


@pytest.fixture(params=FOLDERS, ids=lambda folder: folder.name)
def result(request: pytest.FixtureRequest) -> swgpar.DriveResult:
    return swgpar.open_result(request.param)


@pytest.mark.parametrize("width", [60, 80])
def test_numbers_and_remarks_are_whole_on_a_narrow_terminal(
    width: int, result: swgpar.DriveResult, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    with open(tmp_path / "out.txt", "w+", encoding="utf-8") as file:
        monkeypatch.setattr(
            terminal, "console", Console(file=file, width=width, highlight=False, soft_wrap=True)
        )
        terminal.print_drive(result.history, result.summary)
        file.seek(0)
        text = file.read()
    rows = text.splitlines()
    for answer in result.summary.values():
        if answer.detail:
            continue
        ending = " ".join(
            filter(None, (value_text(answer.value, answer.error), error_text(answer), answer.unit))
        )
        assert any(" ".join(row.split()).endswith(ending.replace("\u00a0", " ")) for row in rows), (
            answer.name
        )
    assert all(remark in text for group in result.summary.groups() for remark in group.remarks())
    assert "…" not in text
    shown = text[: text.index(next(iter(result.summary.groups())).TITLE)].split()
    for name, (heading, form) in terminal.COLUMNS.items():
        if name in result.history:
            values = [format(v, form) for v in result.history[name][: result.summary.increments]]
            assert all(value in shown for value in values), heading


def test_the_report_has_every_answer_by_its_name(result: swgpar.DriveResult) -> None:
    page = drive_report(result).decode()
    for name, answer in result.summary.items():
        assert f">{name}<" in page and f">{value_text(answer.value, answer.error)}<" in page


def test_the_file_has_the_table_and_gives_the_same_summary_again(
    result: swgpar.DriveResult,
) -> None:
    content = json.loads(summary_to_json(result.summary))
    assert [answer["name"] for answer in content["answers"]] == list(result.summary)
    assert [answer["value"] for answer in content["answers"]] == list(
        DRIVE.measure(result).values.values()
    )
    rows = history.read_history(result.folder / history.NAME)
    assert summary_from(StoredSummary.model_validate(content), rows, result.pairs) == result.summary


def test_an_answer_says_what_it_is() -> None:
    summary = swgpar.open_result(DATA / "first_format" / "plane").summary
    root = summary["root.s1"]
    assert (
        root.unit == "MPa"
        and root.error == summary.root_stress.total_error
        and "tooth root of tooth" in root.place
    )
    assert summary["largest.rg_vm"].remark.startswith("below the contact of teeth")
    assert summary["residue.torque"].value < summary["residue.torque"].limit
    assert summary["fatigue.goodman"].value == summary.fatigue.least["goodman"].safety
    assert "bearing.largest_load" not in summary and summary.get("bearing.largest_load") is None


def test_a_part_of_an_error_that_is_not_known_leaves_no_estimate() -> None:
    assert joined_error(3.0, 4.0) == pytest.approx(5.0)
    assert joined_error(3.0, None) is None and joined_error(3.0, float("inf")) is None
    result = swgpar.open_result(DATA / "first_format" / "plane")
    summary = result.summary
    assert summary["root.s1"].error > 0.0 and summary["root.mean_s1"].error > 0.0
    unknown = replace(summary.root_stress, drive_error=None)
    answers = {answer.name: answer for answer in unknown.answers()}
    for name in ("root.s1", "root.mean_s1", "root.maximum_s1"):
        assert answers[name].error is None and answers[name].no_error == NO_ESTIMATE
        assert error_text(answers[name]) == "no\u00a0estimate"
    assert "root.s1_error" not in answers
    for found, good in ((summary, True), (replace(summary, root_stress=unknown), None)):
        verdicts = {check.name: check.good for check in checks(found, result.history)}
        assert verdicts["resolution"] is good


def test_quotients_of_round_off_have_no_value() -> None:
    assert known_quotient(3.0, -2.0, 1.9) == -1.5
    assert known_quotient(3.0, 1e-9, 1e-8) is None and known_quotient(0.0, 0.0, 0.0) is None
    rotation = replace(
        swgpar.open_result(DATA / "first_format" / "plane").summary.rotation, torque_ripple=None
    )
    (answer,) = (one for one in rotation.answers() if one.name == "rotation.torque_ripple")
    assert answer.value is None and value_text(answer.value) == "—"
    assert answer.remark.startswith("the mean input torque") and not error_text(answer)


DECLARING = ("evaluation", "largest_stress")
"""Rooms whose evaluations declare answers."""


def answer_name() -> re.Pattern[str]:
    """Matches the names of all answers; upper-case words stand for parts."""
    kinds = [kind for group in ANSWER_GROUPS.values() for kind in declared_answers(group)]
    return re.compile("|".join(re.sub("[A-Z]{3,}", ".+", re.escape(kind.name)) for kind in kinds))


def indexed_by_text(tree: ast.AST) -> Iterator[str]:
    """Where a summary is indexed, or asked for a text."""
    for node in ast.walk(tree):
        table = node.value if isinstance(node, ast.Subscript) else None
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            table = node.func.value if node.func.attr == "get" else None
        if table is not None:
            owner = ast.unparse(table).removesuffix(".quantities")
            if owner.rpartition(".")[2] == "summary":
                yield ast.unparse(node)


def named_answers(tree: ast.AST, name: re.Pattern[str]) -> Iterator[str]:
    """Names of answers that stand in a source as a text."""
    constants = (node.value for node in ast.walk(tree) if isinstance(node, ast.Constant))
    return (one for one in constants if isinstance(one, str) and name.fullmatch(one))


def test_answers_are_reached_by_their_kinds() -> None:
    """The name of an answer is written where it is declared. Others import its `AnswerKind`."""
    package, name, found = Path(swgpar.__file__).parent, answer_name(), []
    for path in package.rglob("*.py"):
        room, text = path.relative_to(package).parts[0], path.read_text(encoding="utf-8")
        if "summary" not in text and not name.search(text):
            continue
        tree = ast.parse(text)
        if room != "drive_results":
            found += [(path.name, one) for one in indexed_by_text(tree)]
        if room not in ("drive_results", *DECLARING):
            found += [(path.name, one) for one in named_answers(tree, name)]
    assert not found


def test_a_text_is_seen() -> None:
    """What the test above forbids."""
    texts = 'summary.get("a"), result.summary["a"], summary.quantities["a"]'
    tree = ast.parse(f'{texts}, x["root.s1"], y.get(1)')
    assert len(list(indexed_by_text(tree))) == 3
    assert list(named_answers(tree, answer_name())) == ["root.s1"]
