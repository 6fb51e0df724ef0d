"""The registry of linear solvers, and which of them solves a run.

A further kind is a class that extends `LinearSolver`, in a file of its own, and an entry here. A
value of the key `solver.linear` (`swgpar/design/sections.py`) then names it.
"""

from __future__ import annotations

from swgpar.errors import InputError
from swgpar.petsc import PETSc
from swgpar.solve.factors import Factor, MumpsFactor
from swgpar.solve.krylov import KrylovSolver, SmoothedAggregation
from swgpar.solve.linear_solver import LinearSolver, MatrixKind

LINEAR_SOLVERS: dict[str, type[LinearSolver]] = {
    "direct": MumpsFactor,
    "iterative": SmoothedAggregation,
}
"""By the names of `solver.linear`."""

FOR_SYMMETRIC = {
    "pc_type": ("cholesky", "icc"),
    "ksp_type": (
        "cg",
        "fcg",
        "pipecg",
        "groppcg",
        "cr",
        "pipecr",
        "minres",
        "symmlq",
        "nash",
        "stcg",
        "gltr",
    ),
}
"""Values of PETSc's options that need symmetric matrices."""


def make_linear_solver(linear: str, kind: MatrixKind, options_prefix: str) -> LinearSolver:
    """The linear solver that PETSc's options name, and where they name none that of
    `solver.linear`; collective.

    linear : one of `LINEAR_SOLVERS`;  kind : of the matrices;  options_prefix : of PETSc's options

    A preconditioner without a Krylov method gets one that fits. Raises InputError for options that
    do not fit.
    """
    options = PETSc.Options(options_prefix)
    pc_type, package = (
        options.getString(name, "") for name in ("pc_type", "pc_factor_mat_solver_type")
    )
    for option, names in FOR_SYMMETRIC.items():
        value = options.getString(option, "")
        if value in names and not kind.symmetric:
            raise InputError(
                f"options of PETSc: -{options_prefix}{option} {value} needs a symmetric tangent, "
                f"and friction "
                "makes it unsymmetric: take gmres with lu or another preconditioner"
            )
    chosen = LINEAR_SOLVERS[linear]
    if pc_type or package:
        kinds = (MumpsFactor, Factor, SmoothedAggregation, KrylovSolver)
        chosen = next(cls for cls in kinds if cls.takes(pc_type, package))
    return chosen(kind, options_prefix)
