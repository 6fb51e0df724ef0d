"""Optimisation on a gear train of milliseconds: search, restart, failed designs, refusals,
files."""

from __future__ import annotations

import time
import tomllib
from pathlib import Path
from typing import Any

import pytest
from mpi4py import MPI

import swgpar
from support.optimisation import FREQUENCY, OPTIMISATION
from swgpar.errors import InputError, OutputError, SwgparError
from swgpar.input.toml_file import to_toml
from swgpar.optimisation.problem import Evaluation, Problem
from swgpar.optimisation.search import JOURNAL
from swgpar.optimisation.tried_designs import read_tried

pytest.importorskip("optuna")


def written(folder: Path, **changes: str) -> Path:
    text = OPTIMISATION
    for old, new in changes.items():
        assert f"\n{old} = " in text
        text = "\n".join(
            f"{old} = {new}" if line.startswith(f"{old} = ") else line for line in text.splitlines()
        )
    path = folder / "search.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_search_goes_on_after_a_restart_and_leaves_its_files(tmp_path: Path) -> None:
    out = tmp_path / "out"
    begun = swgpar.optimise(written(tmp_path), out)
    assert begun.evaluations[0].values["mesh.stiffness"] == 2e9
    with pytest.raises(OutputError, match="--restart"):
        swgpar.optimise(written(tmp_path), out)
    found = swgpar.optimise(written(tmp_path, evaluations="30"), out, restart=True)
    assert len(begun.evaluations) == 12 and len(found.evaluations) == 30
    assert {number: found.evaluations[number] for number in begun.evaluations} == begun.evaluations
    for each in found.evaluations.values():
        # a mass below zero is refused, and the search goes on
        assert (each.status == "failed") == (each.values["gear_1.mass"] <= 0.0)
        if each.status == "infeasible":
            assert each.quantities["damping ratio 1"] > 0.5
    feasible = {
        n: each.quantities[FREQUENCY]
        for n, each in found.evaluations.items()
        if each.status == "feasible"
    }
    (best,) = found.best
    assert feasible[best] == max(feasible.values())
    # the design file of the winner gives what was found
    design = swgpar.load_design(out / "best" / f"evaluation_{best}.toml")
    assert swgpar.check(design)[FREQUENCY] == pytest.approx(feasible[best], rel=1e-12)
    page = (out / "optimise.html").read_text(encoding="utf-8")
    assert page.count("data:image/png") >= 1 and FREQUENCY in page
    assert len((out / "optimise.csv").read_text(encoding="utf-8").splitlines()) == 31
    with pytest.raises(InputError, match="another problem"):
        swgpar.optimise(written(tmp_path, high="1e12"), out, restart=True)


