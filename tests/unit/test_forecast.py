"""Forecast of a run: counts are those of the model, needs grow with them, what does not fit is
refused."""

from __future__ import annotations

from pathlib import Path

import pytest
from mpi4py import MPI

import swgpar
from support.bearing import BEARING
from support.paths import DESIGN, DRIVERS, RECIPE, REFERENCE
from support.small_drive import PLANE
from swgpar.analysis.forecast import (
    NEEDS,
    WITH_BEARING,
    Forecast,
    forecast,
    free_memory,
    reported_memory,
    require_memory,
)
from swgpar.errors import InputError, OutOfMemoryError
from swgpar.meshing import load_recipe
from swgpar.model.drive_model import build_drive_model
from swgpar.petsc import PETSc

THICK_CUP = ("cup.thickness_coef=0.9", "cup.fillet_radius=2.0")
BACK_FILLET = ("cup.back_fillet=0.1",)
HOUSING = ("ring_gear.housing.thickness=4",)
BALLS = (*BEARING, "micro_geometry.wg_slope=0")
HELD = (*HOUSING, "ring_gear.housing.outside=held")


@pytest.mark.parametrize(
    "overrides",
    [
        (),
        ("drive.layout=spline_fixed",),
        ("solver.symmetry=false",),
        THICK_CUP,
        BACK_FILLET,
        PLANE,
        HOUSING,
        (*PLANE, *HOUSING),
        (*PLANE, *HELD),
        (*PLANE, *HELD, "drive.layout=spline_fixed"),
        BALLS,
        (*BALLS, "wave_generator.bearing.race_width=2.5"),
        (*PLANE, *BALLS),
    ],
)
def test_counts_are_those_of_the_model(overrides: tuple[str, ...]) -> None:
    design, recipe = swgpar.load_design(DESIGN, overrides), load_recipe(RECIPE)
    found = forecast(design, recipe)
    model = build_drive_model(design, recipe, comm=MPI.COMM_SELF)
    counts = model.counts().values()
    assert (found.elements, found.unknowns) == (
        model.n_elements(),
        sum(count["dofs"] for count in counts),
    )
    model.destroy()


def test_needs_grow_with_the_mesh() -> None:
    design = swgpar.load_design(REFERENCE)
    coarse, full = (forecast(design, load_recipe(name)) for name in ("coarse", "full"))
    # measured on two ranks: docs/verification/forecast.md
    assert coarse.memory == pytest.approx(1.9, rel=0.25) and full.memory == pytest.approx(
        4.0, rel=0.25
    )
    assert full.seconds > 2.5 * coarse.seconds


def test_what_does_not_fit_is_refused() -> None:
    require_memory(Forecast(1, 1, 0.8 * free_memory(), 1.0))
    require_memory(Forecast(1, 1, 1e6, 1.0), limit=2e6)
    words = (
        "1 elements and 1 unknowns, which need about 1e[+]06 GB of memory: allowed are meshes that "
        "need at most"
    )
    with pytest.raises(
        InputError, match=f"{words} the .* GB that are free; solver.memory_limit sets another limit"
    ):
        require_memory(Forecast(1, 1, 1e6, 1.0))
    with pytest.raises(InputError, match=f"{words} solver.memory_limit = 10 GB"):
        require_memory(Forecast(1, 1, 1e6, 1.0), limit=10.0)


def test_a_run_that_does_not_fit_is_refused_before_it_is_meshed(tmp_path: Path) -> None:
    """Nothing of the size of the mesh is built, and no folder is made."""
    counts = {"tip": 40, "layers": 40, "flank": 400, "root": 200, "under": 100, "rim": 100}
    cup = {"cylinder": 400, "fillet": 100, "closed_end": 400}
    recipe = {
        "flexible_spline": counts,
        "ring_gear": counts,
        "face_width": {"elements": 400},
        "cup": cup,
    }
    for design in (REFERENCE, DRIVERS / "plane_half_turn.toml"):
        with pytest.raises(
            InputError, match=r"the mesh has [0-9,]* elements and .* GB of memory: allowed"
        ):
            swgpar.run(
                swgpar.load_design(design, {"solver.memory_limit": 2.0}), recipe, tmp_path / "run"
            )
    assert not (tmp_path / "run").exists()


def test_an_allocation_that_fails_is_one_sentence() -> None:
    needs = forecast(swgpar.load_design(DESIGN), load_recipe(RECIPE))
    for error in (MemoryError(), PETSc.Error(55)):
        message = "not enough memory: [0-9,]* unknowns need about .* GB on all ranks"
        with pytest.raises(OutOfMemoryError, match=message), reported_memory(needs):
            raise error
    with pytest.raises(ValueError, match="^other$"), reported_memory(needs):
        raise ValueError("other")


def test_a_check_with_a_mesh_prints_the_needs() -> None:
    without, found = swgpar.check(DESIGN), swgpar.check(DESIGN, mesh=RECIPE)
    assert found["unknowns modelled"] > 0 and set(without) < set(found)
    with pytest.raises(InputError, match="has no mesh"):
        swgpar.check(DRIVERS / "ring_supported.toml", mesh="coarse")


def test_time_grows_with_increments_programs_and_turns() -> None:
    recipe = load_recipe(RECIPE)

    def seconds(*overrides: str) -> float:
        return forecast(swgpar.load_design(DESIGN, [*PLANE, *overrides]), recipe).seconds

    usual = seconds("steps.rotation=40", "steps.increment=2")  # one period is sampled
    assert seconds("steps.rotation=0") == usual
    many = seconds("steps.samples=0", "steps.rotation=3600", "steps.increment=0.01")
    assert many == pytest.approx(360e3 / (4 + 6) * usual, rel=1e-3)
    stages = ["{name='a', torque=0.1, points=60}", "{name='b', torque=0.2, points=36}"]
    program = seconds("steps.rotation=0", f"load.program=[{', '.join(stages)}]")
    assert program == pytest.approx((4 + 96) / (4 + 6) * usual)
    loop = seconds("steps.rotation=0", "stiffness.torque=0.2", "stiffness.positions=50")
    assert loop > 20.0 * usual
    # angles of turns: on their own mesh, with the linear model or without
    plain, model = "deviations.linear_model=false", "deviations.linear_model=true"
    turns = {
        (count, linear): seconds("steps.rotation=0", f"deviations.turns={count}", linear) - usual
        for count in (5, 10)
        for linear in (plain, model)
    }
    assert turns[10, plain] == pytest.approx(2.0 * turns[5, plain])
    assert 0.0 < turns[10, model] < 0.5 * turns[10, plain]


def test_balls_take_time() -> None:
    recipe = load_recipe(RECIPE)
    rigid, balls = (forecast(swgpar.load_design(DESIGN, more), recipe) for more in ((), BALLS))
    growing, more = (one.seconds - NEEDS["cup"].seconds_base for one in (rigid, balls))
    assert balls.unknowns > rigid.unknowns
    assert more == pytest.approx(WITH_BEARING * growing * balls.unknowns / rigid.unknowns)
