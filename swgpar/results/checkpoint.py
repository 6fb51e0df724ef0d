"""The last converged state in one file, independent of the number of ranks that wrote it.

The file has the version of its content, and sums by which damage is found: one of the attributes,
and one of every data set, the same however its rows are distributed.
"""

from __future__ import annotations

import hashlib
import json
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

import h5py
import numpy as np
from mpi4py import MPI
from pydantic import TypeAdapter, ValidationError

from swgpar.errors import OutputError
from swgpar.results import parallel_hdf5
from swgpar.results.atomic import agreed, plain, sentence
from swgpar.results.parallel_hdf5 import Block

T = TypeVar("T")

NAME = "checkpoint.h5"

VERSION = 8
"""Of the content, a run's included."""

_ATTRS, _VERSION, _DIGEST = "attrs_json", "version", "attrs_sha256"
_CONTENT, _SUMS = "content", "sums"


def write_checkpoint(path: Path, comm: MPI.Comm, blocks: Mapping[str, Block], content: Any) -> None:
    """Replace a checkpoint. The previous one stays valid until the new one is complete. Collective.

    Parameters
    ----------
    path : the file
    blocks : rows by name
    content : a dataclass, what else the state is made of, as JSON can hold it (numbers keep all
    digits); of rank 0
    """
    rows = dict(blocks)
    sums = {body: comm.allreduce(_sum(block.array, block.first)) for body, block in rows.items()}
    # An HDF5 attribute ends at 64 KiB, the history of a long run does not: the text goes into a
    # data set.
    text = comm.bcast(_text({_CONTENT: content, _SUMS: sums}) if comm.rank == 0 else None)
    for key, values in (
        (_ATTRS, np.frombuffer(text, dtype=np.uint8)),
        (_DIGEST, np.frombuffer(hashlib.sha256(text).digest(), dtype=np.uint8)),
        (_VERSION, np.array([VERSION])),
    ):
        rows[key] = Block(values if comm.rank == 0 else values[:0], 0, len(values))
    parallel_hdf5.write(path, comm, rows)


def _text(content: Mapping[str, Any]) -> bytes:
    """The content for `json.loads`, numbers that are not finite among it: columns of tables have
    them."""
    return json.dumps(content, default=plain).encode()


def read_checkpoint(path: Path, comm: MPI.Comm, kind: type[T]) -> T:
    """Read the content of a checkpoint; collective. `parallel_hdf5.read_rows` reads the rows.

    kind : the dataclass of the content, read by its fields and their annotations

    Raises
    ------
    OutputError
        The file cannot be read, is damaged, none of swgpar, or of another version; on all ranks.
    """
    text, failure = b"", None
    if comm.rank == 0:
        try:
            text = _read_attrs(path)
        except OutputError as error:
            failure = error
    failure, text = comm.bcast((failure, text))
    if failure is not None:
        raise failure
    try:
        return TypeAdapter(kind).validate_python(json.loads(text)[_CONTENT])
    except ValidationError as error:
        raise _damaged(
            path, f"{error.errors()[0]['loc'][-1]} is not what a checkpoint has"
        ) from None


def require_undamaged(path: Path, comm: MPI.Comm) -> None:
    """Read the whole checkpoint, each rank a part of it; raises OutputError on all ranks where it
    is damaged."""
    sums: dict[str, int] = {}
    with agreed(comm, path, "read"):
        sums = json.loads(_read_attrs(path))[_SUMS]
    found: dict[str, int] = {}
    with agreed(comm, path, "read"), h5py.File(path, "r") as file:
        for name in sums:
            rows = file[name].shape[0] if name in file else 0
            first, end = (rows * rank // comm.size for rank in (comm.rank, comm.rank + 1))
            found[name] = _sum(file[name][first:end], first) if rows else 0
    for name, expected in sums.items():
        if comm.allreduce(found[name]) != expected:
            raise _damaged(path, f"{name} is not what was written")


def _read_attrs(path: Path) -> bytes:
    """Text of the attributes of a file of this version."""
    try:
        with h5py.File(path, "r") as file:
            names = set(file)
            if _ATTRS not in names:
                raise OutputError(
                    f"{path} is no checkpoint of swgpar: restore the one of this run, or start "
                    f"again with overwrite = "
                    "true (--overwrite)"
                )
            version = int(file[_VERSION][0]) if {_VERSION, _DIGEST} <= names else 0
            if version != VERSION:
                raise OutputError(
                    f"{path} was written by another version of swgpar (version {version} of "
                    f"checkpoints, this one "
                    f"reads {VERSION}): continue with that version, or start again with overwrite "
                    f"= true (--overwrite)"
                )
            text, digest = file[_ATTRS][:].tobytes(), file[_DIGEST][:].tobytes()
    except (OSError, RuntimeError, ValueError, KeyError, TypeError, IndexError) as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise OutputError(f"cannot read {path}: {sentence(error)}") from None
        raise _damaged(path, sentence(error)) from None
    if hashlib.sha256(text).digest() != digest:
        raise _damaged(path, "its attributes are not what was written")
    return text


def _damaged(path: Path, reason: str) -> OutputError:
    return OutputError(
        f"{path} is damaged: {reason}; restore it from a copy, or start again with overwrite = "
        f"true (--overwrite)"
    )


def _sum(rows: np.ndarray, first: int) -> int:
    """Sum over rows of their CRC, each begun with the number of its row: it adds up over ranks."""
    return sum(
        zlib.crc32(np.ascontiguousarray(row).tobytes(), first + k) for k, row in enumerate(rows)
    )
