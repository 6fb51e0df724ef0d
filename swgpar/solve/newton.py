"""Equilibrium of one load state by SNES: Newton's iteration, the way out where contacts do not settle, augmentation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from swgpar.contact.clearance import Clearance
from swgpar.contact.search import largest
from swgpar.design.load_states import LoadState
from swgpar.fem.vectors import create_vector
from swgpar.log import logger
from swgpar.solve.active_set_cycles import (
    AGREEMENT,
    MOST,
    PATIENCE,
    PROGRESS,
    ROUNDS,
    CycleBreaker,
    VisitedSets,
    exhausted,
    falls,
    fingerprint,
)
from swgpar.solve.bordered_system import BorderedSystem
from swgpar.solve.discrete_problem import DiscreteProblem
from swgpar.solve.line_search import LineSearch

SOFTENING, SOFT_TOLERANCE = (1e-3, 3e-2), 1e-2
"""Shares of the penalty, and residual over contact force, of the first rough solves while contact is established."""

HOLD = 0.6
"""Power of the tolerance: residual over contact force below which segments of the flanks are kept. Newton's iteration
is then quadratic: the next step or the one after it ends. Kept at 1e-3, segments make the state depend on the way to it
by 4e-5 of the input torque where teeth are wedged, at 1e-4 by 1e-6; kept later, a solve takes some iterations more."""

SEARCHES = 3
"""Further contact searches of a solve, at states in which flanks touch that the last one left out."""

FARTHEST = 0.2
"""Largest way (modules) of a node in a Newton step beside teeth: tangents are no guide over their clearance."""

SECURE = 0.01
"""Share of tolerance and floor with a kept factor, whose steps do not square the error as Newton's own do."""

FLOOR = 0.05
"""Share of the round-off that a residual can hold below which it counts as zero; 0.01 to 0.06 of it is reached."""


@dataclass(frozen=True)
class Solved:
    """What a solve did: Newton iterations, last residual over the contact force, why it ended."""

    converged: bool
    iterations: int
    residual: float
    reason: str


