"""One HDF5 file written by all ranks at once, completely or not at all.

Rank 0 lays out the file (contiguous data sets, space set aside on the disk) and closes it. All
ranks then write their own rows with MPI-IO, at the offsets of the data sets in the file, and rank 0
renames it. HDF5 is used by one process at a time and needs no MPI. A full disk is found by rank 0
before the first row is written.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
from mpi4py import MPI

from swgpar.results.atomic import TEMPORARY, agreed, discard, finish, reserve

LAYOUT_BYTES = 65536
"""Upper bound of the size of a file's headers."""

PIECE_BYTES = 2**30
"""Most bytes of one call of MPI, which counts them in 32 bits."""


class Block(NamedTuple):
    """Rows of a data set on this rank.

    array : (n, ...) the rows, same type and trailing shape on every rank
    first : row of the data set that array[0] is
    total : rows of the data set
    """

    array: np.ndarray
    first: int
    total: int

    @classmethod
    def of_root(cls, comm: MPI.Comm, array: np.ndarray) -> Block:
        """Rows (n, ...) that all ranks have, written by rank 0."""
        return cls(np.ascontiguousarray(array if comm.rank == 0 else array[:0]), 0, len(array))


def write(path: Path, comm: MPI.Comm, blocks: Mapping[str, Block]) -> None:
    """Write a file of data sets atomically; collective, with the same names on every rank.

    Parameters
    ----------
    path : the file; an earlier one stays until the new one is complete
    blocks : data set name (groups separated by "/") -> rows of this rank

    Raises
    ------
    OutputError
        On every rank, naming file and reason; the earlier file is then untouched.
    """
    temporary = path.with_name(path.name + TEMPORARY)
    offsets: dict[str, int] = {}
    try:
        with agreed(comm, path):
            if comm.rank == 0:
                offsets = _lay_out(temporary, blocks)
        _fill(temporary, path, comm, blocks, comm.bcast(offsets))
        with agreed(comm, path):
            if comm.rank == 0:
                finish(temporary, path)
    except BaseException:
        if comm.rank == 0:
            discard(temporary)
        raise


def _lay_out(temporary: Path, blocks: Mapping[str, Block]) -> dict[str, int]:
    """Make the file without its rows; returns where in the file the rows of each data set begin."""
    shapes = {name: (block.total, *block.array.shape[1:]) for name, block in blocks.items()}
    sizes = [int(np.prod(shapes[name])) * blocks[name].array.dtype.itemsize for name in blocks]
    discard(temporary)
    reserve(temporary, sum(sizes) + LAYOUT_BYTES)
    early = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    early.set_layout(h5py.h5d.CONTIGUOUS)
    early.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    early.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    offsets = {}
    with h5py.File(temporary, "w") as file:
        for name, block in blocks.items():
            group, _, leaf = name.rpartition("/")
            parent = file.require_group(group) if group else file
            made = h5py.h5d.create(
                parent.id,
                leaf.encode(),
                h5py.h5t.py_create(block.array.dtype),
                h5py.h5s.create_simple(shapes[name]),
                dcpl=early,
            )
            offsets[name] = made.get_offset()  # None without rows
    reserve(temporary, temporary.stat().st_size)
    return offsets


def _fill(
    temporary: Path,
    path: Path,
    comm: MPI.Comm,
    blocks: Mapping[str, Block],
    offsets: Mapping[str, int],
) -> None:
    assert isinstance(comm, MPI.Intracomm)  # a file belongs to the ranks of one group
    # Opening, flushing and closing are collective, writing one's own rows is not: a rank that fails
    # never leaves the others waiting in a call that it skipped.
    with agreed(comm, path):
        file = MPI.File.Open(comm, str(temporary), MPI.MODE_WRONLY)
    failure: Exception | None = None
    try:
        for name, (array, first, _) in blocks.items():
            if len(array):
                _write_rows(file, offsets[name], array, first)
    except (OSError, RuntimeError, ValueError, TypeError) as error:  # MPI's is a RuntimeError
        failure = error
    with agreed(comm, path):
        try:
            file.Sync()
        finally:
            file.Close()
        if failure:
            raise OSError(str(failure))


def _write_rows(file: MPI.File, begin: int, array: np.ndarray, first: int) -> None:
    """Write rows first .. of the data set whose rows begin at byte `begin`."""
    rows = np.ascontiguousarray(array)
    row_bytes = rows.nbytes // len(rows)
    content = rows.reshape(-1).view(np.uint8)
    for start in range(0, len(content), PIECE_BYTES):
        file.Write_at(
            begin + first * row_bytes + start, [content[start : start + PIECE_BYTES], MPI.BYTE]
        )


def read_rows(
    path: Path, comm: MPI.Comm, ranges: Mapping[str, tuple[int, int]]
) -> dict[str, np.ndarray]:
    """Rows first .. first + count - 1 of data sets; each rank its own, errors are raised on
    all."""
    arrays: dict[str, np.ndarray] = {}
    with agreed(comm, path, "read"), h5py.File(path, "r") as file:
        for name, (first, count) in ranges.items():
            if name not in file:
                raise ValueError(f"it has no data set {name!r}")
            present = file[name].shape[0]
            if first + count > present:
                raise ValueError(f"{name!r} has {present} rows, {first + count} are needed")
            arrays[name] = file[name][first : first + count]
    return arrays
