"""Linear systems: the grounded stiffness, bordered by the couplings' constraints; direct or iterative solver."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from mpi4py import MPI

from swgpar.errors import OutOfMemoryError
from swgpar.fem.partition import Partition
from swgpar.fem.vectors import create_vector, read_multipliers
from swgpar.log import logger
from swgpar.petsc import PETSc, accepted_options
from swgpar.solve.factor_reuse import ReusedFactor

QUASI_DENSE, NESTED_DISSECTION = 6, 4
"""Orderings of the unknowns for MUMPS (its ICNTL(7)) in the plane and of solids: with nested dissection (PORD) a
factorisation of the reference drive takes a fifth less time than by minimum degree, and a solve a quarter."""


def mumps_defaults(dims: int) -> dict[str, object]:
    """Options of PETSc for the factor of a matrix with so many unknowns per node."""
    return {
        "mat_mumps_icntl_7": QUASI_DENSE if dims == 2 else NESTED_DISSECTION,
        "mat_mumps_icntl_13": 1,  # no ScaLAPACK root: its Cholesky refuses the indefinite tangents of early iterations
        "mat_mumps_icntl_14": 60,  # per cent of memory above the estimate
    }


MORE_MEMORY, OUT_OF_ESTIMATE = (120, 240, 480), (-8, -9)
"""Per cent above MUMPS' estimate that are tried after these errors of its INFOG(1)."""

NO_MEMORY = (-5, -7, -13)
"""Errors of MUMPS' INFOG(1) for allocations that failed."""

GAMG_DEFAULTS = {
    "ksp_rtol": 1e-6,
    "ksp_max_it": 2000,
    "ksp_pc_side": "right",  # the true residual is judged: the preconditioned one hides the soft modes of a thin cup
    "ksp_gmres_restart": 200,
    "mg_levels_ksp_type": "chebyshev",
    "mg_levels_ksp_max_it": 4,
    "mg_levels_pc_type": "bjacobi",  # flat elements defeat Jacobi's iteration as a smoother
    "mg_levels_sub_pc_type": "icc",
    "mg_levels_sub_pc_factor_shift_type": "positive_definite",
}


class OptionDefaults:
    """PETSc options that the program sets unless the user has set them.

    PETSc keeps options for all solvers of a prefix and reads some of them late, so that one table serves a process: it
    distinguishes the program's own options from the user's.
    """

    def __init__(self) -> None:
        self._own: set[str] = set()

    def set(self, prefix: str, defaults: Mapping[str, object]) -> None:
        """Set the options that the user has not set."""
        options = PETSc.Options(prefix)
        for name, value in defaults.items():
            if prefix + name in self._own or not options.hasName(name):
                options[name] = value
                self._own.add(prefix + name)


option_defaults = OptionDefaults()
"""The table of this process."""


