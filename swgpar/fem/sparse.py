"""Sparse block rows of the tangent and their transfer into a PETSc matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.fem.partition import Partition
from swgpar.petsc import PETSc


@dataclass
class BlockRows:
    """Blocks of the owned rows, of a symmetric matrix those of the upper triangle, sorted by column.

    start : (n_own + 1,) int64;  column : (n_blocks,) int32 global
    values : (n_blocks, 3, 3) N/mm, values[p, l, k] is entry (k, l) of block p
    number : (n_local,) int32 global number of each local node
    """

    start: np.ndarray
    column: np.ndarray
    values: np.ndarray
    number: np.ndarray
    n_own: int
    keys: np.ndarray
    symmetric: bool


def create_matrix(partition: Partition, rows: BlockRows) -> PETSc.Mat:
    """Blocked matrix with the pattern of `rows`, not yet filled; a symmetric one keeps its upper triangle."""
    mat = PETSc.Mat().create(comm=partition.comm)
    size = (partition.dims * partition.n_own, partition.dims * partition.n_global)
    mat.setSizes((size, size))
    mat.setBlockSize(partition.dims)
    mat.setType(PETSc.Mat.Type.SBAIJ if rows.symmetric else PETSc.Mat.Type.BAIJ)
    lo, hi = partition.row_start, partition.row_start + partition.n_own
    own = np.repeat(np.arange(rows.n_own), np.diff(rows.start))
    own_column = (rows.column >= lo) & (rows.column < hi)
    diagonal = np.bincount(own[own_column], minlength=rows.n_own).astype(PETSc.IntType)
    off = np.bincount(own[~own_column], minlength=rows.n_own).astype(PETSc.IntType)
    mat.setPreallocationNNZ((diagonal, off))
    # on every rank: one without rows would not have it, and the ranks would disagree in the assembly
    mat.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, True)
    mat.setOption(PETSc.Mat.Option.ROW_ORIENTED, False)
    if rows.symmetric:
        mat.setOption(PETSc.Mat.Option.IGNORE_LOWER_TRIANGULAR, True)
        mat.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        mat.setOption(PETSc.Mat.Option.SPD, True)
    return mat


def fill_matrix(mat: PETSc.Mat, rows: BlockRows) -> None:
    """Overwrite the owned rows of `mat` with the blocks, without their z in the plane."""
    dims = mat.getBlockSize()
    values = rows.values[:, :dims, :dims].ravel()
    mat.setValuesBlockedIJV(rows.start.astype(PETSc.IntType), rows.column, values, addv=PETSc.InsertMode.INSERT_VALUES)
    mat.assemble()


def add_diagonal(rows: BlockRows, partition: Partition, nodes: np.ndarray, blocks: np.ndarray) -> None:
    """Add blocks (n, 3, 3) or (3, 3), N/mm, to the diagonal at own nodes (n,), each of them once."""
    keys = (partition.row_start + nodes.astype(np.int64)) * (partition.n_global + 1)
    rows.values[np.searchsorted(rows.keys, keys)] += blocks


def add_unit_diagonal(rows: BlockRows, partition: Partition, without_elements: np.ndarray, value: float) -> None:
    """Put `value` on the diagonal of the multiplier blocks, which couple through the border only, and of free nodes.

    without_elements : (n,) own nodes without elements
    """
    nodes = np.concatenate([without_elements + partition.row_start, partition.multiplier_nodes])
    nodes = nodes[(nodes >= partition.row_start) & (nodes < partition.row_start + rows.n_own)]
    add_diagonal(rows, partition, nodes - partition.row_start, value * np.eye(3))
