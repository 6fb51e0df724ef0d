"""What is decided after every Newton iteration: whether it goes on, and what changes before."""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np

from swgpar.load.load_states import LoadState, Stage
from swgpar.solve.active_set_cycles import (
    MIN_DECREASE,
    NEAR_PATIENCE,
    PATIENCE,
    fingerprint,
    is_decreasing,
    is_exhausted,
)
from swgpar.solve.discrete_problem import DiscreteProblem, ResidualInfo
from swgpar.solve.solve_state import NewtonSettings, Phase, SolveState
from swgpar.solve.time_limit import ending

SOFT_TOLERANCE = 0.03
"""Residual over contact force at which a run with softened contact ends. What it leaves is less
than what the next share of the stiffness changes."""

NEAR_RESIDUAL = 1e-2
"""Residual over contact force below which a state is near the solution."""

TORQUE_SHARE = 0.01
"""Residual over the norm of the torque's forces at convergence, at most.

A drive that floats in its backlash has a residual of 1. That may be little beside the forces of cam
or bearing."""

FREEZING_POWER = 0.6
"""Power of the tolerance that gives the relative residual below which cells are frozen.

Newton's iteration is then quadratic: the next step or the one after it is the last. Frozen
earlier, the state depends on the path to it. Frozen later, a solve takes some iterations more."""

MAX_REPEATED_SEARCHES = 12
"""Contact searches of a solve because nodes have moved: each begins the iteration anew."""

SEARCH_DISTANCE = 0.25
"""Displacement (modules) of a node since the last search after which there is another one."""

ROUND_OFF_SHARE = 0.05
"""Share of the round-off below which a residual counts as zero; runs reach 0.01 to 0.06 of it."""

SLOW_ITERATIONS, SLOW_RESIDUALS = 5, (NEAR_RESIDUAL, 0.5)
"""Iterations in which the residual does not halve, and its bounds, where contact spreads slowly.
Above them bounded steps approach the contacts. Below them soft contacts know no better."""

STALL = 0.3
"""Ratio of two residuals above which the iteration has stalled close to the round-off."""


class NewtonVerdict(enum.Enum):
    """How a run of Newton's iteration goes on or ends."""

    GO_ON = enum.auto()
    CONVERGED = enum.auto()
    INTERRUPTED = enum.auto()
    SLOW = enum.auto()
    EXHAUSTED = enum.auto()
    COLLAPSED = enum.auto()
    OUT_OF_TIME = enum.auto()


@dataclass(frozen=True)
class Decision:
    """What follows from a residual.

    near_solution : the cells of the flanks are to be frozen
    cycles : contacts do not settle, the cycle is to be broken
    search_is_outdated : nodes have moved far since the last contact search
    goal : N, residual at which the iteration ends at the latest; None where it has not been asked
    for
    ending : why the run ends now, empty where it goes on
    """

    verdict: NewtonVerdict
    near_solution: bool = False
    cycles: bool = False
    search_is_outdated: bool = False
    goal: float | None = None
    ending: str = ""


class ConvergenceTest:
    """Decides after every Newton iteration; changes nothing. Collective.

    problem : that is solved;  settings : tolerances and limits
    """

    def __init__(self, problem: DiscreteProblem, settings: NewtonSettings) -> None:
        self.problem, self.settings = problem, settings

    def reference(self, state: LoadState, last: ResidualInfo) -> float:
        """Force (N) that a residual is compared with: that of all contacts, or under a small torque
        what makes `TORQUE_SHARE` of its forces the tolerance."""
        of_torque = self.problem.supports.torque_norm(state) * TORQUE_SHARE / self.settings.rtol
        return min(max(last.contact_force, self.problem.force_floor), of_torque)

    def decide(
        self,
        state: SolveState,
        iteration: int,
        norm: float,
        last: ResidualInfo,
        *,
        descending: bool,
        bounded: bool,
    ) -> Decision:
        """The decision for a state whose last residual has this norm (N).

        descending : the line search descends already;  bounded : flanks may touch, so are steps
        """
        if words := ending(self.problem.partition.comm):
            return Decision(NewtonVerdict.OUT_OF_TIME, ending=words)
        if last.collapsed or not np.isfinite(norm):
            return Decision(NewtonVerdict.COLLAPSED)
        ratio, softened, rtol = state.residual, state.phase is Phase.SOFTENED, self.settings.rtol
        tolerance = SOFT_TOLERANCE if softened else rtol
        near = ratio < rtol**FREEZING_POWER and not softened
        goal = tolerance * self.reference(state.load_state, last)
        verdict, outdated, cycles = NewtonVerdict.GO_ON, False, False
        if ratio <= tolerance or self._is_round_off(state, iteration, norm):
            verdict = NewtonVerdict.CONVERGED
        else:
            if iteration > 0 and not state.incomplete_pattern:
                outdated = bounded and self._search_is_outdated(state)
            if iteration > 0 and (state.incomplete_pattern or outdated):
                verdict = NewtonVerdict.INTERRUPTED
            elif self._is_slow(state):
                verdict = NewtonVerdict.SLOW
            elif is_exhausted(state.residuals, self.settings.max_iterations):
                verdict = NewtonVerdict.EXHAUSTED
            else:
                patience = PATIENCE if ratio > NEAR_RESIDUAL else NEAR_PATIENCE
                sticks = not is_decreasing(state.residuals, patience, MIN_DECREASE)
                if sticks and state.breaker.solution is not None:
                    # a solution on frozen cells is known, and cells placed anew lead nowhere
                    verdict = NewtonVerdict.EXHAUSTED
                else:
                    cycles = not descending and (self._set_returns(state) or sticks)
        return Decision(
            verdict, near_solution=near, cycles=cycles, search_is_outdated=outdated, goal=goal
        )

    def _is_slow(self, state: SolveState) -> bool:
        """Whether contact spreads slowly under the full stiffness, for the first time in a solve.

        Steps are full ones then, and the active set grows by a face in each. In a rotation with
        friction the state would depend on the softer contacts, and in a load program that rotates
        the output soft teeth might pass.
        """
        if state.phase is not Phase.FULL or state.softened:
            return False
        stage = state.load_state.stage
        if stage > Stage.ROTATE or (stage is Stage.ROTATE and not self.problem.symmetric):
            return False
        last = state.residuals[-SLOW_ITERATIONS - 1 :]
        if len(last) <= SLOW_ITERATIONS:
            return False
        low, high = SLOW_RESIDUALS
        return min(last) > low and max(last) < high and min(last) > 0.5 * last[0]

    def _search_is_outdated(self, state: SolveState) -> bool:
        """Whether nodes have moved so far since the search that others may meet; collective."""
        if state.breaker.solution is not None or state.repeated_searches == MAX_REPEATED_SEARCHES:
            return False
        return self.problem.moved_since_search() > SEARCH_DISTANCE * self.problem.module

    def _is_round_off(self, state: SolveState, iteration: int, norm: float) -> bool:
        """Whether a residual is round-off of positions with 16 digits, or is near it and stalls.

        The tangent of a distorted state has a round-off without bounds. The residual is then no
        small one.
        """
        if state.residual > NEAR_RESIDUAL:
            return False
        stalled = iteration > 1 and state.residuals[-1] > STALL * state.residuals[-2]
        return norm <= (1.0 if stalled else ROUND_OFF_SHARE) * self.problem.round_off

    def _set_returns(self, state: SolveState) -> bool:
        """Whether an active set returns; collective."""
        sets = self.problem.active_sets(state.load_state)
        return state.visited.returns(fingerprint(self.problem.partition.comm, sets), state.residual)