class BorderedSystem:
    """Preconditioner (PETSc `PC` of type python) for [K, C^T; C, 0] with solutions of K' = K + B B^T.

    `linear` says how they are computed: "direct", by a factor (MUMPS); "iterative", by GMRES with smoothed aggregation
    (GAMG) on the rigid-body modes of the nodes at `positions` (n_own, 3) mm.

    K alone is singular while the drive floats; the grounded K' is not. With Z = K'^-1 [B, C^T] the small system

        (1 - B^T Z_B) s + B^T Z_C l = B^T z,     C Z_B s - C Z_C l = r_l - C z,     z = K'^-1 r_u

    gives x = z + Z_B s - Z_C l exactly, whether K is symmetric or not. The grounding has no influence on x.

    The last border is the motion of the output. Where it is loaded and not prescribed, its Newton step is the one at
    which its l vanishes. That step is bounded: a drive without touching flanks floats, and its step is unlimited. All
    other unknowns follow the bounded motion.

    Parameters
    ----------
    partition : ownership;  linear, positions : see above
    options_prefix : of PETSc's options of the linear solver
    symmetric : whether K is
    reuse : use a factor for later tangents too, see `ReusedFactor`

    K has no rows of nodes that nothing acts on. Their part of every solution is zero.
    """

    def __init__(
        self,
        partition: Partition,
        linear: str,
        positions: np.ndarray,
        options_prefix: str,
        *,
        symmetric: bool = True,
        reuse: bool = False,
    ) -> None:
        self.partition = partition
        self.iterative, self.symmetric, self.options_prefix = linear != "direct", symmetric, options_prefix
        self.defaults = GAMG_DEFAULTS if self.iterative else mumps_defaults(partition.dims)
        self.positions = positions[:, : partition.dims]
        self.ksp = self._create_ksp()
        self.unblocked: PETSc.Mat | None = None
        self.factored: PETSc.Mat | None = None
        self.active = np.zeros(0, dtype=np.int64)
        self.into: PETSc.Vec | None = None
        self.out: PETSc.Vec | None = None
        self.grounding: list[PETSc.Vec] = []
        self.border: list[PETSc.Vec] = []
        self.rows: list[int] = []
        self.columns: list[PETSc.Vec] = []
        self.matrix: PETSc.Mat | None = None
        self.bound: float | None = None
        self.n_loaded = 0
        self.small_system = np.zeros((0, 0))
        self.failed = False
        self.reused = ReusedFactor(create_vector(partition), self.multiply, self.solve_with_factor) if reuse else None

    def _create_ksp(self) -> PETSc.KSP:
        ksp = PETSc.KSP().create(comm=self.partition.comm)
        ksp.setOptionsPrefix(self.options_prefix)
        pc = ksp.getPC()
        if self.iterative:
            ksp.setType(PETSc.KSP.Type.GMRES)
            pc.setType(PETSc.PC.Type.GAMG)
        else:
            ksp.setType(PETSc.KSP.Type.PREONLY)
            pc.setType(PETSc.PC.Type.CHOLESKY if self.symmetric else PETSc.PC.Type.LU)
            pc.setFactorSolverType("mumps")
        option_defaults.set(self.options_prefix, self.defaults)
        with accepted_options(self.partition.comm):
            ksp.setFromOptions()
        return ksp

    def destroy(self) -> None:
        """Release the solvers and their matrices; collective."""
        for owned in (self.ksp, self.unblocked, self.reused, self.into, self.out):
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

    def solve_grounded(self, right: PETSc.Vec, x: PETSc.Vec) -> None:
        """x = K'^-1 right in the rows of the matrix, zero elsewhere."""
        self.into.array[:] = self._restricted(right)
        if self.ksp.getInitialGuessNonzero():
            self.out.array[:] = self._restricted(x)
        self.ksp.solve(self.into, self.out)
        self._extend(self.out.array_r, x)

    def set_system(
        self,
        matrix: PETSc.Mat,
        active: np.ndarray,
        grounding: list[PETSc.Vec],
        border: list[PETSc.Vec],
        rows: list[int],
        bound: float | None = None,
    ) -> None:
        """K', vectors B and C^T (full length, zero in the multiplier rows), multiplier rows of C.

        active : (n,) own nodes that K' has rows of
        bound : of C x in the last row when that is loaded instead of prescribed
        """
        self.matrix, self.grounding, self.border, self.rows, self.bound = matrix, grounding, border, rows, bound
        other = int(self.into is None or not np.array_equal(active, self.active))
        if self.partition.comm.allreduce(other, op=MPI.MAX):
            for owned in (self.into, self.out, self.ksp):
                if owned is not None:
                    owned.destroy()
            self.into, self.out = matrix.createVecs()
            self.ksp, self.factored = self._create_ksp(), None
            self.discard_factor()
        self.active = active
        self.n_loaded = 0 if bound is None else 1

    def setUp(self, pc: PETSc.PC) -> None:
        """Factorise the matrix of the last `set_system`, unless the reused factor is still good."""
        if self.reused is None or not self.reused.is_good_for(self._layout(), self._price()):
            self.factorise()

    def _layout(self) -> tuple[int, ...]:
        return len(self.grounding), len(self.border), self.n_loaded

    def discard_factor(self) -> None:
        """Reuse no factor for the next system, which has little in common with the last one."""
        if self.reused is not None:
            self.reused.discarded = True

    def prepare(self) -> None:
        """Factor, or the set-up of the multigrid, of the present matrix."""
        matrix = self.matrix
        option_defaults.set(self.ksp.getOptionsPrefix(), self.defaults)  # another model may have set its own since
        if self.iterative:  # GAMG has no triangular storage
            if self.unblocked is not None:
                self.unblocked.destroy()
            self.unblocked = matrix.convert("aij", out=PETSc.Mat())
            coords = self.positions[self.active].ravel()
            coords = PETSc.Vec().createWithArray(coords, bsize=self.partition.dims, comm=self.partition.comm)
            modes = PETSc.NullSpace().createRigidBody(coords)
            self.unblocked.setNearNullSpace(modes)
            matrix = self.unblocked
        self.ksp.setOperators(matrix)
        self.ksp.getPC().setReusePreconditioner(False)
        with accepted_options(self.partition.comm):
            self.ksp.setUp()
        if not self.iterative:
            self._retry_with_memory(matrix)
        self.ksp.getPC().setReusePreconditioner(self.reused is not None)  # the matrix changes, the factor does not

    def _retry_with_memory(self, matrix: PETSc.Mat) -> None:
        """Factorise again with more memory where MUMPS ran out of what it had estimated (users' guide, section 8)."""
        pc, options = self.ksp.getPC(), PETSc.Options(self.ksp.getOptionsPrefix())
        for more in MORE_MEMORY:
            if pc.getFactorMatrix().getMumpsInfog(1) not in OUT_OF_ESTIMATE:
                break
            logger.info("   MUMPS needs more memory than it had estimated: %d %% above it", more)
            options["mat_mumps_icntl_14"] = self.defaults["mat_mumps_icntl_14"] = more
            pc.reset()
            self.ksp.setOperators(matrix)
            self.ksp.setUp()
        factor = pc.getFactorMatrix()
        error, detail = (factor.getMumpsInfog(k) for k in (1, 2))
        if error in NO_MEMORY:
            needed = f"about {1e-3 * factor.getMumpsInfog(17):.3g} GB" if factor.getMumpsInfog(17) > 0 else "more"
            raise OutOfMemoryError(
                f"not enough memory: the factor of {matrix.getSize()[0]:,} unknowns needs {needed} on all ranks: "
                'take a coarser mesh, more memory, or solver.linear = "iterative"'
            )
        if error < 0:
            logger.warning("   MUMPS cannot factorise: INFOG(1) = %d, INFOG(2) = %d", error, detail)

    def _price(self) -> float:
        """Solves that take as long as another factorisation."""
        factor = None if self.factored is None else self.ksp.getPC().getFactorMatrix()
        entries = 0 if factor is None else factor.getMumpsInfog(29)  # in millions where it is negative
        if entries == 0:  # no factor yet, or one that failed
            return 0.0
        entries = entries if entries > 0 else -1e6 * entries
        return self.reused.price(factor.getMumpsRinfog(3), entries, self.matrix is self.factored)

    def factorise(self) -> None:
        """Factor, or set up, for the present matrix, and solve for the borders."""
        self.prepare()
        sides = self.grounding + self.border
        if len(self.columns) != len(sides):
            self.columns = [vector.duplicate() for vector in sides]
        self._solve_sides(sides)
        b, c, nb = self.grounding, self.border, len(self.grounding)
        small = np.array([[left.dot(right) for right in self.columns] for left in b + c]).reshape(
            len(b + c), len(sides)
        )
        system = np.zeros_like(small)
        system[:nb, :nb] = np.eye(nb) - small[:nb, :nb]
        system[:nb, nb:] = small[:nb, nb:]
        system[nb:, :nb] = small[nb:, :nb]
        system[nb:, nb:] = -small[nb:, nb:]
        self.small_system = system
        self.factored = self.matrix
        if self.reused is not None:
            self.reused.renew(self._layout())

    def _solve_sides(self, sides: list[PETSc.Vec]) -> None:
        """Columns Z, the solutions for the borders."""
        self.failed = False
        if not sides:
            return
        if not self.iterative and self.ksp.getConvergedReason() >= 0:
            # all at once: a solve is bound by reading the factor
            n, rows = self.matrix.getSizes()[0]
            into = PETSc.Mat().createDense([[n, rows], [None, len(sides)]], comm=self.partition.comm)
            into.setUp()
            for k, vector in enumerate(sides):
                into.getDenseArray()[:, k] = self._restricted(vector)
            into.assemble()
            out = into.duplicate()
            self.ksp.getPC().getFactorMatrix().matSolve(into, out)
            for k, solution in enumerate(self.columns):
                self._extend(out.getDenseArray()[:, k], solution)
            into.destroy()
            out.destroy()
            return
        self.ksp.setInitialGuessNonzero(self.iterative)  # those of the last tangent
        for vector, solution in zip(sides, self.columns):
            self.solve_grounded(vector, solution)
            if self.ksp.getConvergedReason() < 0:
                self.failed = True
                solution.set(0.0)  # nothing to start the next tangent's from
        self.ksp.setInitialGuessNonzero(False)

    def apply(self, pc: PETSc.PC, right: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve the system of the last `set_system`: x from right; called by PETSc."""
        if self.reused is not None:
            self.reused.set_tolerance(right)
        if self.uses_old_factor:
            # the bound needs the answer to a unit of load, which GMRES does not give
            if self.reused.solve(right, x) and (self.bound is None or abs(self.border[-1].dot(x)) < self.bound):
                return
            self.factorise()
        self.solve_with_factor(right, x, self.bound)

    def multiply(self, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """y = [K' - B B^T, C^T; C, 0] x of the last `set_system`; multipliers that it does not use stand alone."""
        n, last = self.partition.n_multipliers, self.partition.comm.rank == self.partition.comm.size - 1
        used = self.rows[: len(self.border) - self.n_loaded]
        multipliers = read_multipliers(self.partition, x)
        moved = x.copy()
        if last:
            moved.array[-n:] = 0.0
        self.into.array[:] = self._restricted(moved)
        self.matrix.mult(self.into, self.out)
        self._extend(self.out.array_r, y)
        for vector in self.grounding:
            y.axpy(-vector.dot(moved), vector)
        tail = multipliers.copy()
        for vector, row in zip(self.border, used):
            y.axpy(multipliers[row], vector)
            tail[row] = vector.dot(moved)
        if last:
            y.array[-n:] = tail
        moved.destroy()

    def solve_with_factor(self, right: PETSc.Vec, x: PETSc.Vec, bound: float | None = None) -> None:
        """Solution of the system of the factor; without `bound` the output moves freely where it is loaded."""
        self.solve_grounded(right, x)
        if self.failed or self.ksp.getConvergedReason() < 0:
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
        if self.partition.comm.rank == self.partition.comm.size - 1:
            x.array[-self.partition.n_multipliers :][used] = answer[nb:prescribed]
