"""Which linear solver solves a run. Their registry is `swgpar/design/linear_solvers.py`."""

from __future__ import annotations

from importlib import import_module

from swgpar.design.linear_solvers import LINEAR_SOLVERS
from swgpar.errors import InputError
from swgpar.petsc import PETSc
from swgpar.solve.factors import FACTORISATIONS, Factor
from swgpar.solve.krylov import JUDGE_BY_NORM, KrylovSolver
from swgpar.solve.linear_solver import LinearSolver, MatrixKind

FOR_SYMMETRIC = {
    "pc_type": ("cholesky", "icc"),
    "ksp_type": (*JUDGE_BY_NORM, "cr", "pipecr", "minres", "symmlq", "nash", "stcg", "gltr"),
}
"""Values of PETSc's options that need symmetric matrices."""


def make_linear_solver(linear: str, kind: MatrixKind, options_prefix: str) -> LinearSolver:
    """The linear solver that PETSc's options name, else that of `solver.linear`; collective.

    linear : one of `LINEAR_SOLVERS`;  kind : of the matrices;  options_prefix : of PETSc's options

    A preconditioner alone gets a Krylov method that fits. Raises InputError if options do not fit.
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
                "and friction makes it unsymmetric: take gmres with lu or another preconditioner"
            )
    chosen = linear_solver(linear)
    if pc_type or package:
        of_any = Factor if pc_type in (*FACTORISATIONS, "") else KrylovSolver
        named = map(linear_solver, LINEAR_SOLVERS)
        chosen = next((cls for cls in named if cls.takes(pc_type, package)), of_any)
    return chosen(kind, options_prefix)


def linear_solver(name: str) -> type[LinearSolver]:
    """The class of a name of `LINEAR_SOLVERS`."""
    module, _, cls = LINEAR_SOLVERS[name].cls.rpartition(".")
    return getattr(import_module(module), cls)