@dataclass(eq=False, repr=False)
class NewtonSolver(DiscreteProblem):
    """The discrete drive and its Newton solver; parameters of `DiscreteProblem`."""

    def __post_init__(self) -> None:
        super().__post_init__()
        design, partition, teeth = self.design, self.partition, self.teeth
        self.clearance = Clearance(design, teeth, partition.comm)
        self.on_iteration = None
        self.tried: tuple[np.ndarray, np.ndarray] | None = None
        self.softness = 1.0
        self.snes = PETSc.SNES().create(comm=partition.comm)
        self.snes.setType(PETSc.SNES.Type.NEWTONLS)
        options = PETSc.Options()
        if not options.hasName("snes_linesearch_type"):
            options["snes_linesearch_type"] = "basic"
        self.snes.setFunction(self._function, create_vector(partition))
        self.snes.setConvergenceTest(self._converged)
        keep = design.solver.keep_factor and design.solver.linear == "direct" and partition.dims == 3
        place = self.positions()[: partition.n_own]
        self.border = BorderedSystem(partition, design.solver.linear, place, "stiffness_", teeth.symmetric, keep)
        ksp = self.snes.getKSP()
        ksp.setType(PETSc.KSP.Type.PREONLY)
        ksp.getPC().setType(PETSc.PC.Type.PYTHON)
        self.step = LineSearch(self.border, self._trial, self.x, self.phases)
        ksp.getPC().setPythonContext(self.step)
        self.snes.setFromOptions()
        # SNES sees vectors of three unknowns per node, the matrix may have two: it is known to the border alone
        shell = PETSc.Mat().create(comm=partition.comm)
        shell.setSizes([self.x.getSizes()] * 2)
        shell.setType(PETSc.Mat.Type.SHELL)
        shell.setUp()
        self.snes.setJacobian(self._jacobian, shell, shell)

    def destroy(self) -> None:
        """Release the solvers, which refer to this object, and their matrices; collective."""
        for held in (self.snes, self.border.ksp, self.border.unblocked, self.border.kept, self.matrix):
            if held is not None:
                held.destroy()

    def _function(self, snes: PETSc.SNES, x: PETSc.Vec, f: PETSc.Vec) -> None:
        tried, self.tried = self.tried, None
        if tried is not None:
            # SNES asks for the residual at the end of the step that was tried last
            other = int(not np.array_equal(x.array_r, tried[0]))
            if not self.partition.comm.allreduce(other, op=MPI.MAX):
                f.array[:] = tried[1]
                return
        self.residual(x, f)

    def _trial(self, x: PETSc.Vec, f: PETSc.Vec) -> bool:
        """Residual f at x; whether an element has collapsed there."""
        self.tried = None
        self._function(self.snes, x, f)
        self.tried = x.array_r.copy(), f.array_r.copy()
        return self.failed

    def _jacobian(self, snes: PETSc.SNES, x: PETSc.Vec, j: PETSc.Mat, p: PETSc.Mat) -> None:
        PETSc.garbage_cleanup(self.partition.comm)  # PETSc keeps what Python lets go of, such as the last border
        u = self.displacement(x)
        self.tangent(u)
        self.stale = bool(self.partition.comm.allreduce(int(len(self.missing) > 0), op=MPI.MAX))
        p.stateIncrease()
        bound = self.scale * self.clearance.longest_turn() if self.scene.control == "torque" else None
        border, rows = self.holding.border(u, self.scene)
        self.border.set_system(self.matrix, self.holding.ground_vectors, border, rows, bound)

    def closing_turn(self, scene: LoadState) -> float:
        """Turn (rad) of the output, the way the torque of `scene` acts, by which its flanks do not meet yet.

        0 where they are so close that a Newton step does the rest, or where none is near.
        """
        self.scene = scene
        self.search()
        u = self.displacement()
        self.teeth.turn = self.holding.ring_turn(u)
        self.teeth.evaluate(u, scene.teeth, None, None)
        return float(np.copysign(self.clearance.closing_turn(), scene.torque))

    # -- solve -------------------------------------------------------------------------------------------

    def _converged(self, snes: PETSc.SNES, its: int, norms: tuple[float, float, float]) -> int | None:
        _, step, norm = norms
        reference = max(self.reference, 1e-6 * self.scale * self.design.drive.module)
        ratio = norm / reference
        self.history.append(ratio)
        if self.on_iteration is not None:
            self.on_iteration(self.scene, its, ratio)
        if self.failed or not np.isfinite(norm):
            return PETSc.SNES.ConvergedReason.DIVERGED_FUNCTION_DOMAIN
        kept = self.border.kept
        secure = 1.0 if kept is None or kept.fresh else SECURE
        if kept is not None:
            kept.goal = reference * (SECURE * self.design.solver.rtol if self.softness == 1.0 else SOFT_TOLERANCE)
        if ratio < self.design.solver.rtol**HOLD and self.softness == 1.0:
            self.teeth.hold()
        if ratio <= (secure * self.design.solver.rtol if self.softness == 1.0 else SOFT_TOLERANCE):
            return PETSc.SNES.ConvergedReason.CONVERGED_FNORM_RELATIVE
        # round-off floor: what positions known to 16 digits leave of the forces, or no decrease close to it
        stalled = its > 1 and ratio > 0.3 * self.history[-2]
        if norm <= (1.0 if stalled else secure * FLOOR) * self.round_off:
            return PETSc.SNES.ConvergedReason.CONVERGED_FNORM_RELATIVE
        if self.stale and its > 0:
            return PETSc.SNES.ConvergedReason.CONVERGED_ITS
        if exhausted(self.history, self.design.solver.max_iterations):
            return PETSc.SNES.ConvergedReason.DIVERGED_MAX_IT
        if not self.step.careful and self._unsettled(ratio):
            logger.info("   contacts do not settle in Newton iteration %d: careful line search", its)
            self.step.careful = True
            if not self.way_out.begun and not self._frozen():
                self.teeth.hold()
                self.teeth.lag()
                self.way_out.active = self.way_out.begun = self._frozen()
        return None

    def _frozen(self) -> bool:
        """Whether segments are held, on any rank: many have no teeth in reach."""
        return bool(self.partition.comm.allreduce(int(self.teeth.frozen), op=MPI.MAX))

    def _unsettled(self, ratio: float) -> bool:
        """Whether active sets come back, or the residual does not fall."""
        returns = self.visited.returns(fingerprint(self.partition.comm, self._active_sets()), ratio)
        return returns or not falls(self.history, PATIENCE, PROGRESS)

    def _active_sets(self) -> list[np.ndarray]:
        scene = self.scene
        sets = [c.pressure > 0.0 for c, on in ((self.rigid, scene.cam), (self.pins, scene.pins)) if on is not None]
        return sets if scene.teeth is None else sets + self.teeth.active_set()

    def solve(self, scene: LoadState, soft: bool = False) -> Solved:
        """Solve for equilibrium from the present x; x is the solution, or garbage when not converged.

        soft : contact is being established: approach through softened penalties
        """
        self.scene = scene
        if self.partition.comm.rank == self.partition.comm.size - 1:
            unused = self.holding.unused(scene)
            self.x.array[-len(unused) :][unused] = 0.0
        self.step.longest = np.inf if scene.teeth is None else FARTHEST * self.design.drive.module
        self.search()
        iterations, self.augmentations, searches, before_augmentation = 0, 0, 0, None
        most = MOST * self.design.solver.max_iterations
        self.way_out = way_out = CycleBreaker()
        soften = list(SOFTENING) if soft else []
        tolerance = self.design.contact.penetration_tolerance * self.design.drive.module
        while True:
            self.history, self.stale, self.tried = [], False, None
            self.visited, self.step.careful = VisitedSets(), way_out.active
            self.soften(soften.pop(0) if soften else 1.0)
            self.snes.setTolerances(max_it=max(1, most - iterations))
            self.snes.solve(None, self.x)
            reason = self.snes.getConvergedReason()
            iterations += self.snes.getIterationNumber()
            ratio = self.history[-1] if self.history else np.inf
            stale = reason == PETSc.SNES.ConvergedReason.CONVERGED_ITS
            if reason < 0 or (stale and iterations >= most):
                self.border.renew()
                if way_out.solution is not None and iterations < most:
                    logger.info("   segments of the flanks are kept: cut anew they do not settle")
                    x, held = way_out.solution
                    x.copy(self.x)
                    self.teeth.hold_again(held)
                    way_out.solution = None
                    continue
                if before_augmentation is not None:
                    ratio, *state = before_augmentation
                    self._take_back(*state)
                    return Solved(True, iterations, ratio, "converged")
                text = REASONS.get(reason, str(reason)) if reason < 0 else f"{iterations} iterations in all"
                return Solved(False, iterations, ratio, text)
            if stale:
                self.lay_out(np.union1d(self.keys, self.missing))
                soften.insert(0, self.softness)
                continue
            if self.softness != 1.0:
                self.way_out = way_out = CycleBreaker()
                self.teeth.release()
                continue
            if way_out.active:
                change, top = (largest(self.partition.comm, value) for value in self.teeth.lag())
                if way_out.rounds < ROUNDS and change > AGREEMENT * top:
                    way_out.rounds += 1
                    continue
                way_out.active, way_out.solution = False, (self.x.copy(), self.teeth.held())
                self.teeth.release()
                continue
            way_out.solution = None
            if self.overlooked():
                # the state searched at was too far off: the found one is closer to the solution
                if searches == SEARCHES:
                    return Solved(False, iterations, ratio, f"contact outside of {SEARCHES + 1} searches")
                self.search()
                searches += 1
                before_augmentation = None
                continue
            penetration = self.penetration()
            if penetration <= tolerance or self.augmentations >= self.design.contact.max_augmentations:
                if penetration > tolerance and self.design.contact.max_augmentations:
                    self._warn(penetration)
                self.accept()
                return Solved(True, iterations, ratio, "converged")
            self.augmentations += 1
            before_augmentation = ratio, self.x.copy(), [contact.multiplier for contact in self.contacts]
            for contact in self.contacts:
                contact.augment()

    def _warn(self, penetration: float) -> None:
        logger.warning("   penetration of %.2g mm remains after %d augmentations", penetration, self.augmentations)

    def _take_back(self, x: PETSc.Vec, multipliers: list[np.ndarray]) -> None:
        """Accept the state before an augmentation that led to none."""
        x.copy(self.x)
        for contact, multiplier in zip(self.contacts, multipliers):
            contact.multiplier = multiplier
        self._trial(self.x, self.x.duplicate())  # pressures and gaps of that state
        self.augmentations -= 1
        self._warn(self.penetration())
        self.accept()

    def soften(self, share: float) -> None:
        """Use this share of the contact penalty."""
        if share != self.softness:
            self.border.renew()
        self.softness = share
        self.rigid.penalty = self.pins.penalty = share * self.design.wg_penalty
        self.teeth.penalty = share * self.design.penalty


REASONS = {value: name for name, value in vars(PETSc.SNES.ConvergedReason).items() if isinstance(value, int)}
