"""Sparse block rows of the tangent and their transfer into a PETSc matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.fem.local_nodes import LocalNodes
from swgpar.fem.partition import Partition
from swgpar.fem.vectors import Exchange
from swgpar.petsc import PETSc


@dataclass
class BlockRows:
    """Blocks of the owned rows, sorted by column; of a symmetric matrix the upper triangle.

    start : (n_own + 1,) int64;  column : (n_blocks,) int32 global
    values : (n_blocks, 3, 3) N/mm, values[p, l, k] is entry (k, l) of block p
    number : (n_local,) int32 global number of each local node

    Rows of nodes that nothing acts on are empty. The matrix does not have them (`MatrixRows`).
    """

    start: np.ndarray
    column: np.ndarray
    values: np.ndarray
    number: np.ndarray
    n_own: int
    keys: np.ndarray
    symmetric: bool


@dataclass(frozen=True)
class MatrixRows:
    """Rows of the matrix: those of the owned nodes that something acts on.

    active : (n,) owned nodes;  start : (n + 1,), column : (n_blocks,) of the blocks, numbered
    without empty rows
    first, count : number of the first row, and of all rows on all ranks
    """

    active: np.ndarray
    start: np.ndarray
    column: np.ndarray
    first: int
    count: int


def matrix_rows(
    rows: BlockRows, local: LocalNodes, exchange: Exchange, vector: PETSc.Vec
) -> MatrixRows:
    """Number the rows that are not empty; collective.

    local, exchange : the nodes that a rank sees, and their values of a vector
    vector : like that of the unknowns, to work with
    """
    comm = local.partition.comm
    active = np.flatnonzero(np.diff(rows.start))
    counts = comm.allgather(len(active))
    first, total = sum(counts[: comm.rank]), sum(counts)
    vector.set(-1.0)
    vector.array.reshape(-1, 3)[active, 0] = first + np.arange(len(active))
    number = exchange(vector)[:, 0]
    column = number[local.index(rows.column)].astype(PETSc.IntType)
    start = np.append(rows.start[active], rows.start[-1]).astype(PETSc.IntType)
    return MatrixRows(active, start, column, first, total)


def create_matrix(partition: Partition, rows: BlockRows, numbered: MatrixRows) -> PETSc.Mat:
    """Blocked matrix with the pattern of `rows`, to be filled; a symmetric one has one triangle."""
    mat = PETSc.Mat().create(comm=partition.comm)
    n_own = len(numbered.active)
    size = (partition.dims * n_own, partition.dims * numbered.count)
    mat.setSizes((size, size))
    mat.setBlockSize(partition.dims)
    mat.setType(PETSc.Mat.Type.SBAIJ if rows.symmetric else PETSc.Mat.Type.BAIJ)
    own = np.repeat(np.arange(n_own), np.diff(numbered.start))
    own_column = (numbered.column >= numbered.first) & (numbered.column < numbered.first + n_own)
    diagonal = np.bincount(own[own_column], minlength=n_own).astype(PETSc.IntType)
    off = np.bincount(own[~own_column], minlength=n_own).astype(PETSc.IntType)
    mat.setPreallocationNNZ((diagonal, off))
    # on every rank: one without rows would not have it, and the ranks would disagree in the
    # assembly
    mat.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, True)
    mat.setOption(PETSc.Mat.Option.ROW_ORIENTED, False)
    if rows.symmetric:
        mat.setOption(PETSc.Mat.Option.IGNORE_LOWER_TRIANGULAR, True)
        mat.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        mat.setOption(PETSc.Mat.Option.SPD, True)
    return mat


def fill_matrix(mat: PETSc.Mat, rows: BlockRows, numbered: MatrixRows) -> None:
    """Overwrite the owned rows of `mat` with the blocks, without their z in the plane."""
    dims = mat.getBlockSize()
    values = rows.values[:, :dims, :dims].ravel()
    mat.setValuesBlockedIJV(
        numbered.start, numbered.column, values, addv=PETSc.InsertMode.INSERT_VALUES
    )
    mat.assemble()


def add_diagonal(
    rows: BlockRows, partition: Partition, nodes: np.ndarray, blocks: np.ndarray
) -> None:
    """Add blocks (n, 3, 3) or (3, 3), N/mm, to the diagonal at own nodes (n,), each once."""
    keys = (partition.row_start + nodes.astype(np.int64)) * (partition.n_global + 1)
    rows.values[np.searchsorted(rows.keys, keys)] += blocks


def add_unit_diagonal(rows: BlockRows, partition: Partition, value: float) -> None:
    """Put `value` on the diagonal of the multipliers, which couple through the border only."""
    nodes = partition.multiplier_nodes - partition.row_start
    add_diagonal(rows, partition, nodes[(nodes >= 0) & (nodes < rows.n_own)], value * np.eye(3))
