"""Equilibrium of one load state: Newton's iteration, searches, cycle breaker, augmentation.

A solve goes through phases (`Phase`), each one run of SNES, whose outcome decides which follows:

    SOFTENED   contact is being established: reduced penalties, loose tolerance
    FULL       full penalties; cells of the flanks are placed anew until the solution is near
    FROZEN     cycle breaker: frozen cells, frozen friction bounds, descending line search
    AUGMENTED  multipliers take over the pressures, until the penetration is below its tolerance
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from mpi4py import MPI

from swgpar import watch
from swgpar.errors import TimeLimitError
from swgpar.fem.vectors import create_vector
from swgpar.load.load_states import LoadState, Stage
from swgpar.log import logger
from swgpar.petsc import PETSc, accepted_options, errors_of_callbacks
from swgpar.solve.active_set_cycles import MAX_ITERATIONS_FACTOR, VisitedSets
from swgpar.solve.bordered_system import BorderedSystem
from swgpar.solve.convergence_test import ConvergenceTest, Decision, NewtonVerdict
from swgpar.solve.discrete_problem import DiscreteProblem, ResidualInfo
from swgpar.solve.line_search import LineSearch
from swgpar.solve.linear_solver import MatrixKind, reason_names
from swgpar.solve.linear_solvers import make_linear_solver
from swgpar.solve.solve_state import (
    SPREADING_PENALTIES,
    AcceptableState,
    CycleBreaker,
    IterationStatus,
    NewtonSettings,
    Phase,
    SolveResult,
    SolveState,
)

MAX_FURTHER_SEARCHES = 3
"""Further contact searches of a solve, where flanks touch that the last search left out."""

MAX_NODE_STEP = 0.2
"""Largest step (modules) of a node while flanks may touch: the tangent ignores clearances."""

SETTLED = 0.1
"""Residual over contact force above which, before the rotation, an old factor is of no use."""

MAX_FRICTION_ROUNDS, FRICTION_AGREEMENT = 20, 1e-3
"""Most problems with given friction bounds, and the relative agreement of the last two."""

PETSC_REASONS = {
    NewtonVerdict.GO_ON: None,
    NewtonVerdict.CONVERGED: PETSc.SNES.ConvergedReason.CONVERGED_FNORM_RELATIVE,
    NewtonVerdict.INTERRUPTED: PETSc.SNES.ConvergedReason.CONVERGED_ITS,
    NewtonVerdict.SLOW: PETSc.SNES.ConvergedReason.CONVERGED_ITS,
    NewtonVerdict.EXHAUSTED: PETSc.SNES.ConvergedReason.DIVERGED_MAX_IT,
    NewtonVerdict.COLLAPSED: PETSc.SNES.ConvergedReason.DIVERGED_FUNCTION_DOMAIN,
    NewtonVerdict.OUT_OF_TIME: PETSc.SNES.ConvergedReason.DIVERGED_MAX_IT,
}
"""SNES's reason for each verdict, None to go on."""

REASONS = reason_names(PETSc.SNES.ConvergedReason)

IterationMonitor = Callable[[LoadState, int, float], None]
"""Called after every Newton iteration with load state, iteration, residual over contact force."""


