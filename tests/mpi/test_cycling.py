"""Active sets that return: found, and left by the descending line search."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

from swgpar.load.load_states import Stage
from swgpar.log import PhaseTimes
from swgpar.petsc import PETSc
from swgpar.solve.active_set_cycles import VisitedSets, fingerprint, is_exhausted
from swgpar.solve.convergence_test import ConvergenceTest, NewtonVerdict
from swgpar.solve.discrete_problem import ResidualInfo
from swgpar.solve.line_search import LineSearch
from swgpar.solve.solve_state import NewtonSettings, SolveState

WORLD = MPI.COMM_WORLD


@dataclass
class Block:
    """A block on a spring that sticks to the ground: k x + mu min(1, |x| / width) sign(x) = f, a
    convex potential.

    Below mu it sticks, and slipping either way the tangent k of the slip sends it to slip the other
    way.
    Stands for the linear solver too (`BorderedSystem`), with a multiplier that nothing uses.
    """

    width: float
    k: float = 1.0
    mu: float = 1.0
    f: float = 0.9

    def __post_init__(self) -> None:
        self.partition = SimpleNamespace(comm=MPI.COMM_SELF, n_multipliers=3, has_multipliers=True)
        self.x = PETSc.Vec().createSeq(6, comm=MPI.COMM_SELF)
        self.x.array[0] = 2.0

    def sticks(self) -> bool:
        return bool(abs(self.x.array_r[0]) < self.width)

    def sets(self) -> list[np.ndarray]:
        return [np.array([self.sticks()]), np.sign(self.x.array_r[:1])]

    def residual(self, x: PETSc.Vec, force: PETSc.Vec) -> bool:
        slip = x.array_r[0]
        force.array[0] = self.k * slip + self.mu * np.clip(slip / self.width, -1.0, 1.0) - self.f
        return False

    def apply(self, pc: None, right: PETSc.Vec, step: PETSc.Vec) -> None:
        step.array[:] = right.array_r / (self.k + (self.mu / self.width if self.sticks() else 0.0))


def newton(block: Block, watch: bool, longest: float = 1e9) -> tuple[float, int, bool]:
    """Last residual, iterations, and whether active sets have returned."""
    search, visited = LineSearch(block, block.residual, block.x, PhaseTimes()), VisitedSets()
    search.max_node_step = longest
    force = block.x.duplicate()
    step = block.x.duplicate()
    returned = False
    k = 0
    block.residual(block.x, force)
    while force.norm() > 1e-12 and k < 50:
        returned = (
            visited.returns(fingerprint(MPI.COMM_SELF, block.sets()), force.norm()) or returned
        )
        search.descending = watch and returned
        search.apply(None, force, step)
        block.x.axpy(-1.0, step)
        block.residual(block.x, force)
        k += 1
    return force.norm(), k, returned


def test_block_that_sticks_within_reach_needs_no_descending_search() -> None:
    residual, iterations, returned = newton(Block(width=1e-2), watch=False)
    assert residual < 1e-12 and iterations < 10 and not returned


def test_cycle_is_found_and_left() -> None:
    """Where sticking takes a trillionth of the step, the usual search slips to and fro for ever."""
    residual, iterations, returned = newton(Block(width=1e-12), watch=False)
    assert residual > 0.1 and iterations == 50 and returned
    residual, iterations, _ = newton(Block(width=1e-12), watch=True)
    assert residual < 1e-12 and iterations < 15


@dataclass
class Valleys(Block):
    """A potential x^4 / 4 - x^2 / 2: concave between its minima at -1 and 1."""

    def residual(self, x: PETSc.Vec, force: PETSc.Vec) -> bool:
        force.array[0] = x.array_r[0] ** 3 - x.array_r[0]
        return False

    def apply(self, pc: None, right: PETSc.Vec, step: PETSc.Vec) -> None:
        step.array[:] = right.array_r / (3.0 * self.x.array_r[0] ** 2 - 1.0)


@pytest.mark.parametrize(("start", "end"), [(0.45, 1.0), (-0.45, -1.0), (0.55, 1.0)])
def test_indefinite_tangent_leads_down_all_the_same(start: float, end: float) -> None:
    """Newton's own steps go uphill and across; a bounded one the other way ends in the valley it
    starts above."""
    valleys = Valleys(width=1.0)
    valleys.x.array[0] = start
    residual, iterations, _ = newton(valleys, watch=False, longest=0.2)
    assert residual < 1e-12 and iterations < 15
    assert valleys.x.array_r[0] == pytest.approx(end)


@dataclass
class Quadratic(Block):
    """A node and three multipliers; the minimum of the potential is one Newton step away from
    zero."""

    NEWTON = np.array([0.3, 0.0, 0.4, 7.0, 0.0, 0.0])

    def residual(self, x: PETSc.Vec, force: PETSc.Vec) -> bool:
        force.array[:] = x.array_r + self.NEWTON
        return False

    def apply(self, pc: None, right: PETSc.Vec, step: PETSc.Vec) -> None:
        step.array[:] = right.array_r


@pytest.mark.parametrize(("bound", "share"), [(0.25, 0.5), (0.5, 1.0), (np.inf, 1.0)])
def test_displacement_of_a_node_is_bounded(bound: float, share: float) -> None:
    """In space, and without the multipliers, which have other units."""
    drive = Quadratic(width=1.0)
    drive.x.set(0.0)
    search = LineSearch(drive, drive.residual, drive.x, PhaseTimes())
    search.max_node_step = bound
    right, step = drive.x.duplicate(), drive.x.duplicate()
    drive.residual(drive.x, right)
    search.apply(None, right, step)
    np.testing.assert_allclose(step.array_r, share * Quadratic.NEWTON, rtol=1e-14)


def test_residuals_that_fall_get_more_iterations() -> None:
    slow = [0.9**k for k in range(40)]  # halves within seven
    stuck = slow[:20] + [slow[19]] * 20
    assert not any(is_exhausted(slow[:k], 10) for k in range(1, 40))
    assert (
        is_exhausted(stuck, 10) and not is_exhausted(stuck, 40) and not is_exhausted(stuck[:22], 10)
    )


CREEP = [0.4 * 0.95**k for k in range(8)]


def convergence_test(
    *, symmetric: bool = True, round_off: float = 0.0, torque_norm: float = np.inf
) -> ConvergenceTest:
    """Of a problem with or without friction, and with a norm (N) of the torque's forces."""
    problem = Mock(
        round_off=round_off, force_floor=1.0, active_sets=lambda state: [], symmetric=symmetric
    )
    problem.partition.comm = WORLD
    problem.supports.torque_norm = lambda state: torque_norm
    return ConvergenceTest(problem, NewtonSettings(1e-9, 25, 0, 1.0))


