"""Linear systems: the grounded stiffness, bordered by the constraints of the couplings, factorised or iterated on."""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from swgpar.partition import Partition

MUMPS_DEFAULTS = {
    "mat_mumps_icntl_7": 6,  # quasi-dense minimum degree: faster here than PORD, MUMPS' choice without METIS
    "mat_mumps_icntl_13": 1,  # no ScaLAPACK root: its Cholesky refuses the indefinite tangents of early iterations
    "mat_mumps_icntl_14": 60,  # per cent of memory above the estimate
}

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


class Bordered:
    """Preconditioner (PETSc `PC` of type python) for [K, C^T; C, 0] with solutions of K' = K + B B^T.

    `linear` says how they are got: "direct", by a factor (MUMPS); "iterative", by GMRES with smoothed aggregation
    (GAMG) on the rigid-body modes of the nodes at `positions` (n_own, 3) mm.

    K alone is singular while the drive floats; the grounded K' is not. With Z = K'^-1 [B, C^T] the small system

        (1 - B^T Z_B) s + B^T Z_C l = B^T z,     C Z_B s - C Z_C l = r_l - C z,     z = K'^-1 r_u

    gives x = z + Z_B s - Z_C l exactly, whether K is symmetric or not: the grounding leaves no trace.

    The last border is the motion of the output. Where it is not prescribed but loaded, its Newton step is the one at
    which its l vanishes, and it is bounded: a drive whose teeth have parted floats, and there the step has no end.
    All other unknowns follow the bounded motion.
    """

    def __init__(
        self, partition: Partition, linear: str, positions: np.ndarray, options_prefix: str, symmetric: bool = True
    ) -> None:
        self.partition = partition
        self.ksp = PETSc.KSP().create(comm=partition.comm)
        self.ksp.setOptionsPrefix(options_prefix)
        pc = self.ksp.getPC()
        self.modes: PETSc.NullSpace | None = None
        self.unblocked: PETSc.Mat | None = None
        if linear == "direct":
            self.ksp.setType(PETSc.KSP.Type.PREONLY)
            pc.setType(PETSc.PC.Type.CHOLESKY if symmetric else PETSc.PC.Type.LU)
            pc.setFactorSolverType("mumps")
            defaults = MUMPS_DEFAULTS
        else:
            self.ksp.setType(PETSc.KSP.Type.GMRES)
            pc.setType(PETSc.PC.Type.GAMG)
            defaults = GAMG_DEFAULTS
            place = positions[:, : partition.dims].ravel()
            place = PETSc.Vec().createWithArray(place, bsize=partition.dims, comm=partition.comm)
            self.modes = PETSc.NullSpace().createRigidBody(place)
        options = PETSc.Options(options_prefix)
        for name, value in defaults.items():
            if not options.hasName(name):
                options[name] = value
        self.ksp.setFromOptions()
        self.grounding: list[PETSc.Vec] = []
        self.border: list[PETSc.Vec] = []
        self.rows: list[int] = []
        self.columns: list[PETSc.Vec] = []

    def _solve(self, right: PETSc.Vec, x: PETSc.Vec) -> None:
        """x = K'^-1 right; in the plane the matrix has no z, and x gets a zero there."""
        dims = self.partition.dims
        if dims == 3:
            self.ksp.solve(right, x)
            return
        into, out = self.ksp.getOperators()[0].createVecs()
        for vector, flat in ((right, into), (x, out)):
            flat.array.reshape(-1, dims)[:] = vector.array_r.reshape(-1, 3)[:, :dims]
        self.ksp.solve(into, out)
        x.array.reshape(-1, 3)[:, :dims] = out.array_r.reshape(-1, dims)
        x.array.reshape(-1, 3)[:, dims:] = 0.0

    def set_system(
        self,
        matrix: PETSc.Mat,
        grounding: list[PETSc.Vec],
        border: list[PETSc.Vec],
        rows: list[int],
        bound: float | None = None,
    ) -> None:
        """K', vectors B and C^T (full length, zero in the multiplier rows), multiplier rows of C.

        bound : of C x in the last row when that is loaded instead of prescribed
        """
        self.matrix, self.grounding, self.border, self.rows, self.bound = matrix, grounding, border, rows, bound

    def setUp(self, pc: PETSc.PC) -> None:
        matrix = self.matrix
        if self.modes is not None:  # GAMG has no triangular storage
            if self.unblocked is not None:
                self.unblocked.destroy()
            self.unblocked = matrix.convert("aij", out=PETSc.Mat())
            self.unblocked.setNearNullSpace(self.modes)
            matrix = self.unblocked
        self.ksp.setOperators(matrix)
        self.ksp.setUp()
        sides = self.grounding + self.border
        if len(self.columns) != len(sides):
            self.columns = [vector.duplicate() for vector in sides]
        self.ksp.setInitialGuessNonzero(self.modes is not None)  # those of the last tangent
        self.failed = False
        for vector, solution in zip(sides, self.columns):
            self._solve(vector, solution)
            if self.ksp.getConvergedReason() < 0:
                self.failed = True
                solution.set(0.0)  # nothing to start the next tangent's from
        self.ksp.setInitialGuessNonzero(False)
        b, c, nb = self.grounding, self.border, len(self.grounding)
        small = np.array([[left.dot(right) for right in self.columns] for left in b + c]).reshape(len(b + c), -1)
        system = np.zeros_like(small)
        system[:nb, :nb] = np.eye(nb) - small[:nb, :nb]
        system[:nb, nb:] = small[:nb, nb:]
        system[nb:, :nb] = small[nb:, :nb]
        system[nb:, nb:] = -small[nb:, nb:]
        self.system = system

    def multipliers(self, vector: PETSc.Vec) -> np.ndarray:
        """The multiplier entries of a full-length vector, on every rank."""
        comm, last, n = self.partition.comm, self.partition.comm.size - 1, self.partition.n_multipliers
        values = vector.array_r[-n:].copy() if comm.rank == last else np.empty(n)
        comm.Bcast(values, root=last)
        return values

    def apply(self, pc: PETSc.PC, right: PETSc.Vec, x: PETSc.Vec) -> None:
        self._solve(right, x)
        if self.failed or self.ksp.getConvergedReason() < 0:
            x.set(np.nan)  # the residual at such a step is not finite: the increment is cut back
            return
        nb = len(self.grounding)
        load = np.array([v.dot(x) for v in self.grounding + self.border])
        prescribed = len(load) if self.bound is None else len(load) - 1
        used = self.rows[: prescribed - nb]
        load[nb:] *= -1.0
        load[nb:prescribed] += self.multipliers(right)[used]
        answer = np.linalg.solve(self.system, load)
        if self.bound is not None:
            unit = np.linalg.solve(self.system, np.eye(len(load))[-1])
            force, stiffness = answer[-1], -unit[-1]
            motion = force / stiffness if stiffness * self.bound > abs(force) else np.sign(force) * self.bound
            answer += motion * unit
        for k, column in enumerate(self.columns):
            x.axpy(answer[k] if k < nb else -answer[k], column)
        if self.partition.comm.rank == self.partition.comm.size - 1:
            x.array[-self.partition.n_multipliers :][used] = answer[nb:prescribed]
