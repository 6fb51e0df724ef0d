"""The last converged state in one file, independent of the number of ranks that wrote it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.results import parallel_hdf5
from swgpar.results.atomic import agreed, to_json
from swgpar.results.parallel_hdf5 import Block

NAME = "checkpoint.h5"
_ATTRS = "attrs_json"


def write_checkpoint(
    out: Path, comm: MPI.Comm, blocks: Mapping[str, tuple[np.ndarray, int, int]], attrs: Mapping[str, Any]
) -> None:
    """Replace `out`/checkpoint.h5. The previous one stays valid until the new one is complete. Collective.

    Parameters
    ----------
    out : results folder
    blocks : name -> (rows of this rank (n, ...), first row, rows in total)
    attrs : what else the state is made of, as JSON can hold it (numbers keep all digits); used from rank 0
    """
    # An HDF5 attribute ends at 64 KiB, the history of a long run does not: the text goes into a data set.
    text = np.frombuffer(comm.bcast(to_json(dict(attrs)) if comm.rank == 0 else None), dtype=np.uint8)
    rows = {name: Block(np.asarray(array), first, total) for name, (array, first, total) in blocks.items()}
    rows[_ATTRS] = Block(text if comm.rank == 0 else text[:0], 0, len(text))
    parallel_hdf5.write(Path(out) / NAME, comm, rows)


def read_checkpoint(
    path: Path,
    comm: MPI.Comm,
    ranges: Mapping[str, tuple[int, int]] | None = None,
) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Read rows of a checkpoint; collective, on any number of ranks.

    Parameters
    ----------
    path : the checkpoint file
    ranges : name -> (first row, number of rows) wanted by this rank; without it only the attributes are read

    Returns
    -------
    arrays : name -> (count, ...)
    attrs : as given to `write_checkpoint`
    """
    path = Path(path)
    size = 0
    with agreed(comm, path, "read"):
        if comm.rank == 0:
            with parallel_hdf5.h5py.File(path, "r") as file:
                if _ATTRS not in file:
                    raise ValueError("it is not a checkpoint of swgpar")
                size = file[_ATTRS].shape[0]
    size = comm.bcast(size)
    arrays = parallel_hdf5.read_rows(path, comm, {**(ranges or {}), _ATTRS: (0, size)})
    return arrays, json.loads(arrays.pop(_ATTRS).tobytes())
