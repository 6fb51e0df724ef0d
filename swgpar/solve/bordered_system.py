"""Linear systems: the grounded stiffness, bordered by the couplings' constraints and the springs of
an output bearing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from mpi4py import MPI

from swgpar.fem.partition import Partition
from swgpar.fem.vectors import create_vector, read_multipliers
from swgpar.geometry.rotation import rotated
from swgpar.petsc import PETSc
from swgpar.solve.factor_reuse import ReusedFactor
from swgpar.solve.linear_solver import LinearSolver

DEAR = 8.0
"""Price of a factor, in solves with it, from which that of a problem that is near is taken over. In
the plane it costs 4: a first step by GMRES, and one iteration more, then take an eighth longer."""


class BorderedSystem:
    """PETSc `PC` of type python for [K, C^T; C, 0] with solutions of K' = K + B B^T.

    K alone is singular while the drive floats; the grounded K' is not. With Z = K'^-1 [B, C^T] the
    small system

        (1 - B^T Z_B) s + B^T Z_C l = B^T z,     C Z_B s - C Z_C l = r_l - C z,     z = K'^-1 r_u

    gives x = z + Z_B s - Z_C l exactly, whatever K and the grounding are. Springs S on mean
    motions, K = K' - B B^T + S S^T, stand beside B, with -1 in place of 1.

    The last border is the motion of the output. Where it is loaded and not prescribed, its Newton
    step is the one at which its l vanishes. That step is bounded: a drive without touching flanks
    floats, and its step is unlimited. All other unknowns follow the bounded motion.

    partition : ownership;  solver : solves with K'
    reuse : use a factor for later tangents too, see `ReusedFactor`; only if the solver is one

    K has no rows of nodes that nothing acts on. Their part of every solution is zero.

    Attributes:
    turn : rad, by which the present problem is turned against that of the factor, counter-clockwise
    is_taken_over : whether the factor is that of another problem, near the solution of this one
    """

    def __init__(self, partition: Partition, solver: LinearSolver, *, reuse: bool = False) -> None:
        self.partition, self.solver = partition, solver
        self.active = np.zeros(0, dtype=np.int64)
        self.into: PETSc.Vec | None = None
        self.out: PETSc.Vec | None = None
        self.grounding: list[PETSc.Vec] = []
        self.signs = np.zeros(0)
        self.border: list[PETSc.Vec] = []
        self.rows: list[int] = []
        self.columns: list[PETSc.Vec] = []
        self.matrix: PETSc.Mat | None = None
        self.bound: float | None = None
        self.n_loaded = 0
        self.small_system = np.zeros((0, 0))
        self.failed = False
        self.turn = 0.0
        self.is_taken_over = False
        self.reused: ReusedFactor | None = None
        if reuse and solver.is_factor:
            self.reused = ReusedFactor(
                create_vector(partition), self.multiply, self.solve_with_factor
            )

    def destroy(self) -> None:
        """Release all but the solver; collective."""
        for owned in (self.reused, self.into, self.out):
            if owned is not None:
                owned.destroy()

    @property
    def uses_old_factor(self) -> bool:
        """Whether the factor in use is that of an earlier tangent."""
        return self.reused is not None and not self.reused.fresh

    def set_goal(self, norm: float) -> None:
        """Norm (N) of the residual at which Newton's iteration ends at the latest."""
        if self.reused is not None:
            self.reused.goal = norm

    def _restricted(self, vector: PETSc.Vec) -> np.ndarray:
        """Values of a vector in the rows of the matrix."""
        return vector.array_r.reshape(-1, 3)[self.active, : self.partition.dims].ravel()

    def _extend(self, values: np.ndarray, vector: PETSc.Vec) -> None:
        """Set a vector from its values in the rows of the matrix, and to zero elsewhere."""
        vector.set(0.0)
        dims = self.partition.dims
        vector.array.reshape(-1, 3)[self.active, :dims] = values.reshape(-1, dims)

    def take_over_factor(self, turn: float) -> None:
        """Let the solver's factor, made for another problem, serve the first systems of this one.
        Without grounding and borders.

        turn : rad, by which this problem is turned against that one, counter-clockwise
        """
        if self.reused is not None and not self.solver.failure:
            self.turn = turn
            self.reused.renew(self._layout())

    def take_over(self, other: BorderedSystem) -> bool:
        """Exchange the solvers with another system of the same nodes, if this one has made no
        factor yet and the other one has one that may serve and is `DEAR`; whether it has.
        Collective."""
        if self.reused is None or other.reused is None or self.into is not None:
            return False
        # half of a drive may be near one that is modelled in full
        if other.partition.n_global != self.partition.n_global:
            return False
        if other.reused.discarded or other.solver.failure:
            return False
        if other.solver.price(other.solver.matrix) < DEAR:
            return False
        mine, others = self.solver, other.solver
        mine.kind, others.kind = others.kind, mine.kind
        self.solver, other.solver = others, mine
        self.active, self.into, self.out = other.active, other.into, other.out
        self.columns, self.small_system = other.columns, other.small_system
        self.reused.renew(other.reused.layout)
        self.turn, self.is_taken_over = other.turn, True
        other.into, other.out, other.columns = None, None, []
        other.discard_factor()
        return True

    def _turned(self, values: np.ndarray, angle: float) -> np.ndarray:
        """Vectors in the rows of the matrix, turned by an angle (rad), counter-clockwise."""
        if angle == 0.0:
            return values
        return rotated(values.reshape(-1, self.partition.dims), angle).ravel()

    def solve_grounded(self, right: PETSc.Vec, x: PETSc.Vec) -> None:
        """x = K'^-1 right in the rows of the matrix, zero elsewhere."""
        values = self._turned(self._restricted(right), -self.turn)
        self._extend(self._turned(self.solver.solve(values), self.turn), x)

    def set_system(
        self,
        matrix: PETSc.Mat,
        active: np.ndarray,
        grounding: list[PETSc.Vec],
        border: list[PETSc.Vec],
        rows: list[int],
        bound: float | None = None,
        springs: Sequence[PETSc.Vec] = (),
    ) -> None:
        """K', vectors B, C^T and S (full length, zero in the multiplier rows), rows of C.

        active : (n,) own nodes that K' has rows of
        bound : of C x in the last row when that is loaded instead of prescribed
        """
        self.matrix = matrix
        self.grounding = [*grounding, *springs]
        self.signs = np.repeat([1.0, -1.0], [len(grounding), len(springs)])
        self.border = border
        self.rows = rows
        self.bound = bound
        first = self.into is None
        other = int(first or not np.array_equal(active, self.active))
        if self.partition.comm.allreduce(other, op=MPI.MAX):
            for owned in (self.into, self.out):
                if owned is not None:
                    owned.destroy()
            self.into, self.out = matrix.createVecs()
            left = self.solver.matrix is matrix  # by another system
            if not left:
                self.solver.renew()
            if not (first and left):
                self.discard_factor()
        self.active = active
        self.n_loaded = 0 if bound is None else 1

    def setUp(self, pc: PETSc.PC) -> None:
        """Factorise the matrix of the last `set_system`, unless the reused factor is still good."""
        if self.reused is None or not self.reused.is_good_for(
            self._layout(), self.solver.price(self.matrix)
        ):
            self.factorise()

    def _layout(self) -> tuple[int, ...]:
        return len(self.grounding), len(self.border), self.n_loaded

    def discard_factor(self) -> None:
        """Reuse no factor for the next system, which has little in common with the last one."""
        if self.reused is not None:
            self.reused.discarded = True

    def factorise(self) -> None:
        """Prepare the solver for the present matrix, and solve for the borders."""
        self.solver.prepare(self.matrix, self.active, keep=self.reused is not None)
        self.turn, self.is_taken_over = 0.0, False
        sides = self.grounding + self.border
        if len(self.columns) != len(sides):
            self.columns = [vector.duplicate() for vector in sides]
        self._solve_sides(sides)
        b, c, nb = self.grounding, self.border, len(self.grounding)
        small = np.array([[left.dot(right) for right in self.columns] for left in b + c]).reshape(
            len(b + c), len(sides)
        )
        system = np.zeros_like(small)
        system[:nb, :nb] = np.diag(self.signs) - small[:nb, :nb]
        system[:nb, nb:] = small[:nb, nb:]
        system[nb:, :nb] = small[nb:, :nb]
        system[nb:, nb:] = -small[nb:, nb:]
        self.small_system = system
        if self.reused is not None:
            self.reused.renew(self._layout())
            self.reused.discarded = self.failed

    def _solve_sides(self, sides: list[PETSc.Vec]) -> None:
        """Columns Z, the solutions for the borders; those of the last tangent are the guesses."""
        shape = (self.partition.dims * len(self.active), len(sides))
        if sides and not self.solver.failure:
            rights, guesses = (
                np.array([self._restricted(vector) for vector in vectors]).reshape(shape[::-1]).T
                for vectors in (sides, self.columns)
            )
            for values, column in zip(self.solver.solve_many(rights, guesses).T, self.columns):
                self._extend(values, column)
        self.failed = bool(self.solver.failure)

    def apply(self, pc: PETSc.PC, right: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve the system of the last `set_system`: x from right; called by PETSc."""
        if self.reused is not None:
            self.reused.set_tolerance(right)
        if self.uses_old_factor:
            # the bound needs the answer to a unit of load, which GMRES does not give
            if self.reused.solve(right, x) and (
                self.bound is None or abs(self.border[-1].dot(x)) < self.bound
            ):
                return
            self.factorise()
        self.solve_with_factor(right, x, self.bound)

    def multiply(self, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """y = [K' - B B^T + S S^T, C^T; C, 0] x of the last system; unused multipliers stand
        alone."""
        n, last = self.partition.n_multipliers, self.partition.has_multipliers
        used = self.rows[: len(self.border) - self.n_loaded]
        multipliers = read_multipliers(self.partition, x)
        moved = x.copy()
        if last:
            moved.array[-n:] = 0.0
        self.into.array[:] = self._restricted(moved)
        self.matrix.mult(self.into, self.out)
        self._extend(self.out.array_r, y)
        for sign, vector in zip(self.signs, self.grounding, strict=True):
            y.axpy(-sign * vector.dot(moved), vector)
        tail = multipliers.copy()
        for vector, row in zip(self.border, used):
            y.axpy(multipliers[row], vector)
            tail[row] = vector.dot(moved)
        if last:
            y.array[-n:] = tail
        moved.destroy()

    def solve_with_factor(self, right: PETSc.Vec, x: PETSc.Vec, bound: float | None = None) -> None:
        """Solution with the factor; without `bound` the output moves freely where it is loaded."""
        if not self.failed:
            self.solve_grounded(right, x)
        if self.failed or self.solver.failure:
            x.set(np.nan)  # the residual at such a step is not finite: the increment is cut back
            return
        nb = len(self.grounding)
        prescribed = len(self.columns) - self.n_loaded
        used = self.rows[: prescribed - nb]
        sides = (self.grounding + self.border)[: prescribed if bound is None else None]
        load = np.array([v.dot(x) for v in sides])
        load[nb:] *= -1.0
        load[nb:prescribed] += read_multipliers(self.partition, right)[used]
        if bound is None:
            answer = np.linalg.solve(self.small_system[:prescribed, :prescribed], load)
        else:
            answer = np.linalg.solve(self.small_system, load)
            unit = np.linalg.solve(self.small_system, np.eye(len(load))[-1])
            force, stiffness = answer[-1], -unit[-1]
            motion = force / stiffness if stiffness * bound > abs(force) else np.sign(force) * bound
            answer += motion * unit
        for k, value in enumerate(answer):
            x.axpy(value if k < nb else -value, self.columns[k])
        if self.partition.has_multipliers:
            x.array[-self.partition.n_multipliers :][used] = answer[nb:prescribed]
