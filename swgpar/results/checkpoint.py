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
from swgpar.results.atomic import agreed, on_root, plain, reason_of
from swgpar.results.parallel_hdf5 import Block

T = TypeVar("T")

VERSION = 13
"""Of the content, a run's included."""

_ATTRS, _VERSION, _DIGEST = "attrs_json", "version", "attrs_sha256"
_CONTENT, _SUMS = "content", "sums"


def write_checkpoint(path: Path, comm: MPI.Comm, blocks: Mapping[str, Block], content: Any) -> None:
    """Replace a checkpoint. The previous one stays valid until the new one is complete. Collective.

    Parameters
    ----------
    path : the file
    blocks : rows by name
    content : a dataclass of rank 0, what else the state is made of, as JSON can hold it
    """
    rows = dict(blocks)
    sums = {body: comm.allreduce(_sum(block.array, block.first)) for body, block in rows.items()}
    # an attribute of HDF5 ends at 64 KiB, the history of a long run does not: a data set holds it
    text = on_root(comm, lambda: _text({_CONTENT: content, _SUMS: sums}))
    digest = hashlib.sha256(text).digest()
    rows[_ATTRS] = Block.of_root(comm, np.frombuffer(text, dtype=np.uint8))
    rows[_DIGEST] = Block.of_root(comm, np.frombuffer(digest, dtype=np.uint8))
    rows[_VERSION] = Block.of_root(comm, np.array([VERSION]))
    parallel_hdf5.write(path, comm, rows)


def _text(content: Mapping[str, Any]) -> bytes:
    """The content for `json.loads`; columns of tables have numbers that are not finite."""
    return json.dumps(content, default=plain).encode()


def read_checkpoint(path: Path, comm: MPI.Comm, kind: type[T]) -> T:
    """Read the content of a checkpoint; collective. `parallel_hdf5.read_rows` reads the rows.

    kind : the dataclass of the content, read by its fields and their annotations

    Raises
    ------
    OutputError
        The file cannot be read, is damaged, none of swgpar, or of another version; on all ranks.
    """
    text = on_root(comm, lambda: _read_attrs(path))
    try:
        return TypeAdapter(kind).validate_python(json.loads(text)[_CONTENT])
    except ValidationError as error:
        key = error.errors()[0]["loc"][-1]
        raise _damaged(path, f"{key} is not what a checkpoint has") from None


def require_undamaged(path: Path, comm: MPI.Comm) -> None:
    """Read the whole checkpoint, each rank a part; raises OutputError on all where it is
    damaged."""
    sums: dict[str, int] = {}
    with agreed(comm, path, "read"):
        sums = json.loads(_read_attrs(path))[_SUMS]
    parts: dict[str, int] = {}
    with agreed(comm, path, "read"), h5py.File(path, "r") as file:
        for name in sums:
            rows = file[name].shape[0] if name in file else 0
            first, end = (rows * rank // comm.size for rank in (comm.rank, comm.rank + 1))
            parts[name] = _sum(file[name][first:end], first) if rows else 0
    for name, expected in sums.items():
        if comm.allreduce(parts[name]) != expected:
            raise _damaged(path, f"{name} is not what was written")


def _read_attrs(path: Path) -> bytes:
    """Text of the attributes of a file of this version."""
    try:
        with h5py.File(path, "r") as file:
            names = set(file)
            if _ATTRS not in names:
                raise OutputError(
                    f"{path} is no checkpoint of swgpar: restore the one of this run, or start "
                    "again with overwrite = true (--overwrite)"
                )
            version = int(file[_VERSION][0]) if {_VERSION, _DIGEST} <= names else 0
            if version != VERSION:
                raise OutputError(
                    f"{path} was written by another version of swgpar (version {version} of "
                    f"checkpoints, this one reads {VERSION}): continue with that version, or start "
                    "again with overwrite = true (--overwrite)"
                )
            text, digest = file[_ATTRS][:].tobytes(), file[_DIGEST][:].tobytes()
    except (OSError, RuntimeError, ValueError, KeyError, TypeError, IndexError) as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise OutputError(f"cannot read {path}: {reason_of(error)}") from None
        raise _damaged(path, reason_of(error)) from None
    if hashlib.sha256(text).digest() != digest:
        raise _damaged(path, "its attributes are not what was written")
    return text


def _damaged(path: Path, reason: str) -> OutputError:
    return OutputError(
        f"{path} is damaged: {reason}; restore it from a copy, or start again with overwrite = "
        "true (--overwrite)"
    )


def _sum(rows: np.ndarray, first: int) -> int:
    """Sum over rows of their CRC, each begun with the number of its row: it adds up over ranks."""
    return sum(
        zlib.crc32(np.ascontiguousarray(row).tobytes(), first + k) for k, row in enumerate(rows)
    )