def test_designs_that_were_tried_so_far(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The table has them while the search goes on."""
    path, out, evaluate = written(tmp_path, evaluations="4"), tmp_path / "out", Problem.evaluate
    known = []

    def looked(problem: Problem, values: Any, comm: MPI.Comm) -> Evaluation:
        if (out / "optimise.csv").exists():
            known.append(len(read_tried(path, out).evaluations))
        return evaluate(problem, values, comm)

    monkeypatch.setattr(Problem, "evaluate", looked)
    swgpar.optimise(path, out)
    assert known == [1, 2, 3]


def test_two_objectives_give_a_front_in_a_database(tmp_path: Path) -> None:
    path = written(tmp_path)
    url = f"sqlite:///{tmp_path / 'search.db'}"
    text = path.read_text(encoding="utf-8").replace(
        "evaluations = 12", f'evaluations = 16\nstorage = "{url}"'
    )
    path.write_text(
        f'{text}\n[[optimise.objective]]\nquantity = "damping ratio 2"\n', encoding="utf-8"
    )
    found = swgpar.optimise(path, tmp_path / "out")
    values = {n: found.evaluations[n].quantities for n in found.best}
    for first in values.values():
        assert not any(
            second[FREQUENCY] > first[FREQUENCY]
            and second["damping ratio 2"] < first["damping ratio 2"]
            for second in values.values()
        )
    assert (tmp_path / "search.db").exists() and not (
        tmp_path / "out" / "optimise.journal"
    ).exists()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"high": "1e8"}, "above 1e"),
        ({"quantity": '"no such thing"'}, "no such thing"),
        ({"keys": '["mesh.stifness"]'}, "stifness"),
        ({"at_most": "'much'"}, "at_most"),
        ({"goal": '"maximize"'}, "maximize"),
        (
            {"first": '[{ "mesh.stiffness" = 2e12 }]'},
            r"2e\+12 is out of range: allowed 1000000000 to 1e\+11",
        ),
        ({"first": '[{ "mesh.stiffness" = "2e9" }]'}, '"2e9" is out of range: allowed 1000000000'),
        ({"first": '[{ "gear_2.mass" = 1.0 }]'}, "gear_2.mass is no variable: allowed mesh"),
    ],
)
def test_a_bad_file_is_refused_in_one_sentence(
    tmp_path: Path, changes: dict[str, str], words: str
) -> None:
    with pytest.raises(InputError, match=words) as refusal:
        swgpar.optimise(written(tmp_path, **changes), tmp_path / "out")
    assert "\n" not in str(refusal.value)


def test_a_variable_below_a_value_is_refused(tmp_path: Path) -> None:
    """No design would take it."""
    path = written(tmp_path)
    text = path.read_text(encoding="utf-8").replace('["gear_1.mass", "', '["gear_1.mass.x", "')
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"gear_1\.mass\.x = .* cannot be applied"):
        swgpar.optimise(path, tmp_path / "out")


def test_toml_that_is_written_reads_the_same() -> None:
    table: dict[str, Any] = {
        "a": {"x": 1.5e-7, "y": [1, 2], "text": 'quoted "ä"', "on": True, "inner": {"z": -3}},
        "load": {"program": [{"name": "up", "torque": 2.0}, {"name": "down", "torque": 0.0}]},
        "lists": {
            "texts": ["a  b", "c, d,", "e\nf"],
            "more": ["[", "x],"],
            "nested": [[1, 2], [3.0]],
            "none": [],
        },
    }
    assert tomllib.loads(to_toml(table)) == table
    assert tomllib.loads(to_toml({**table, "left_out": None})) == table
    assert "y = [1, 2]\n" in to_toml(table)


@pytest.mark.parametrize(
    ("url", "words"),
    [
        ("sqlite:///:memory:", "is in the memory of one process, and lost at its end"),
        ("sqlite://", "is in the memory of one process, and lost at its end"),
        ("postgresql://me:se@cret@host/name", "is no URL of a database"),
        ("postgresql://me:secret@host:12cret/name", "is no URL of a database"),
        ("secret", "is no URL of a database"),
        ("nothing://me:secret@host/name", "the storage nothing name cannot be used"),
    ],
)
def test_a_storage_that_cannot_be_used_keeps_its_password(
    tmp_path: Path, url: str, words: str
) -> None:
    path = written(tmp_path)
    text = path.read_text(encoding="utf-8").replace(
        "evaluations = 12", f'evaluations = 2\nstorage = "{url}"'
    )
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SwgparError, match=words) as caught:
        swgpar.optimise(path, tmp_path / "out")
    assert "cret" not in str(caught.value)


def test_a_name_that_is_taken_in_a_database_is_not_overwritten(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'search.db'}"
    for high in ("1e11", "1e12"):
        path = written(tmp_path, high=high)
        text = path.read_text(encoding="utf-8").replace(
            "evaluations = 12", f'evaluations = 2\nstorage = "{url}"'
        )
        path.write_text(text, encoding="utf-8")
        if high == "1e11":
            swgpar.optimise(path, tmp_path / "out")
    with pytest.raises(InputError, match="another database, from which --overwrite removes noth"):
        swgpar.optimise(path, tmp_path / "out", overwrite=True)


def test_a_lock_that_a_killed_search_has_left_is_none(tmp_path: Path) -> None:
    out = tmp_path / "out"
    swgpar.optimise(written(tmp_path, evaluations="2"), out)
    (out / f"{JOURNAL}.lock").symlink_to(out / JOURNAL)
    begin = time.monotonic()
    found = swgpar.optimise(written(tmp_path, evaluations="3"), out, restart=True)
    # Optuna takes such a lock over after 30 s
    assert len(found.evaluations) == 3 and time.monotonic() - begin < 25.0


def test_a_kill_while_designs_are_given_loses_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import optuna

    given = [2e9, 3e9, 4e9, 5e9]
    first = ", ".join(f'{{ "mesh.stiffness" = {value} }}' for value in given)
    path, out = written(tmp_path, evaluations="4", first=f"[{first}]"), tmp_path / "out"
    enqueue, calls = optuna.Study.enqueue_trial, 0

    def killed(study: optuna.Study, *arguments: Any, **keywords: Any) -> None:
        nonlocal calls
        calls += 1
        if calls == 3:
            raise KeyboardInterrupt
        enqueue(study, *arguments, **keywords)

    with monkeypatch.context() as context:
        context.setattr(optuna.Study, "enqueue_trial", killed)
        with pytest.raises(KeyboardInterrupt):
            swgpar.optimise(path, out)
    found = swgpar.optimise(path, out, restart=True)
    tried = sorted(each.values["mesh.stiffness"] for each in found.evaluations.values())
    assert tried == given
