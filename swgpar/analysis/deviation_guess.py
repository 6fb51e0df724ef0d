"""A guess of the loaded drive with deviations, from a linear model around its ideal state.

Bodies and supports are linear in the forces of the pairs of flanks, in those of the cam on the
faces of the bore, and in the rotation of the output. Pairs touch by the law of the flanks, faces by
the penalty of the cam. Which pairs carry, and which faces lie on the cam, is found on these few
unknowns. Gaps are then measured at the displacement that follows, and the model is solved again
with them. Newton's iteration begins there: it would move the end of the contact with the cam by
half a tooth per iteration. Output angle and torque of the model itself are close to its.

One rank owns all of the drive.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy

from swgpar.analysis.cam_faces import cam_faces
from swgpar.constraints.distributing_coupling import N_COUPLED, ROTATION
from swgpar.contact.active_cells import ActiveCells
from swgpar.contact.flank_deviations import SIDES, FlankDeviations
from swgpar.contact.flanks import FlankContact
from swgpar.fem.body import RING_GEAR
from swgpar.fem.vectors import create_vector
from swgpar.load.load_states import LoadState
from swgpar.model.drive_model import DriveModel
from swgpar.model.torques import torques
from swgpar.petsc import PETSc
from swgpar.solve.bordered_system import BorderedSystem
from swgpar.solve.linear_solvers import make_linear_solver

LEAST, FACTOR, MOST = 1e-5, 1.4, 40
"""First approach of the law (modules), factor of the next ones, and how many there are at most."""

PRESSED, HIGHEST = 0.3, 15.0
"""Forces over the largest one of the ideal state: at which a pair has the shape of its pressure,
and up to which the law is known, since deviations let few pairs carry."""

RISE = 1e-6
"""Least rise of the law from one approach to the next, over the largest force."""

ROUNDS = 40
"""Most changes of the faces on the cam; each comes with the stiffness of the pairs at the last
forces. Usually there are some ten."""

MEASURED, SETTLED = 8, 0.05
"""Most measurements of the gaps, and the change of those that carry by the last one, over the
largest approach, from which the model is taken for the state. Usually two suffice."""

SAME_FORCE = 1e-6
"""Change of a force over the largest one, in a round, below which the pairs are on their law. The
solution does not depend on where the rounds began then."""

DEFINITE = 1e-12
"""Least eigenvalue of a compliance over its largest entry."""

BALANCE = 1e4
"""Weight of the balance of torques among the least squares."""


@dataclass(frozen=True)
class PairLaw:
    """Forces of the pairs over their approach.

    approach : (n,) mm, ascending from 0;  force : (n, n_pair) N
    """

    approach: np.ndarray
    force: np.ndarray

    def approaches(self, force: np.ndarray) -> np.ndarray:
        """Approach (n_pair,) mm of each pair at forces (n_pair,) N."""
        begin, soft = self.tangents(force)
        return begin + soft * force

    def tangents(self, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Approach (n_pair,) mm at no force, and softness (n_pair,) mm/N, of the lines that touch
        the law at forces (n_pair,) N."""
        pair = np.arange(len(force))
        above = np.clip((self.force < force).sum(axis=0), 1, len(self.approach) - 1)
        rise = self.force[above, pair] - self.force[above - 1, pair]
        soft = (self.approach[above] - self.approach[above - 1]) / rise
        return self.approach[above] - soft * self.force[above, pair], soft


@dataclass(frozen=True)
class Balance:
    """Unknowns of the linear model.

    force : (n_pair,) N, of the pairs;  rotation : rad, of the output from the ideal state
    faces : numbers (n,) of the faces that are not on the cam as in the ideal state
    corrections : (n,) N, their correcting forces
    settled : whether the pairs are on their law, and the faces those that the corrections ask for
    """

    force: np.ndarray
    rotation: float
    faces: np.ndarray
    corrections: np.ndarray
    settled: bool


@dataclass(frozen=True)
class ModelledState:
    """What the linear model says of a state.

    output_rotation : rad;  torque : N mm, of the wave generator
    settled : whether the model has found its own solution
    """

    output_rotation: float
    torque: float
    settled: bool


