"""Files that all ranks write: the same content on any number of ranks, errors on all of them."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
from mpi4py import MPI

from swgpar.errors import OutputError
from swgpar.results import parallel_hdf5
from swgpar.results.parallel_hdf5 import Block

COMM = MPI.COMM_WORLD

WHOLE = {
    "body/points": np.linspace(0.0, 1.0, 41 * 3).reshape(41, 3),
    "body/cells": np.arange(17 * 8).reshape(17, 8),
    "body/vm": np.linspace(1.0, 2.0, 41, dtype=np.float32),
    "text": np.frombuffer(b"not a number of words", dtype=np.uint8),
    "nothing": np.zeros((0, 3)),
    "narrow": np.zeros((5, 0)),
}


def parts(comm: MPI.Comm) -> dict[str, Block]:
    """Rows of a rank: the last one has most, the first none of the text."""
    blocks = {}
    for name, whole in WHOLE.items():
        ends = [len(whole) * k**2 // comm.size**2 for k in range(comm.size + 1)]
        first, end = ends[comm.rank : comm.rank + 2]
        if name == "text":
            first, end = (0, len(whole)) if comm.rank == comm.size - 1 else (0, 0)
        blocks[name] = Block(whole[first:end], first, len(whole))
    return blocks


@pytest.mark.parallel([1, 2, 3])
@pytest.mark.parametrize("piece", [2**30, 64])
def test_content_does_not_depend_on_ranks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, piece: int
) -> None:
    """piece : bytes of one call of MPI; rows larger than it are written in several"""
    monkeypatch.setattr(parallel_hdf5, "PIECE_BYTES", piece)
    path = COMM.bcast(tmp_path) / "all.h5"
    parallel_hdf5.write(path, COMM, parts(COMM))
    with h5py.File(path, "r") as file:
        for name, whole in WHOLE.items():
            assert file[name].dtype == whole.dtype and file[name].shape == whole.shape
            assert (file[name][:] == whole).all(), name
    rows = parallel_hdf5.read_rows(path, COMM, {"body/points": (COMM.rank, 7)})
    assert (rows["body/points"] == WHOLE["body/points"][COMM.rank : COMM.rank + 7]).all()
    COMM.Barrier()  # a rank that is done removes the folder of the test


@pytest.mark.parallel([1, 2, 3])
def test_rows_are_written_where_they_lie(tmp_path: Path) -> None:
    """Data sets are whole, without chunks or filters: any program finds the rows at their
    offset."""
    path = COMM.bcast(tmp_path) / "all.h5"
    parallel_hdf5.write(path, COMM, parts(COMM))
    content = path.read_bytes()
    with h5py.File(path, "r") as file:
        for name in ("body/points", "body/cells", "body/vm", "text"):
            begin, whole = file[name].id.get_offset(), WHOLE[name]
            assert content[begin : begin + whole.nbytes] == whole.tobytes()
    COMM.Barrier()


@pytest.mark.parallel([1, 2, 3])
def test_no_folder(tmp_path: Path) -> None:
    path = COMM.bcast(tmp_path) / "missing" / "all.h5"
    with pytest.raises(OutputError, match="cannot write .*all.h5: No such file or directory"):
        parallel_hdf5.write(path, COMM, parts(COMM))
    COMM.Barrier()


@pytest.mark.parallel([2, 3])
def test_one_rank_fails(tmp_path: Path) -> None:
    """The error is raised on all ranks, the file of before stays, and nothing else is left."""
    path = COMM.bcast(tmp_path) / "all.h5"
    parallel_hdf5.write(path, COMM, parts(COMM))
    COMM.Barrier()
    before = path.read_bytes()
    COMM.Barrier()
    blocks = parts(COMM)
    if COMM.rank == COMM.size - 1:
        blocks["body/vm"] = Block(np.array([None]), 0, 41)
    with pytest.raises(OutputError, match="cannot write .*all.h5: "):
        parallel_hdf5.write(path, COMM, blocks)
    COMM.Barrier()
    assert path.read_bytes() == before and [entry.name for entry in path.parent.iterdir()] == [
        "all.h5"
    ]
    COMM.Barrier()
