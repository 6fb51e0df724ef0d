"""Krylov methods with any of PETSc's preconditioners, and the program's smoothed aggregation."""

from __future__ import annotations

import numpy as np

from swgpar.errors import InputError
from swgpar.petsc import PETSc
from swgpar.solve.linear_solver import LinearSolver

JUDGE_BY_RIGHT_SIDE = ("gmres", "fgmres", "lgmres", "pgmres", "gcr", "bcgs", "fbcgs", "tfqmr")
"""Krylov methods that judge the true residual with the preconditioner on the right."""

JUDGE_BY_NORM = ("cg", "fcg", "pipecg", "groppcg")
"""Krylov methods of symmetric matrices that judge the true residual by the choice of the norm."""

NO_SOLVERS = {
    "preonly": "solves with lu or cholesky alone",
    "chebyshev": "is a smoother, and PETSc 3.18 does not survive its divergence",
}
"""Krylov methods that are refused, and why."""

EXACT = ("redundant", "svd", "qr")
"""Preconditioners that solve exactly, beside the factors."""


class KrylovSolver(LinearSolver):
    """A Krylov method, GMRES unless options say, with any of PETSc's preconditioners."""

    def set_preconditioner(self, pc: PETSc.PC) -> None:
        """The options name it."""

    def defaults(self, ksp_type: str) -> dict[str, object]:
        """Tolerance and limits. The true residual is judged: a preconditioned one hides the soft
        modes of a thin cup.

        Raises InputError for a method that does not solve.
        """
        pc_type = PETSc.Options(self.options_prefix).getString("pc_type", "")
        if ksp_type in NO_SOLVERS and pc_type not in EXACT:
            raise InputError(
                f"options of PETSc: -{self.options_prefix}ksp_type {ksp_type} "
                f"{NO_SOLVERS[ksp_type]}: take gmres, or leave the option out"
            )
        options: dict[str, object] = {"ksp_rtol": 1e-6, "ksp_max_it": 2000}
        if ksp_type in JUDGE_BY_RIGHT_SIDE:
            options["ksp_pc_side"] = "right"
        if ksp_type.endswith("gmres"):
            options["ksp_gmres_restart"] = 200
        if ksp_type in JUDGE_BY_NORM:
            options["ksp_norm_type"] = "unpreconditioned"
        return options


class SmoothedAggregation(KrylovSolver):
    """PETSc's GAMG on the rigid-body modes of the nodes."""

    @classmethod
    def takes(cls, pc_type: str, package: str) -> bool:
        """GAMG."""
        return pc_type == "gamg"

    def set_preconditioner(self, pc: PETSc.PC) -> None:
        """GAMG."""
        pc.setType(PETSc.PC.Type.GAMG)

    def defaults(self, ksp_type: str) -> dict[str, object]:
        """Those of all Krylov methods and a smoother: flat elements defeat Jacobi's iteration."""
        return super().defaults(ksp_type) | {
            "mg_levels_ksp_type": "chebyshev",
            "mg_levels_ksp_max_it": 4,
            "mg_levels_pc_type": "bjacobi",
            "mg_levels_sub_pc_type": "icc",
            "mg_levels_sub_pc_factor_shift_type": "positive_definite",
        }

    def operator(self, matrix: PETSc.Mat, positions: np.ndarray) -> PETSc.Mat:
        """The matrix in AIJ with the rigid-body modes."""
        operator = super().operator(matrix, positions)
        place = PETSc.Vec().createWithArray(
            positions.ravel(), bsize=self.kind.unknowns_per_node, comm=self.kind.comm
        )
        operator.setNearNullSpace(PETSc.NullSpace().createRigidBody(place))
        return operator
