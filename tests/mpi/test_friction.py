"""Friction in the small drive: balance, work, ranks, the limit of no friction; the same tests on 1,
2 and 3 ranks."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from mpi4py import MPI

from support.friction_work import FrictionWork
from support.stepping import MODELS, WORLD, assert_agree, rotate, small
from support.stepping import loaded as under_torque
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.load.load_states import LoadState
from swgpar.solve.solve_state import SolveResult

PITCH = 2.0 * np.pi / 42


def loaded(friction: float, comm: MPI.Comm = WORLD, model: str = "cup") -> LoadStepper:
    return under_torque(small(model, f"contact.friction={friction}"), comm)[0]


def test_input_work_is_output_work_and_dissipation() -> None:
    """Over a pitch, from a state that has forgotten the start: the torque exceeds T / ratio by the
    friction's work.

    Work by the trapezoidal rule over all increments, cut ones too: the slip of the points in
    contact before and after.
    """
    samples, torque, ratio = 24, 2000.0, 20.0
    stepper = loaded(0.1)
    first = rotate(stepper, 0.2 * PITCH)
    work = FrictionWork(stepper)
    rows = [rotate(stepper, (0.2 + k / samples) * PITCH) for k in range(1, samples + 1)]
    for r in rows:
        assert (
            abs(r["wg_torque_Nmm"] + r["tooth_torque_Nmm"] + r["output_torque_Nmm"]) < 1e-6 * torque
        )
    # the state repeats but for what is left of the start
    assert rows[-1]["wg_torque_Nmm"] == pytest.approx(first["wg_torque_Nmm"], rel=1e-3)
    excess = (np.mean([r["wg_torque_Nmm"] for r in rows]) - torque / ratio) * PITCH
    dissipated = work.whole()
    print(f"work over a pitch: input less output {excess:.4f}, friction {dissipated:.4f} N mm")
    assert excess > 0.05 * torque / ratio * PITCH
    # the two rules differ by 4.7 % with 12 samples and by less than 3 % with 24 and 36
    assert dissipated == pytest.approx(excess, rel=0.03)


def assert_same(a: dict[str, float], b: dict[str, float], rel: float) -> None:
    names = (
        "wg_torque_Nmm",
        "tooth_torque_Nmm",
        "output_angle_deg",
        "max_penetration_mm",
        "pairs_in_contact",
    )
    assert_agree(a, b, names, rel)


@pytest.mark.parallel(2)
@pytest.mark.parametrize("model", MODELS)
def test_any_number_of_ranks_gives_the_same(model: str) -> None:
    several, one = (
        rotate(loaded(0.1, comm, model), 0.3 * PITCH) for comm in (WORLD, MPI.COMM_SELF)
    )
    assert_same(several, one, 1e-8)


@pytest.mark.parametrize("model", MODELS)
def test_vanishing_friction_is_none(model: str) -> None:
    """The full matrix and its LU give what the symmetric ones do; with friction the torque is
    another one."""
    states = [under_torque(small(model, f"contact.friction={mu}")) for mu in (0.0, 1e-9)]
    assert_same(states[1][1], states[0][1], 1e-6)
    if model == "plane":  # the rotation takes half a minute in space
        none, little = (rotate(stepper, 0.3 * PITCH) for stepper, _ in states)
        assert_same(little, none, 1e-6)


def test_friction_takes_torque() -> None:
    """In the plane; `test_input_work_is_output_work_and_dissipation` measures it in space."""
    none, much = (
        rotate(loaded(mu, model="plane"), 0.3 * PITCH)["wg_torque_Nmm"] for mu in (0.0, 0.1)
    )
    assert much == pytest.approx(1.079 * none, rel=0.01)


def test_load_that_friction_holds_back_is_taken_up_without_it() -> None:
    """The loaded state is then that without friction: the teeth have not slipped since."""

    def stick(stepper: LoadStepper) -> None:
        """Let the first solves under friction fail: with closed and, as no flank is pressed after
        that, with open backlash."""
        solve, failed = stepper.solver.solve, []

        def fail_once(state: LoadState, **options: Any) -> SolveResult:
            if state.friction_acts and len(failed) < 2:
                failed.append(state)
                return SolveResult(
                    converged=False, iterations=7, residual=1.0, reason="DIVERGED_MAX_IT"
                )
            return solve(state, **options)

        stepper.solver.solve = fail_once

    once = small("plane", "contact.friction=0.1", "solver.max_cutbacks=0")
    stepper, found = under_torque(once, prepare=stick)
    _, none = under_torque(small("plane"))
    _, slid = under_torque(small("plane", "contact.friction=0.1"))
    assert stepper.load_state.friction_acts
    assert stepper.iterations > 7
    assert found["wg_torque_Nmm"] == pytest.approx(none["wg_torque_Nmm"], rel=1e-6)
    assert found["wg_torque_Nmm"] != pytest.approx(slid["wg_torque_Nmm"], rel=1e-3)
