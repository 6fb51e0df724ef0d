"""Runs of a session share models, windows and states, and find what each finds alone."""

from __future__ import annotations

import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

import swgpar
from support.paths import RECIPE
from support.stepping import small
from swgpar.analysis import coarse_start, model_sources
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.errors import ConvergenceError
from swgpar.largest_stress.window_recipes import LEVELS
from swgpar.load.load_states import LoadState
from swgpar.petsc import PETSc
from swgpar.solve import bordered_system
from swgpar.solve.bordered_system import BorderedSystem
from swgpar.solve.factor_reuse import ReusedFactor
from swgpar.systems import Result

WORLD = MPI.COMM_WORLD
ALONE = ("steps.rotation=0", "output.fields=false", "output.root_stress=true")
CHANGES = ("load.torque=0.2", "load.torque=0.3", "flexible_spline.rim=0.45")
"""A first run, one under another load, and one of another drive."""
SOLVED = {"root.s1": 1e-5, "root.s1_on_mesh": 1e-6, "torque": 1e-6}
"""Relative differences that solves leave: Newton's iteration of the drive ends at 1e-6 of the
contact force, that of windows at 1e-4, which changes stresses by up to 1e-5 (`RTOL` of
`local_problem`)."""
REPEATED = 1e-10
"""The same of a run that shares nothing. Sums of a factor depend on where arrays lie in memory, and
Newton's iteration of windows ends long before round-off: the same run gives one of two values of
`root.s1`, 6e-12 apart."""


@pytest.fixture
def built(monkeypatch: pytest.MonkeyPatch) -> list[None]:
    """One entry for each model that is built."""
    build, count = model_sources.build_drive_model, []
    monkeypatch.setattr(
        model_sources,
        "build_drive_model",
        lambda *keys, **more: count.append(None) or build(*keys, **more),
    )
    return count


def values(result: Result) -> dict[str, float]:
    answers = {name: result.summary[name].value for name in SOLVED if name in result.summary}
    return answers | {"torque": float(result.history["wg_torque_Nmm"][-1])}


@pytest.mark.parallel([1])
def test_runs_of_a_session_find_what_each_finds_alone(
    built: list[None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(LEVELS, "plane", 3)
    with swgpar.Session() as session:
        for change in CHANGES:
            design = small("plane", *ALONE, change)
            before = len(built)
            shared = values(session.run(design, RECIPE))
            models = len(built) - before
            alone = values(swgpar.run(design, RECIPE))
            loaded = change == "load.torque=0.3"
            parallel_assert((models == 0) == loaded, f"{models} models for {change}")
            for name, value in alone.items():
                allowed = SOLVED[name] if loaded else REPEATED
                near = shared[name] == pytest.approx(value, rel=allowed)
                parallel_assert(near, f"{name}, {change}: {shared[name]} and {value}")


@pytest.mark.parallel([1])
def test_a_state_that_was_reached_step_by_step_is_a_start_for_another_torque(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As of teeth that overlap, which have no start from the bent shape."""

    def fails(stepper: LoadStepper) -> None:
        raise ConvergenceError("no start from the bent shape")

    monkeypatch.setattr(coarse_start, "_jump", fails)
    designs = [
        small("plane", *ALONE[:2], "output.root_stress=false", f"load.torque={torque}")
        for torque in (0.2, 0.3)
    ]
    with swgpar.Session() as session:
        first, second = (session.run(design, RECIPE) for design in designs)
    parallel_assert(len(first.history["step"]) == 3)
    parallel_assert(len(second.history["step"]) == 1)
    alone = values(swgpar.run(designs[1], RECIPE))
    for name, value in values(second).items():
        parallel_assert(value == pytest.approx(alone[name], rel=SOLVED[name]), name)


def test_a_drive_that_is_near_begins_with_the_loaded_state(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of the other one, and with its factor, which the first step uses: its answers are those of a
    run alone; one that is farther away begins by itself."""
    begun: list[bool] = []
    steps: list[str] = []
    advance, solve, factorise = LoadStepper.advance, ReusedFactor.solve, BorderedSystem.factorise

    def with_old_factor(reused: ReusedFactor, right: PETSc.Vec, x: PETSc.Vec) -> bool:
        steps.append("old factor")
        return solve(reused, right, x)

    def with_new_factor(system: BorderedSystem) -> None:
        steps.append("new factor")
        factorise(system)

    def noted(stepper: LoadStepper, target: LoadState, *, cut_back: bool = True) -> None:
        begun.append(not cut_back)
        advance(stepper, target, cut_back=cut_back)

    monkeypatch.setattr(LoadStepper, "advance", noted)
    monkeypatch.setattr(bordered_system, "DEAR", 0.0)
    monkeypatch.setattr(ReusedFactor, "solve", with_old_factor)
    monkeypatch.setattr(BorderedSystem, "factorise", with_new_factor)
    # an old factor leaves a residual just below the tolerance, of which the torque shows more
    one, near, far = (
        small(
            "plane",
            *ALONE,
            "output.root_stress=false",
            "solver.rtol=1e-8",
            f"flexible_spline.rim={rim}",
        )
        for rim in (0.45, 0.446, 0.43)
    )
    nearer = near.with_values({"flexible_spline.rim": 0.444})
    with swgpar.Session(starts_near=True) as session:
        session.run(one, RECIPE)
        steps.clear()
        shared = values(session.run(near, RECIPE))
        assert begun.count(True) == 1
        assert steps[0] == "old factor"
        steps.clear()
        session.run(nearer, RECIPE)  # from the last one, which has the factor
        assert begun.count(True) == 2
        assert steps[0] == "old factor"
        session.run(far, RECIPE)
    assert begun.count(True) == 2
    alone = values(swgpar.run(near, RECIPE))
    for name, value in alone.items():
        assert shared[name] == pytest.approx(value, rel=SOLVED[name])


def test_a_session_keeps_the_models_that_were_used_last(built: list[None]) -> None:
    first, second = (
        small("plane", *ALONE, "output.root_stress=false", f"flexible_spline.rim={rim}")
        for rim in (0.45, 0.4)
    )
    with swgpar.Session(models=1) as session:
        counts = []
        for design in (first, first, second, first):
            session.run(design, RECIPE)
            counts.append(len(built))
    assert counts == [1, 1, 2, 3]
    session.run(first, RECIPE)  # after its end it begins anew
    assert len(built) == 4
    session.close()


@pytest.mark.parametrize("models", [0, 101, "two"])
def test_the_number_of_models_is_checked(models: object) -> None:
    with pytest.raises(swgpar.InputError, match="models = "):
        swgpar.Session(models)  # type: ignore[arg-type]
