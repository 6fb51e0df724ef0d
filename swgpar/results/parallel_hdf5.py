"""One HDF5 file written by all ranks at once, completely or not at all.

Rank 0 lays out the file (contiguous data sets, space set aside on the disk), all ranks then open it with
HDF5's MPI driver and write their own rows, rank 0 renames it. HDF5 does not survive a full disk inside
a parallel write or close; here the disk is found full before the first parallel call.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import nullcontext, suppress
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mpi4py import MPI

from swgpar.errors import OutputError
from swgpar.results.atomic import TEMPORARY, agreed, discard, finish, reserve

if MPI.COMM_WORLD.size > 1:  # Debian's h5py picks its MPI build by looking at Open MPI's own launcher only
    os.environ.setdefault("H5PY_ALWAYS_USE_MPI", "1")

import h5py  # noqa: E402

LAYOUT_BYTES = 65536
"""Upper bound of the size of a file's headers."""


class Block(NamedTuple):
    """Rows of a data set on this rank.

    array : (n, ...) the rows, same type and trailing shape on every rank
    first : row of the data set that array[0] is
    total : rows of the data set
    """

    array: np.ndarray
    first: int
    total: int


def require_parallel(comm: MPI.Comm) -> None:
    """Raise OutputError when several ranks are to write and h5py has no MPI support."""
    if comm.size > 1 and not h5py.get_config().mpi:
        raise OutputError(
            f"cannot write results on {comm.size} ranks: this h5py was built without MPI "
            "(Debian: install python3-h5py-mpi; pip: HDF5_MPI=ON pip install --no-binary=h5py h5py)"
        )


def write(
    path: Path,
    comm: MPI.Comm,
    blocks: Mapping[str, Block],
    attrs: Mapping[str, Mapping[str, Any]] | None = None,
) -> None:
    """Write a file of data sets atomically; collective, with the same names on every rank.

    Parameters
    ----------
    path : the file; an earlier one stays until the new one is complete
    blocks : data set name (groups separated by "/") -> rows of this rank
    attrs : group name -> its HDF5 attributes, used from rank 0; "/" is the file itself

    Raises
    ------
    OutputError
        On every rank, naming file and reason; the earlier file is then untouched.
    """
    temporary = path.with_name(path.name + TEMPORARY)
    try:
        with agreed(comm, path):
            if comm.rank == 0:
                _lay_out(temporary, blocks, attrs or {})
        _fill(temporary, path, comm, blocks)
        with agreed(comm, path):
            if comm.rank == 0:
                finish(temporary, path)
    except BaseException:
        if comm.rank == 0:
            discard(temporary)
        raise


def _lay_out(temporary: Path, blocks: Mapping[str, Block], attrs: Mapping[str, Mapping[str, Any]]) -> None:
    shapes = {name: (block.total, *block.array.shape[1:]) for name, block in blocks.items()}
    size = sum(int(np.prod(shapes[name])) * blocks[name].array.dtype.itemsize for name in blocks) + LAYOUT_BYTES
    discard(temporary)
    reserve(temporary, size)
    early = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    early.set_layout(h5py.h5d.CONTIGUOUS)
    early.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    early.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    with h5py.File(temporary, "w") as file:
        for name, block in blocks.items():
            group, _, leaf = name.rpartition("/")
            parent = file.require_group(group) if group else file
            h5py.h5d.create(
                parent.id,
                leaf.encode(),
                h5py.h5t.py_create(block.array.dtype),
                h5py.h5s.create_simple(shapes[name]),
                dcpl=early,
            )
        for name, values in attrs.items():
            file.require_group(name).attrs.update(values)
    reserve(temporary, temporary.stat().st_size)


def _fill(temporary: Path, path: Path, comm: MPI.Comm, blocks: Mapping[str, Block]) -> None:
    # Opening and closing are collective, writing one's own rows is not: a rank that fails never leaves
    # the others waiting in a call that it skipped.
    driver = {"driver": "mpio", "comm": comm} if comm.size > 1 else {}
    with agreed(comm, path):
        file = h5py.File(temporary, "r+", **driver)
    failure: Exception | None = None
    try:
        for name, (array, first, _) in blocks.items():
            if len(array):
                file[name][first : first + len(array)] = array
    except (OSError, RuntimeError, ValueError, TypeError) as error:
        failure = error
    with agreed(comm, path):
        with suppress(RuntimeError) if failure else nullcontext():
            file.close()
        if failure:
            raise OSError(str(failure))


def read_rows(path: Path, comm: MPI.Comm, ranges: Mapping[str, tuple[int, int]]) -> dict[str, np.ndarray]:
    """Rows first .. first + count - 1 of data sets; each rank reads its own, errors are raised on all."""
    arrays: dict[str, np.ndarray] = {}
    with agreed(comm, path, "read"):
        with h5py.File(path, "r") as file:
            for name, (first, count) in ranges.items():
                if name not in file:
                    raise ValueError(f"it has no data set {name!r}")
                if first + count > file[name].shape[0]:
                    raise ValueError(f"{name!r} has {file[name].shape[0]} rows, {first + count} are needed")
                arrays[name] = file[name][first : first + count]
    return arrays
