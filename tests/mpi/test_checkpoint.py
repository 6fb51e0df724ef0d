"""Checkpoints that are damaged, foreign or of another version are refused in a sentence that says
what to do."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from mpi4py import MPI

from swgpar.errors import OutputError
from swgpar.load.load_states import Stage
from swgpar.results import checkpoint, parallel_hdf5
from swgpar.results.folder import CHECKPOINT
from swgpar.results.parallel_hdf5 import Block

ROWS = np.arange(7 * 5 * 3, dtype=float).reshape(7, 5, 3)


@dataclass(frozen=True)
class Inner:
    """Part of a content."""

    values: Mapping[str, Sequence[float]]
    pairs: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class Content:
    """Content with all kinds of values."""

    name: str
    rows: list[dict[str, Any]]
    wall_s: float
    stage: Stage
    inner: Inner | None = None
    by_name: dict[str, Inner] = field(default_factory=dict)


INNER = Inner({"a": [0.1, float("inf")]}, ((0.1, 2.0),))
CONTENT = Content("x", [{"a": 0.1, "b": "c"}], 1.5, Stage.LOAD, INNER, {"one": INNER})


def write(folder: Path, comm: MPI.Comm) -> Path:
    first, end = (len(ROWS) * rank // comm.size for rank in (comm.rank, comm.rank + 1))
    path = folder / CHECKPOINT
    checkpoint.write_checkpoint(
        path, comm, {"body": Block(ROWS[first:end], first, len(ROWS))}, CONTENT
    )
    return path


def edit(path: Path, change: Callable[[h5py.File], None]) -> None:
    with h5py.File(path, "r+") as file:
        change(file)


def flip(path: Path, at: int) -> None:
    content = bytearray(path.read_bytes())
    content[at] ^= 1
    path.write_bytes(content)


def of_rows(path: Path) -> int:
    """Where the rows begin in the file."""
    with h5py.File(path, "r") as file:
        return file["body"].id.get_offset()


def remove(file: h5py.File, *names: str) -> None:
    for name in names:
        del file[name]


DAMAGE = {
    "cut off": (lambda path: path.write_bytes(path.read_bytes()[:-200]), "is damaged"),
    "empty": (lambda path: path.write_bytes(b""), "is damaged"),
    "a text": (lambda path: path.write_text("hello"), "is damaged"),
    "a bit of the rows": (
        lambda path: flip(path, of_rows(path) + 100),
        "is damaged: body is not what was written",
    ),
    "a bit of the attributes": (
        lambda path: edit(path, lambda file: file["attrs_json"].__setitem__(5, 65)),
        "is damaged: its attributes are not",
    ),
    "rows are gone": (
        lambda path: edit(path, lambda file: remove(file, "body")),
        "is damaged: body is not",
    ),
    "another program's": (
        lambda path: edit(path, lambda file: remove(file, "attrs_json")),
        "is no checkpoint of",
    ),
    "older": (
        lambda path: edit(path, lambda file: remove(file, "version", "attrs_sha256")),
        "by another version",
    ),
    "newer": (
        lambda path: edit(path, lambda file: file["version"].__setitem__(0, 99)),
        "by another version",
    ),
}


def test_what_is_written_is_read(tmp_path: Path) -> None:
    path = write(tmp_path, MPI.COMM_SELF)
    checkpoint.require_undamaged(path, MPI.COMM_SELF)
    assert checkpoint.read_checkpoint(path, MPI.COMM_SELF, Content) == CONTENT
    assert (
        parallel_hdf5.read_rows(path, MPI.COMM_SELF, {"body": (2, 3)})["body"] == ROWS[2:5]
    ).all()


def test_versions_are_named(tmp_path: Path) -> None:
    path = write(tmp_path, MPI.COMM_SELF)
    edit(path, lambda file: file["version"].__setitem__(0, 99))
    with pytest.raises(
        OutputError, match=rf"\(version 99 of checkpoints, this one reads {checkpoint.VERSION}\)"
    ):
        checkpoint.read_checkpoint(path, MPI.COMM_SELF, Content)


def test_another_content_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path, MPI.COMM_SELF)
    with pytest.raises(OutputError, match="is damaged: values is not what a checkpoint has"):
        checkpoint.read_checkpoint(path, MPI.COMM_SELF, Inner)


@pytest.mark.parametrize("name", DAMAGE)
def test_damage_is_found(tmp_path: Path, name: str) -> None:
    damage, words = DAMAGE[name]
    path = write(tmp_path, MPI.COMM_SELF)
    damage(path)
    with pytest.raises(OutputError) as caught:
        checkpoint.require_undamaged(path, MPI.COMM_SELF)
    assert words in str(caught.value) and str(caught.value).startswith(str(path))
    assert "start again with overwrite = true (--overwrite)" in str(caught.value)


@pytest.mark.parallel(2)
def test_on_ranks(tmp_path: Path) -> None:
    """The sums do not depend on the number of ranks, and all ranks find damage that one of them
    reads."""
    comm = MPI.COMM_WORLD
    folder = comm.bcast(tmp_path)
    path = write(folder, comm)
    checkpoint.require_undamaged(path, comm)
    checkpoint.require_undamaged(path, MPI.COMM_SELF)
    comm.Barrier()
    if comm.rank == 0:
        flip(path, of_rows(path) + 8 * 15 * 6)  # the last row, which rank 1 reads
    comm.Barrier()
    with pytest.raises(OutputError, match="body is not what was written"):
        checkpoint.require_undamaged(path, comm)
