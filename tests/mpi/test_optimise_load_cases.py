"""A search over load cases of a small plane drive, a rating sheet among them: the same on one rank
and on two, and as the runs alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

import swgpar
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar.api.ratings import load_rated_design
from swgpar.input.toml_file import to_toml
from swgpar.rating.rows import rating_rows

pytest.importorskip("optuna")

WORLD = MPI.COMM_WORLD
BENT = ["steps.bent_start=true", "steps.rotation=0", "output.root_stress=false"]
STIFFNESS = [
    "stiffness.torque=0.2",
    "stiffness.positions=1",
    "stiffness.points=1",
    "stiffness.mesh_error=false",
]
PEAK = ["load.torque=0.3"]
RATING = {"rated_torque": 0.2, "K1": 1.0}
SEARCH: dict[str, Any] = {
    "mesh": str(RECIPE),
    "parallel": "ranks",
    "set": [*PLANE, *BENT],
    "evaluations": WORLD.size,  # of the second one ranks are compared only
    "sampler": "random",
    "load_case": [
        {"name": "peak", "without": ["rating"], "set": PEAK},
        {"name": "wind-up", "without": ["rating"], "set": STIFFNESS},
        {"name": "sheet", "rate": True, "set": STIFFNESS},
    ],
    "variable": [{"keys": ["flexible_spline.rim"], "low": 0.5, "high": 0.7}],
    "objective": [{"case": "peak", "quantity": "sharing.largest_force"}],
    "constraint": [
        {"case": "wind-up", "quantity": "stiffness.K1", "at_least": 1.0},
        {"case": "sheet", "quantity": "margin of stiffness K1", "at_least": 0.0},
        {"case": "sheet", "quantity": "yield of teeth and rim", "at_least": 0.0},
        {"case": "sheet", "quantity": "stiffness K1", "verdict": "passes"},
        {"case": "sheet", "quantity": "headline", "verdict": "not judged"},
    ],
}


@pytest.mark.parallel([1, 2])
def test_load_cases_and_a_rating_sheet(tmp_path: Path) -> None:
    folder = Path(WORLD.bcast(str(tmp_path)))
    table = swgpar.load_design(DESIGN).model_dump(exclude_unset=True)
    table |= {"rating": RATING}
    if WORLD.rank == 0:
        (folder / "drive.toml").write_text(to_toml(table), encoding="utf-8")
        content = {"optimise": {"design": "drive.toml", **SEARCH}}
        (folder / "search.toml").write_text(to_toml(content), encoding="utf-8")
    WORLD.Barrier()
    found = swgpar.optimise(folder / "search.toml", folder / "out")
    parallel_assert(found.start == 0 and found.evaluations[0].values["flexible_spline.rim"] == 0.6)
    if WORLD.size > 1:
        alone = swgpar.optimise(
            folder / "search.toml", tmp_path / f"alone_{WORLD.rank}", comm=MPI.COMM_SELF
        )
        for number, one in found.evaluations.items():
            other = alone.evaluations[number]
            parallel_assert(one.values == other.values and one.status == other.status, one.reason)
            parallel_assert(one.quantities == pytest.approx(other.quantities, rel=1e-4))
            parallel_assert(one.verdicts == other.verdicts)

    # the start design as it is written
    start, drive = found.evaluations[0], swgpar.load_design(DESIGN, [*PLANE, *BENT])
    options: dict[str, Any] = {"mesh": RECIPE, "comm": MPI.COMM_SELF, "plain": True}
    peak = swgpar.run(swgpar.load_design(drive, PEAK), **options).summary["sharing.largest_force"]
    wound = swgpar.run(swgpar.load_design(drive, STIFFNESS), **options).summary["stiffness.K1"]
    rated = load_rated_design(table, [*PLANE, "steps.bent_start=true", *STIFFNESS])
    place = tmp_path / f"rating_{WORLD.rank}"
    sheet = swgpar.rate(rated, place, mesh=RECIPE, comm=MPI.COMM_SELF)
    rows = {one.name: one for one in sheet.verdicts}
    units = {one.name: one.unit for one in rating_rows(rated)}
    answers = {name: one.answer for name, one in rows.items() if one.answer is not None}
    parallel_assert({name: one.unit for name, one in answers.items()}.items() <= units.items())
    expected = {
        "peak: sharing.largest_force": peak.value,
        "wind-up: stiffness.K1": wound.value,
        "sheet: margin of stiffness K1": rows["stiffness K1"].margin,
        "sheet: yield of teeth and rim": rows["yield of teeth and rim"].answer.value,
    }
    parallel_assert(start.quantities == pytest.approx(expected, rel=1e-4))
    parallel_assert(
        start.verdicts == {"sheet: stiffness K1": "passes", "sheet: headline": str(sheet.headline)}
    )
