"""The blocks of the tangent on this rank, and PETSc's matrix of them."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from swgpar.fem.elements import Elements
from swgpar.fem.local_nodes import LocalNodes
from swgpar.fem.sparse import BlockRows, MatrixRows, create_matrix, fill_matrix, matrix_rows
from swgpar.fem.vectors import Exchange, create_vector
from swgpar.petsc import PETSc
from swgpar.solve.linear_solver import LinearSolver


class TangentMatrix:
    """Room for the blocks of elements and contacts, and their matrix.

    elements : of the model

    Attributes:
    pattern : keys row * n_global + column (n,) of the contact blocks, sorted; None where the
    elements have changed since the last `make_room`
    rows : blocks of the owned rows;  block_indices : of the element blocks among them
    matrix : of the last `fill`;  matrix_rows : which of the rows it has
    linear : solves with it, of the first Newton solver that needs it; later ones take it over
    """

    def __init__(self, elements: Elements) -> None:
        self.elements, self.partition = elements, elements.partition
        self.pattern: np.ndarray | None = None
        self.rows: BlockRows | None = None
        self.matrix_rows: MatrixRows | None = None
        self.block_indices: list[np.ndarray] = []
        self.matrix: PETSc.Mat | None = None
        self.linear: LinearSolver | None = None

    def destroy(self) -> None:
        """Release the matrix and what solves with it; collective. `make_room` begins anew."""
        for owned in (self.matrix, self.linear):
            if owned is not None:
                owned.destroy()
        self.pattern = self.matrix = self.linear = None

    def make_room(self, pattern: np.ndarray, local: LocalNodes, exchange: Exchange) -> None:
        """Make room for contact blocks with these keys (n,), sorted; collective. Where there is
        room for them and others, as after an extension, the matrix stays, and its factor.

        local, exchange : the nodes that this rank sees, and their values of a vector
        """
        lacks = self.pattern is None or not np.isin(pattern, self.pattern, assume_unique=True).all()
        if not self.partition.comm.allreduce(int(lacks), op=MPI.MAX):
            self.rows.number = local.number
            return
        self.pattern = pattern
        self.rows, self.block_indices = self.elements.rows(pattern, local.number)
        if self.matrix is not None:
            self.matrix.destroy()
        work = create_vector(self.partition)
        self.matrix_rows = matrix_rows(self.rows, local, exchange, work)
        work.destroy()
        self.matrix = create_matrix(self.partition, self.rows, self.matrix_rows)

    def fill(self) -> None:
        """Fill the matrix with the blocks; collective."""
        fill_matrix(self.matrix, self.rows, self.matrix_rows)

    def norm_of_diagonal(self) -> float:
        """Norm (N/mm) of the diagonal blocks of all nodes that elements have; collective."""
        own = np.arange(self.partition.row_start, self.partition.row_start + self.partition.n_own)
        keys = np.delete(
            own * self.partition.n_global + own, self.elements.pattern.nodes_without_elements
        )
        diagonal = self.rows.values[np.searchsorted(self.rows.keys, keys)]
        squares = float(np.einsum("nkk,nkk->", diagonal, diagonal))
        return float(np.sqrt(self.partition.comm.allreduce(squares, op=MPI.SUM)))
