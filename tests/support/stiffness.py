"""The assembled stiffness as an operator, for tests of tangent and linear systems."""

from __future__ import annotations

from swgpar.fem.vectors import create_vector
from swgpar.petsc import PETSc
from swgpar.solve.discrete_problem import DiscreteProblem


def without_grounding(problem: DiscreteProblem, x: PETSc.Vec) -> PETSc.Vec:
    """K x without the grounding, in vectors of three unknowns per node."""
    dims, result = problem.partition.dims, create_vector(problem.partition)
    into, out = problem.blocks.matrix.createVecs()
    rows = problem.blocks.matrix_rows.active
    into.array.reshape(-1, dims)[:] = x.array_r.reshape(-1, 3)[rows, :dims]
    problem.blocks.matrix.mult(into, out)
    result.array.reshape(-1, 3)[rows, :dims] = out.array.reshape(-1, dims)
    for vector in problem.supports.grounding(problem.displacement()):
        result.axpy(-vector.dot(x), vector)
    return result
