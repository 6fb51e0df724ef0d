"""The assembled stiffness as an operator, for tests of tangent and linear systems."""

from __future__ import annotations

from petsc4py import PETSc

from swgpar.fem.vectors import create_vector
from swgpar.solve.newton import NewtonSolver


def without_grounding(equilibrium: NewtonSolver, x: PETSc.Vec) -> PETSc.Vec:
    """K x without the grounding, in vectors of three unknowns per node."""
    dims, result = equilibrium.partition.dims, create_vector(equilibrium.partition)
    into, out = equilibrium.matrix.createVecs()
    into.array.reshape(-1, dims)[:] = x.array_r.reshape(-1, 3)[:, :dims]
    equilibrium.matrix.mult(into, out)
    result.array.reshape(-1, 3)[:, :dims] = out.array.reshape(-1, dims)
    for vector in equilibrium.holding.ground_vectors:
        result.axpy(-vector.dot(x), vector)
    return result
