"""The stress cycle by renaming teeth: that of a whole turn, the same on any number of ranks,
restartable."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

import swgpar
from support.pancake import loaded_pancake, pancake
from support.paths import RECIPE
from support.stepping import WORLD, loaded, rotate, small
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.evaluation.stress_cycle import StressCycle, sector_stress
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.load.load_sequence import load_sequence

SAMPLED = ("steps.samples=2", "steps.rotation=9.0")
WITH = ("fatigue.size_factor=1.0", "losses.loss_factor=3e-4")


def sampled(model: str, layout: str, comm: MPI.Comm) -> StressCycle:
    """The cycle of the small drive from two angles of a period."""
    design = small(model, *SAMPLED, *WITH, f"drive.layout={layout}")
    stepper, _ = loaded(design, comm)
    cycle = StressCycle(stepper.model, load_sequence(design))
    cycle.keep(stepper.load_state, stepper.model.stresses()[1][FLEXIBLE_SPLINE])
    rotate(stepper, 0.5 * design.kinematics.period_angle)
    cycle.keep(stepper.load_state, stepper.model.stresses()[1][FLEXIBLE_SPLINE])
    assert cycle.complete
    return cycle


@pytest.mark.parametrize("layout", ["ring_fixed", "spline_fixed"])
@pytest.mark.parallel(1)
def test_renaming_teeth_gives_the_turn(layout: str) -> None:
    """Stress at all nodes of one tooth while the wave generator passes it, angle by angle."""
    cycle = sampled("plane", layout, MPI.COMM_SELF)
    nodes, renamed = cycle.history()
    assert len(nodes) == len(cycle.nodes) and len(renamed) == 2 * cycle.body.layout.count
    stepper, _ = loaded(cycle.model.design, MPI.COMM_SELF)
    body, found = stepper.model.elements.bodies[FLEXIBLE_SPLINE], []
    for k in range(len(renamed)):
        if k:
            rotate(stepper, 0.5 * k * cycle.model.design.kinematics.period_angle)
        found.append(
            sector_stress(body, stepper.model.stresses()[1][FLEXIBLE_SPLINE])[0, cycle.nodes]
        )
    assert np.abs(np.array(found) - renamed).max() < 1e-6 * np.abs(renamed).max()


def require_renamed(stepper: LoadStepper, pitches: int | None, tolerance: float) -> None:
    """The stress at all nodes of the first modelled sector over so many pitches, all for None, is
    that of the teeth before it in the first state; tolerance : of the largest stress"""
    design, model = stepper.design, stepper.model
    cycle, body = StressCycle(model, load_sequence(design)), model.elements.bodies[FLEXIBLE_SPLINE]
    cycle.keep(stepper.load_state, model.stresses()[1][FLEXIBLE_SPLINE])
    _, renamed = cycle.history()
    assert len(renamed) == body.layout.count
    for pitch in range(1, len(renamed) if pitches is None else pitches + 1):
        for half in (0.5, 0.0):
            rotate(stepper, (pitch - half) * design.kinematics.period_angle)
        found = sector_stress(body, model.stresses()[1][FLEXIBLE_SPLINE])[0, cycle.nodes]
        assert np.abs(found - renamed[pitch]).max() < tolerance * np.abs(renamed).max()
    assert np.abs(renamed[1] - renamed[0]).max() > 1e-2 * np.abs(renamed).max()


@pytest.mark.parallel(1)
def test_renaming_teeth_in_the_cup() -> None:
    """While the wave generator passes all teeth, pitch by pitch."""
    design = small("cup", "steps.samples=1", "steps.rotation=9.0", *WITH)
    require_renamed(loaded(design, MPI.COMM_SELF)[0], None, 1e-6)


@pytest.mark.parametrize("layout", ["ring_fixed", "spline_fixed"])
@pytest.mark.parallel(1)
def test_renaming_teeth_in_the_pancake(layout: str) -> None:
    """Its spline turns with the dynamic spline, which is the output or stands."""
    design = pancake(f"drive.layout={layout}", "steps.samples=1", "steps.rotation=9.0", *WITH)
    require_renamed(loaded_pancake(design, MPI.COMM_SELF)[0], 2, 1e-5)


@pytest.mark.parametrize("model", ["plane", "cup"])
@pytest.mark.parallel([1, 2, 3])
def test_any_number_of_ranks_gives_the_same(model: str) -> None:
    together, alone = (
        sampled(model, "ring_fixed", WORLD),
        sampled(model, "ring_fixed", MPI.COMM_SELF),
    )
    mine, stress = together.history()
    nodes, expected = alone.history()
    expected = expected[:, np.searchsorted(nodes, mine)]
    parallel_assert(len(mine) < len(nodes) or WORLD.size == 1)
    parallel_assert(bool(np.abs(stress - expected).max() < 1e-6 * np.abs(expected).max()))


@pytest.mark.parallel([1, 2])
def test_a_run_restarts(tmp_path: Path) -> None:
    """Interrupted after its first angle, the run has the same fatigue and losses."""
    tmp_path = Path(WORLD.bcast(str(tmp_path)))
    design = small("plane", *SAMPLED, *WITH)
    whole = swgpar.run(design, RECIPE, comm=WORLD)

    class Stop(Exception):
        pass

    from swgpar.analysis.run_drive import run_drive
    from swgpar.run_options import RunOptions

    def stop() -> None:
        raise Stop

    recipe = swgpar.load_mesh(RECIPE)
    with pytest.raises(Stop):
        run_drive(design, RunOptions(tmp_path / "out", recipe, comm=WORLD, on_increment=stop))
    again = swgpar.run(design, RECIPE, tmp_path / "out", restart=True, comm=WORLD)
    for part in ("fatigue", "losses"):
        parallel_assert(
            same(asdict(getattr(whole.summary, part)), asdict(getattr(again.summary, part))), part
        )
    opened = swgpar.open_result(tmp_path / "out")
    for result in (again, opened):
        safety = result.fatigue.fields["safety_goodman"]
        parallel_assert(
            safety.min() <= whole.summary.fatigue.least["goodman"].safety * (1.0 + 1e-9)
        )
        parallel_assert(
            len(result.fatigue_cycle["normal_stress_MPa"]) == whole.summary.fatigue.phases
        )
        parallel_assert(len(result.losses["bearing_Nmm"]) == 2)


def same(a: object, b: object) -> bool:
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[name], b[name]) for name in a)
    return a == pytest.approx(b, rel=1e-6) if isinstance(a, float) else a == b