class DeviationGuess:
    """The linear model at one angle.

    Parameters
    ----------
    model, state : the ideal drive in its equilibrium, after a contact search
    ideal : deviations of nothing
    """

    def __init__(self, model: DriveModel, state: LoadState, ideal: FlankDeviations) -> None:
        self.problem = problem = model.problem
        self.flanks: FlankContact = problem.flanks_of(RING_GEAR)
        self.state, self.ideal_x = state, problem.x.copy()
        self.flanks.deviate(ideal)
        gap = self.flanks.least_gaps(self._displacement(), state)
        self.keys = self._nearest(gap)
        self.force = self._forces(self._cells())
        self.vectors, self.law = self._laws(gap[self._numbers()], ideal)
        held = replace(
            state,
            flank_clearance=None,
            control="rotation",
            output_rotation=problem.output_rotation(),
        )
        # later tangents leave its factor alone
        linear = model.solver.settings.linear, problem.blocks.linear.kind, "stiffness_"
        self.system = BorderedSystem(problem.partition, make_linear_solver(*linear), reuse=True)
        model.solver.factorise_tangent(held, self.system)
        columns = np.array([self._response(vector) for vector in self.vectors])
        self.turn = self._turned_output()
        n_own = problem.partition.n_own
        cam = problem.wave_generator.cam
        self.cam = cam_faces(cam, self._displacement(), state, n_own, self._response)
        # motions of pairs by pairs, of faces by pairs, of both by the output
        self.compliance = self.vectors @ columns.T
        self.of_faces = (self.cam.motions @ columns.T).T
        self.torque = torques(problem, state).wave_generator
        place = (problem.positions() + problem.displacement())[:n_own]
        about_axis = np.column_stack([-place[:, 1], place[:, 0], np.zeros(n_own)])
        self.cam_arm = self.cam.motions @ about_axis.ravel() / problem.supports.share
        self.arm = self.vectors @ self._nodal(self.turn)
        self.face_arm = self.cam.motions @ self._nodal(self.turn)
        self.last_faces = np.zeros(0, dtype=np.int64)

    def destroy(self) -> None:
        """Release the factor; collective."""
        self.system.destroy()
        self.system.solver.destroy()

    def _nodal(self, vector: PETSc.Vec) -> np.ndarray:
        """Values (n_own * 3,) of a vector, without multipliers."""
        return vector.array_r[: 3 * self.problem.partition.n_own].copy()

    def _response(self, forces: np.ndarray) -> np.ndarray:
        """Displacement (n_own * 3,) mm by nodal forces (n_own * 3,) N, the output held."""
        return self._nodal(self._answer(forces))

    def _answer(self, forces: np.ndarray) -> PETSc.Vec:
        """x by nodal forces (n_own * 3,) N, the output held."""
        right, x = create_vector(self.problem.partition), create_vector(self.problem.partition)
        right.array[: len(forces)] = forces
        self.system.solve_with_factor(right, x)
        return x

    def _turned_output(self) -> PETSc.Vec:
        """x by the output's rotation of 1 rad."""
        partition, supports = self.problem.partition, self.problem.supports
        right, turn = create_vector(partition), create_vector(partition)
        row = N_COUPLED * supports.output_gear + ROTATION
        right.array[-partition.n_multipliers :][row] = supports.scale
        self.system.solve_with_factor(right, turn)
        return turn

    # -- pairs -------------------------------------------------------------------------------------

    def _nearest(self, gap: np.ndarray) -> list[tuple[int, int, int]]:
        """Keys of the pairs, one for a flank of the flexible spline: the nearest. gap : (n,) mm, of
        all of the search"""
        nearest: dict[tuple[int, int], tuple[float, tuple[int, int, int]]] = {}
        for value, pair in zip(gap, self.flanks.pairs):
            found, flank = (float(value), pair.key), pair.key[:2]
            if np.isfinite(value):
                nearest[flank] = min(found, nearest.get(flank, found))
        return sorted(key for _, key in nearest.values())

    def _numbers(self) -> np.ndarray:
        """Numbers (n_pair,) of the pairs among those of the search."""
        number = {pair.key: k for k, pair in enumerate(self.flanks.pairs)}
        return np.array([number[key] for key in self.keys], dtype=np.int64)

    def _displacement(self) -> np.ndarray:
        self.problem.complete()
        u = self.problem.displacement()
        self.flanks.kernel.ring_rotation = self.flanks.ring_motion.ring_rotation(u)
        return u

    def _gaps(self) -> np.ndarray:
        """Smallest gap (n_pair,) mm of each pair at x; one that is not near stays away."""
        gaps = self.flanks.least_gaps(self._displacement(), self.state)[self._numbers()]
        return np.minimum(gaps, self.problem.module)

    def _cells(self) -> ActiveCells:
        self.flanks.reset()
        return self.flanks.cells.pressed(self._displacement(), self.state.flank_clearance)

    def _forces(self, active: ActiveCells) -> np.ndarray:
        """Forces (n_pair,) N of the pairs."""
        nodal = (active.pressure * active.faces.weight).sum(axis=1)
        of_all = np.bincount(active.faces.patch, nodal, minlength=len(self.flanks.pairs))
        return of_all[self._numbers()]

    def _laws(self, gap: np.ndarray, ideal: FlankDeviations) -> tuple[np.ndarray, PairLaw]:
        """Nodal forces (n_pair, n_own * 3) of the pairs by their force, and the law, by equal
        approaches of all pairs; sets the deviations back. gap : (n_pair,) mm, of the ideal state"""
        sector = np.array([key[0] for key in self.keys])
        tooth = (self.flanks.spline.layout.first_tooth + sector) % len(ideal.heights)
        side = np.array([SIDES.index(key[1]) for key in self.keys])
        enough = self.force.max()
        approach, forces = [0.0], [np.zeros(len(self.keys))]
        vectors = np.zeros((len(self.keys), 3 * self.problem.partition.n_own))
        lacking = np.ones(len(self.keys), dtype=bool)
        for k in range(MOST):
            approach.append(LEAST * self.problem.module * FACTOR**k)
            heights = np.zeros_like(ideal.heights)
            heights[tooth, side] = (gap + approach[-1])[:, None, None, None]
            self.flanks.deviate(replace(ideal, heights=heights))
            active = self._cells()
            carried = self._forces(active)
            forces.append(np.maximum(carried, 1.001 * forces[-1] + RISE * enough))
            presses = lacking & (carried > PRESSED * enough)
            vectors[presses] = self._vectors(active, presses)
            lacking &= ~presses
            if np.median(forces[-1]) > HIGHEST * enough:
                break
        vectors[lacking] = self._vectors(active, lacking)
        self.flanks.deviate(ideal)
        return vectors, PairLaw(np.array(approach), np.array(forces))

    def _vectors(self, active: ActiveCells, of: np.ndarray) -> np.ndarray:
        """Nodal forces (n, n_own * 3), of the residual, of chosen pairs that have the force 1.
        of : (n_pair,) bool"""
        n_own = self.problem.partition.n_own
        nodal = (active.pressure * active.faces.weight).sum(axis=1)
        vectors = np.zeros((int(of.sum()), 3 * n_own))
        for vector, number in zip(vectors, self._numbers()[of]):
            residual = np.zeros((len(self.problem.local_nodes), 3))
            chosen = np.flatnonzero((active.faces.patch == number) & (nodal > 0.0))
            self.flanks.add_forces(active, chosen, self._displacement(), self.state, residual)
            if len(chosen):
                vector[:] = residual[:n_own].ravel() / nodal[chosen].sum()
        return vectors

    # -- guess -------------------------------------------------------------------------------------

    def set_x(self) -> ModelledState:
        """Set the problem's x to the guess for the present deviations of the flanks."""
        x = self.problem.x
        self.ideal_x.copy(x)
        gap, settled = self._gaps(), False
        for _ in range(MEASURED):
            found = self._found(gap)
            forces = -self.vectors.T @ (found.force - self.force)
            forces += self.cam.motions[found.faces].T @ found.corrections
            self.ideal_x.copy(x)
            x.axpy(1.0, self._answer(forces))
            x.axpy(found.rotation, self.turn)
            change = self._gaps() - self._modelled_gaps(gap, found)
            gap = gap + change
            approach = self.law.approaches(found.force)
            most = np.abs(change[found.force > 0.0]).max(initial=0.0)
            settled = found.settled and bool(most <= SETTLED * approach.max())
            if settled:
                break
        torque = self.torque + float(self.cam_arm @ self._change_on_cam(found))
        return ModelledState(self.problem.output_rotation(), torque, settled)

    def _modelled_gaps(self, gap: np.ndarray, found: Balance) -> np.ndarray:
        """Gaps (n_pair,) mm of the linear model. gap : (n_pair,) mm, as for `_balance`"""
        change = self.compliance @ (found.force - self.force)
        of_faces = self.of_faces[:, found.faces] @ found.corrections
        return gap + change - of_faces - found.rotation * self.arm

    def _change_on_cam(self, found: Balance) -> np.ndarray:
        """Forces (n_face,) N of the cam on the faces less those of the ideal state."""
        depth = self._depth(found.force, found.rotation)
        depth = self.cam.corrected(depth, found.faces, found.corrections)
        return self.cam.stiffness * (np.maximum(depth, 0.0) - np.maximum(self.cam.depth, 0.0))

    def _depth(self, force: np.ndarray, rotation: float) -> np.ndarray:
        """Depths (n_face,) mm of the faces without corrections."""
        return self.cam.depth + (force - self.force) @ self.of_faces - rotation * self.face_arm

    def _found(self, gap: np.ndarray) -> Balance:
        """As `_balance`; the ideal forces where the small problems have no solution."""
        try:
            return self._balance(gap)
        except (np.linalg.LinAlgError, ValueError, RuntimeError):  # of nnls
            none = np.zeros(0, dtype=np.int64)
            return Balance(self.force, 0.0, none, np.zeros(0), settled=False)

    def _balance(self, gap: np.ndarray) -> Balance:
        """The unknowns of the linear model. gap : (n_pair,) mm, with the forces and the rotation of
        the ideal state"""
        force, rotation, left = self.force, 0.0, self.last_faces
        for _ in range(ROUNDS):
            faces, last = left, force
            of_faces, face_arm = self.of_faces[:, faces], self.face_arm[faces]
            sides = np.column_stack([self.cam.depth[faces], of_faces.T, face_arm])
            answers = np.linalg.solve(self.cam.softness(faces), sides)
            alone, by_force, by_turn = answers[:, 0], answers[:, 1:-1], answers[:, -1]
            # of the pairs, with the faces following
            compliance = self.compliance - of_faces @ by_force
            arm = self.arm - of_faces @ by_turn
            torque = arm @ self.force + face_arm @ (alone - rotation * by_turn)
            begin = gap - of_faces @ alone - compliance @ self.force
            force, rotation = self._carried(compliance, begin, arm, torque, force)
            change = force - self.force
            corrections = alone + by_force @ change - rotation * by_turn
            depth = self.cam.corrected(self._depth(force, rotation), faces, corrections)
            left = self.cam.left(depth)
            same = bool((np.abs(force - last) <= SAME_FORCE * force.max()).all())
            settled = same and np.array_equal(left, faces)
            if settled:
                break
        self.last_faces = faces
        return Balance(force, rotation, faces, corrections, settled)

    def _carried(
        self,
        compliance: np.ndarray,
        begin: np.ndarray,
        arm: np.ndarray,
        torque: float,
        force: np.ndarray,
    ) -> tuple[np.ndarray, float]:
        """Forces (n_pair,) N of the pairs that carry a torque (N mm), and rotation (rad) of the
        output.

        compliance : (n_pair, n_pair) mm/N;  begin : (n_pair,) mm, gaps without forces
        arm : (n_pair,) mm;  force : (n_pair,) N, at which the pairs have their stiffness
        """
        approach, soft = self.law.tangents(force)
        matrix = 0.5 * (compliance + compliance.T) + np.diag(soft)
        # definite but for round-off and the springs that faces have lost
        least = np.linalg.eigvalsh(matrix)[0]
        matrix += max(DEFINITE * matrix.max() - least, 0.0) * np.eye(len(matrix))
        lower, side = np.linalg.cholesky(matrix), begin + approach
        weight = BALANCE * np.linalg.norm(lower) / np.linalg.norm(arm)
        rows = np.vstack([lower.T, weight * arm])
        right = np.append(-np.linalg.solve(lower, side), weight * torque)
        found, _ = scipy.optimize.nnls(rows, right)
        carries = found > 0.0
        closed, lever = (side + matrix @ found)[carries], arm[carries]
        return found, float(lever @ closed / (lever @ lever))
