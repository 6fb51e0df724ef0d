"""The rating sheet of a small plane drive, from its design to its files, on one rank and on two."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

import swgpar
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar.answers.verdict import Judgement
from swgpar.api.ratings import load_rated_design
from swgpar.errors import OutputError
from swgpar.results.table import read_columns

WORLD = MPI.COMM_WORLD
LIMITS = {"rated_torque": 0.2, "K1": 1.0, "efficiency": 0.999}
DRIVE = [*PLANE, "steps.rotation=0", "stiffness.positions=1", "stiffness.mesh_error=false"]


def design(**limits: Any) -> swgpar.DriveDesign:
    drive = swgpar.load_design(DESIGN, DRIVE)
    rating = {**LIMITS, **limits}
    return load_rated_design(drive, {"rating": rating, "fatigue": {}, "losses": {}})


def judgements(sheet: swgpar.RatingSheet) -> dict[str, Judgement]:
    return {one.name: one.judgement for one in sheet.verdicts}


def same(one: dict[str, Any], other: dict[str, Any]) -> bool:
    """Whether two rows say the same, apart from round-off and what a solver's tolerance leaves."""
    for name in ("value", "error"):
        a, b = one[name], other[name]
        near = a == b if a is None or b is None else a == pytest.approx(b, rel=1e-4, abs=1e-9)
        if not near:
            return False
    numbers = ("value", "error", "remark")  # remarks have numbers too
    return all(one[name] == other[name] for name in one if name not in numbers)


@pytest.mark.parallel([1, 2])
def test_a_rating_from_the_design_to_its_files(tmp_path: Path) -> None:
    """The same sheet on any number of ranks; finished runs are kept, also with other limits."""
    out = Path(WORLD.bcast(str(tmp_path))) / "rating"
    sheet = swgpar.rate(design(), out, mesh=RECIPE)
    parallel_assert([run.status for run in sheet.runs] == ["finished"] * 3)
    found = judgements(sheet)
    parallel_assert(found["stiffness K1"] == Judgement.PASSES)
    parallel_assert(found["efficiency"] == Judgement.FAILS)
    parallel_assert(found["stiffness K2"] == Judgement.NOT_JUDGED)
    parallel_assert(sheet.headline == Judgement.FAILS)
    content = json.loads((out / "rating.json").read_text(encoding="utf-8"))
    table = read_columns(out / "rating.csv")
    parallel_assert(content["headline"] == "fails")
    parallel_assert([row["row"] for row in content["rows"]] == table["row"].tolist())
    parallel_assert("The drive fails: " in (out / "rating.html").read_text(encoding="utf-8"))

    alone = swgpar.rate(design(), tmp_path / f"alone_{WORLD.rank}", mesh=RECIPE, comm=MPI.COMM_SELF)
    parallel_assert([same(*each) for each in zip(sheet.rows, alone.rows)] == [True] * len(found))

    with pytest.raises(OutputError, match="already holds a rating"):
        swgpar.rate(design(), out, mesh=RECIPE)
    seconds = [run.wall_s for run in sheet.runs]
    again = swgpar.rate(design(efficiency=0.001), out, mesh=RECIPE, restart=True)
    parallel_assert([run.wall_s for run in again.runs] == seconds)
    parallel_assert(judgements(again)["efficiency"] == Judgement.PASSES)
    other = swgpar.rate(design(K1=2.0, rated_torque=0.25), out, mesh=RECIPE, restart=True)
    parallel_assert({run.status for run in other.runs} == {"finished"})
    kept = {run.name: run.wall_s for run in other.runs if run.wall_s in seconds}
    parallel_assert(list(kept) == ["no load"])


@pytest.mark.parallel([1, 2])
def test_a_run_that_fails_leaves_its_rows_without_a_verdict(tmp_path: Path) -> None:
    out = Path(WORLD.bcast(str(tmp_path))) / "rating"
    limited = design().with_values({"solver.time_limit": 1e-6})
    sheet = swgpar.rate(limited, out, mesh=RECIPE)
    parallel_assert({run.status for run in sheet.runs} == {"failed"})
    by_name = {one.name: one for one in sheet.verdicts}
    parallel_assert("time" in by_name["stiffness K1"].why)
    parallel_assert(sheet.headline == Judgement.NOT_JUDGED)