class NewtonSolver:
    """Solves a discrete problem for load states.

    problem : residual and tangent;  settings : tolerances and limits

    Attributes:
    visited_sets : makes what finds active sets that return, for every run;  state : of the solve
    """

    def __init__(self, problem: DiscreteProblem, settings: NewtonSettings) -> None:
        self.problem, self.settings = problem, settings
        self.convergence_test = ConvergenceTest(problem, settings)
        self.monitor: IterationMonitor | None = None
        self.state: SolveState | None = None
        self.visited_sets: Callable[[], VisitedSets] = VisitedSets
        self.last_residual = ResidualInfo(0.0, False)
        self._trial_cache: tuple[np.ndarray, np.ndarray] | None = None
        positions = problem.positions()[: problem.partition.n_own]
        kind = MatrixKind(
            problem.partition.comm,
            positions[:, : problem.partition.dims],
            problem.symmetric,
            thin=bool(problem.flanks),
        )
        if problem.blocks.linear is None:
            problem.blocks.linear = make_linear_solver(settings.linear, kind, "stiffness_")
        linear = problem.blocks.linear
        linear.kind = kind
        self.system = BorderedSystem(problem.partition, linear, reuse=settings.reuse_factor)
        self.line_search = LineSearch(self.system, self._trial_residual, problem.x, problem.phases)
        self.snes = self._create_snes()

    def _create_snes(self) -> PETSc.SNES:
        problem = self.problem
        snes = PETSc.SNES().create(comm=problem.partition.comm)
        snes.setType(PETSc.SNES.Type.NEWTONLS)
        options = PETSc.Options()
        if not options.hasName("snes_linesearch_type"):
            options["snes_linesearch_type"] = "basic"
        snes.setFunction(self._residual, create_vector(problem.partition))
        snes.setConvergenceTest(self._test_convergence)
        ksp = snes.getKSP()
        ksp.setType(PETSc.KSP.Type.PREONLY)
        ksp.getPC().setType(PETSc.PC.Type.PYTHON)
        ksp.getPC().setPythonContext(self.line_search)
        with accepted_options(problem.partition.comm):
            snes.setFromOptions()
        # SNES sees vectors of three unknowns per node. The matrix has two in the plane: only the
        # bordered system knows it.
        shell = PETSc.Mat().create(comm=problem.partition.comm)
        shell.setSizes([problem.x.getSizes()] * 2)
        shell.setType(PETSc.Mat.Type.SHELL)
        shell.setUp()
        snes.setJacobian(self._tangent, shell, shell)
        return snes

    def destroy(self) -> None:
        """Release the solvers, which refer to this object, and their matrices; collective."""
        self.snes.destroy()
        self.system.destroy()
        self.problem.destroy()

    # -- callbacks of SNES -------------------------------------------------------------------------

    def _residual(self, snes: PETSc.SNES, x: PETSc.Vec, f: PETSc.Vec) -> None:
        cached, self._trial_cache = self._trial_cache, None
        if cached is not None:
            # SNES asks for the residual at the end of the step that was tried last
            other = int(not np.array_equal(x.array_r, cached[0]))
            if not self.problem.partition.comm.allreduce(other, op=MPI.MAX):
                f.array[:] = cached[1]
                return
        self.last_residual = self.problem.residual(x, f, self.state.load_state)

    def _trial_residual(self, x: PETSc.Vec, f: PETSc.Vec) -> bool:
        """Set f to the residual at x; returns whether an element has collapsed there."""
        self.last_residual = self.problem.residual(x, f, self.state.load_state)
        self._trial_cache = x.array_r.copy(), f.array_r.copy()
        return self.last_residual.collapsed

    def _tangent(self, snes: PETSc.SNES, x: PETSc.Vec, j: PETSc.Mat, p: PETSc.Mat) -> None:
        problem, state = self.problem, self.state
        # frees PETSc objects without Python references: the last border
        PETSc.garbage_cleanup(problem.partition.comm)
        u = problem.displacement(x)
        state.pattern_misses = problem.tangent(u, state.load_state)
        missing = int(len(state.pattern_misses) > 0)
        state.incomplete_pattern = bool(problem.partition.comm.allreduce(missing, op=MPI.MAX))
        unsettled = state.load_state.stage < Stage.ROTATE and state.residuals[-1] > SETTLED
        if unsettled and not self.system.is_taken_over:
            self.system.discard_factor()
        p.stateIncrease()
        bound = problem.torque_control.output_step_bound(state.load_state)
        self._set_system(self.system, u, state.load_state, bound)

    def _set_system(
        self, system: BorderedSystem, u: np.ndarray, state: LoadState, bound: float | None
    ) -> None:
        """Border the tangent at u (n_local, 3) mm. bound : see `BorderedSystem.set_system`"""
        blocks, supports = self.problem.blocks, self.problem.supports
        ranks = supports.grounding(u), *supports.border(u, state), bound, supports.springs(u)
        system.set_system(blocks.matrix, blocks.matrix_rows.active, *ranks)

    def factorise_tangent(self, state: LoadState, other: BorderedSystem | None = None) -> None:
        """Make the factor of the tangent in the equilibrium x under a load state, for an `other`
        system, or that of this solver; collective. `discard_factor` ends its use."""
        problem, system, u = self.problem, other or self.system, self.problem.displacement()
        problem.complete_tangent(u, state)
        self._set_system(system, u, state, np.inf if state.control == "torque" else None)
        system.factorise()

    def take_over_factor(self, other: NewtonSolver) -> None:
        """Begin with the factor of a problem that is near, with the same numbers of the same nodes;
        the other solver, if it solves again, makes a new one. Collective."""
        if self.system.take_over(other.system):
            linear, others = self.problem.blocks, other.problem.blocks
            linear.linear, others.linear = others.linear, linear.linear

    def _test_convergence(
        self, snes: PETSc.SNES, its: int, norms: tuple[float, float, float]
    ) -> int | None:
        """Convergence test of SNES: its reason, or None to go on."""
        state, norm = self.state, norms[2]
        state.residuals.append(
            norm / self.convergence_test.reference(state.load_state, self.last_residual)
        )
        watch.doing(state.words(self.problem.x.getSize() // 3, its))
        if self.monitor is not None:
            self.monitor(state.load_state, its, state.residual)
        decision = self.convergence_test.decide(
            state,
            its,
            norm,
            self.last_residual,
            descending=self.line_search.descending,
            bounded=bool(np.isfinite(self.line_search.max_node_step)),
        )
        self._act(decision, its)
        return PETSC_REASONS[decision.verdict]

    def _act(self, decision: Decision, its: int) -> None:
        """Do what has been decided after Newton iteration `its`, before the next one."""
        self.state.ending = decision.ending
        self.state.outdated_search = decision.search_is_outdated
        if decision.goal is not None:
            self.system.set_goal(decision.goal)
        if decision.near_solution:
            self.problem.cells.freeze()
        self.state.slow = decision.verdict is NewtonVerdict.SLOW
        if self.state.slow:
            logger.info("   contact spreads slowly in Newton iteration %d: softer for a while", its)
        if decision.cycles:
            what = "cells anew" if self.state.cells_may_be_stale else "descending line search"
            logger.info("   contacts do not settle in Newton iteration %d: %s", its, what)
            self._break_cycle()

    def _break_cycle(self) -> None:
        """Place stale cells anew; else search descending, once per solve with all frozen."""
        state = self.state
        if state.cells_may_be_stale:  # all ranks took over cells, or none
            self.problem.cells.release()
            state.renewed, state.residuals = True, [state.residual]
            return
        self.line_search.descending = True
        if not state.breaker.started and not self.problem.cells.are_frozen():
            self.problem.cells.freeze()
            self.problem.cells.freeze_friction_bounds()
            state.breaker.active = state.breaker.started = self.problem.cells.are_frozen()
            if state.breaker.active:
                logger.info("   cells of the flanks are frozen until the contacts have settled")

    # -- solve -------------------------------------------------------------------------------------

    def solve(
        self,
        load_state: LoadState,
        *,
        softenings: Sequence[float] = (),
        max_iterations: int | None = None,
        search: bool = True,
    ) -> SolveResult:
        """Solve for equilibrium from the present x; x is the solution if the result converged.

        softenings : shares of the contacts' stiffness in rough runs before that with all of it
        max_iterations : of all phases together, at most a multiple of that of the settings; None
        for that
        search : look for pairs of flanks first; False where those of the last search are near still
        """
        self.state = state = self._begin(load_state, softenings, search)
        if max_iterations is not None:
            state.max_iterations = min(max_iterations, state.max_iterations)
        while state.result is None:
            status = self._iterate(state)
            if state.ending:
                raise TimeLimitError(state.ending_text())
            if status is IterationStatus.FAILED:
                self._after_failure(state)
            elif status is IterationStatus.SLOW:
                state.softened, state.softenings = True, list(SPREADING_PENALTIES)
            elif status is IterationStatus.INTERRUPTED:
                self._prepare_contacts(state)
                state.softenings.insert(0, state.penalty_share)
            elif state.phase is Phase.SOFTENED:
                state.breaker = CycleBreaker()
                self.problem.cells.release()
            elif state.phase is Phase.FROZEN:
                self._after_frozen(state)
            else:
                self._after_converged(state)
        state.before_augmentation = state.breaker.solution = None
        return state.result

    def _begin(
        self, load_state: LoadState, softenings: Sequence[float], search: bool
    ) -> SolveState:
        problem = self.problem
        problem.clear_unused_multipliers(load_state)
        bounded = any(flanks.is_active(load_state) for flanks in problem.flanks)
        self.line_search.max_node_step = MAX_NODE_STEP * problem.module if bounded else np.inf
        if search:
            problem.search(load_state)
        else:
            problem.reset_contacts()
        return SolveState(
            load_state,
            list(softenings),
            MAX_ITERATIONS_FACTOR * self.settings.max_iterations,
            softened=bool(softenings),
        )

    def _iterate(self, state: SolveState) -> IterationStatus:
        """One run of Newton's iteration in the present phase."""
        state.residuals, state.incomplete_pattern, state.outdated_search = [], False, False
        self._trial_cache = None
        state.visited, self.line_search.descending = self.visited_sets(), state.breaker.active
        self._set_penalty_share(state, state.softenings.pop(0) if state.softenings else 1.0)
        self.snes.setTolerances(max_it=max(1, state.max_iterations - state.iterations))
        with errors_of_callbacks():
            self.snes.solve(None, self.problem.x)
        state.iterations += self.snes.getIterationNumber()
        reason = self.snes.getConvergedReason()
        if reason < 0:
            return IterationStatus.FAILED
        if reason != PETSc.SNES.ConvergedReason.CONVERGED_ITS:
            return IterationStatus.CONVERGED
        if state.iterations >= state.max_iterations:
            return IterationStatus.FAILED
        return IterationStatus.SLOW if state.slow else IterationStatus.INTERRUPTED

    def _prepare_contacts(self, state: SolveState) -> None:
        """Search anew, or extend the pattern, as the run that was interrupted needs it."""
        if state.outdated_search:
            state.repeated_searches += 1
            # a search releases the cells and forgets the multipliers
            state.breaker, state.before_augmentation = CycleBreaker(), None
            self.problem.search(state.load_state)
        else:
            self.problem.extend_pattern(state.pattern_misses)

    def _set_penalty_share(self, state: SolveState, share: float) -> None:
        """Use this share of the contact penalties; below 1 the phase is SOFTENED."""
        if share != state.penalty_share:
            self.system.discard_factor()
        state.penalty_share = share
        self.problem.scale_penalties(share)

    def _after_failure(self, state: SolveState) -> None:
        """Go back to the solution of the cycle breaker or before an augmentation, or end."""
        self.system.discard_factor()
        breaker, before = state.breaker, state.before_augmentation
        if breaker.solution is not None and state.iterations < state.max_iterations:
            logger.info(
                "   the frozen cells stay: with cells placed anew the contacts do not settle"
            )
            x, cells = breaker.solution
            x.copy(self.problem.x)
            self.problem.cells.restore(cells)
            breaker.solution = None
        elif before is not None:
            self._take_back(state, before)
            state.result = SolveResult(True, state.iterations, before.residual, "converged")
        else:
            reason, text = self.snes.getConvergedReason(), f"{state.iterations} iterations in all"
            if reason < 0:
                text = REASONS.get(reason, str(reason))
            text = self.system.solver.failure or text
            state.result = SolveResult(False, state.iterations, state.residual, text)

    def _after_frozen(self, state: SolveState) -> None:
        """Repeat with bounds from present pressures until they agree; then place cells anew."""
        breaker = state.breaker
        change, top = self.problem.cells.freeze_friction_bounds()
        if breaker.rounds < MAX_FRICTION_ROUNDS and change > FRICTION_AGREEMENT * top:
            breaker.rounds += 1
            return
        breaker.active = False
        breaker.solution = self.problem.x.copy(), self.problem.cells.saved()
        self.problem.cells.release()

    def _after_converged(self, state: SolveState) -> None:
        """Search again where contact was overlooked; else augment if it penetrates; else accept."""
        problem, settings = self.problem, self.settings
        state.breaker.solution = None
        if problem.overlooked(state.load_state):
            # the state of the last search was too far off; the present one is closer to the
            # solution
            if state.searches == MAX_FURTHER_SEARCHES:
                reason = f"contact outside of {MAX_FURTHER_SEARCHES + 1} searches"
                state.result = SolveResult(False, state.iterations, state.residual, reason)
                return
            problem.search(state.load_state)
            state.searches += 1
            state.before_augmentation = None
            return
        if (
            state.augmentations < settings.max_augmentations
            and problem.penetration() > settings.penetration_tolerance
        ):
            self._augment(state)
            return
        problem.accept()
        state.result = SolveResult(True, state.iterations, state.residual, "converged")

    def _augment(self, state: SolveState) -> None:
        contacts = self.problem.penalty_contacts
        multipliers, x = [contact.multiplier for contact in contacts], self.problem.x.copy()
        state.before_augmentation = AcceptableState(state.residual, x, multipliers)
        state.augmentations, state.renewed = state.augmentations + 1, False
        for contact in contacts:
            contact.augment()

    def _take_back(self, state: SolveState, before: AcceptableState) -> None:
        """Accept the state before an augmentation that failed."""
        problem = self.problem
        before.x.copy(problem.x)
        for contact, multiplier in zip(problem.penalty_contacts, before.multipliers):
            contact.multiplier = multiplier
        self._trial_residual(problem.x, problem.x.duplicate())  # pressures and gaps of that state
        state.augmentations -= 1
        problem.accept()