@pytest.mark.parametrize(
    ("residuals", "stage", "softened", "slow"),
    [
        (CREEP, Stage.LOAD, False, True),
        (CREEP, Stage.ROTATE, False, True),
        (CREEP, Stage.PROGRAM, False, False),  # teeth may pass
        (CREEP, Stage.LOAD, True, False),  # once in a solve
        (CREEP[:5], Stage.LOAD, False, False),
        ([0.4 * 0.8**k for k in range(8)], Stage.LOAD, False, False),  # halves within five
        ([2.0 * r for r in CREEP], Stage.LOAD, False, False),  # contacts are being approached
        ([0.02 * r for r in CREEP], Stage.LOAD, False, False),  # near the solution
    ],
)
def test_contact_that_spreads_slowly(
    residuals: list[float], stage: Stage, softened: bool, slow: bool
) -> None:
    state = SolveState(Mock(stage=stage), [], 200, residuals=residuals, softened=softened)
    test = convergence_test()
    decision = test.decide(
        state, len(residuals), 1.0, ResidualInfo(1.0, False), descending=True, bounded=False
    )
    assert (decision.verdict is NewtonVerdict.SLOW) == slow


@pytest.mark.parametrize(("stage", "slow"), [(Stage.LOAD, True), (Stage.ROTATE, False)])
def test_contact_with_friction_that_spreads_slowly(stage: Stage, slow: bool) -> None:
    """In a rotation the state depends on the contacts on the way."""
    test = convergence_test(symmetric=False)
    state = SolveState(Mock(stage=stage), [], 200, residuals=CREEP)
    decision = test.decide(
        state, len(CREEP), 1.0, ResidualInfo(1.0, False), descending=True, bounded=False
    )
    assert (decision.verdict is NewtonVerdict.SLOW) == slow
    assert slow or decision.verdict is NewtonVerdict.GO_ON


def test_the_round_off_of_a_distorted_state_is_no_equilibrium() -> None:
    """Its tangent has a round-off above any force."""
    test = convergence_test(round_off=1e6)
    for residual, verdict in ((700.0, NewtonVerdict.GO_ON), (1e-6, NewtonVerdict.CONVERGED)):
        state = SolveState(Mock(stage=Stage.LOAD), [], 200, residuals=[residual])
        last = ResidualInfo(1.0, False)
        decision = test.decide(state, 0, residual, last, descending=True, bounded=False)
        assert decision.verdict is verdict


@pytest.mark.parametrize(
    ("torque_norm", "verdict"), [(1e-6, NewtonVerdict.GO_ON), (1e-3, NewtonVerdict.CONVERGED)]
)
def test_a_drive_that_floats_under_a_small_torque_is_not_loaded(
    torque_norm: float, verdict: NewtonVerdict
) -> None:
    """Its residual is that of the torque, and below the tolerance of the contact forces."""
    test = convergence_test(torque_norm=torque_norm)
    state = SolveState(Mock(stage=Stage.LOAD), [], 9)
    last, residual = ResidualInfo(1e3, False), 1e-6
    state.residuals.append(residual / test.reference(state.load_state, last))
    decision = test.decide(state, 1, residual, last, descending=True, bounded=False)
    assert decision.verdict is verdict
    assert decision.goal == pytest.approx(min(1e-2 * torque_norm, 1e-6))


def test_sets_that_return() -> None:
    visited = VisitedSets()
    assert [
        visited.returns(*seen) for seen in ((1, 5.0), (1, 6.0), (2, 9.0), (1, 4.0), (2, 8.0))
    ] == [False] * 5
    assert visited.returns(1, 4.0)  # left meanwhile, and no smaller residual than before
    assert not visited.returns(2, 7.0)


@pytest.mark.parallel([1, 2, 3])
def test_fingerprint_is_that_of_all_ranks() -> None:
    points = np.arange(12) % 3 == 0
    first = fingerprint(WORLD, [points, points[:5]])
    parallel_assert(first == fingerprint(WORLD, [points.copy(), points[:5]]))
    parallel_assert(len(set(WORLD.allgather(first))) == 1)
    parallel_assert(first != fingerprint(WORLD, [points[:5], points]))
    changed = points.copy()
    changed[-1] ^= WORLD.rank == WORLD.size - 1  # on one rank only
    parallel_assert(first != fingerprint(WORLD, [changed, points[:5]]))
