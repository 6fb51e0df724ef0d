"""Files that are written completely or not at all, and errors that are raised on all ranks.

A file is written under a temporary name in the same folder, flushed to the disk and renamed. A
process that is killed leaves the previous file, never a part of a new one.
"""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from mpi4py import MPI

from swgpar.errors import OutputError, SwgparError
from swgpar.results import made_files
from swgpar.whole_files import sync

T = TypeVar("T")

TEMPORARY = ".swgpar.tmp"
"""Suffix of files being written; left-overs of a killed run are removed by the next one."""


FAILURES = (OSError, RuntimeError, ValueError, KeyError)
"""Errors of files that libraries raise."""


HDF5 = re.compile(r"^'?(Unable to|Can't) .*\(.*\)")
"""Messages of the library HDF5, which name parts of its inside."""


def reason_of(error: BaseException) -> str:
    """Reason of a failure without traceback, number or file name."""
    if isinstance(error, OSError) and error.errno:
        return os.strerror(error.errno)  # h5py has a text of its own in its place
    text = str(error).splitlines()[0] if str(error) else type(error).__name__
    if HDF5.search(text):
        return "it is no HDF5 file of this program, or was cut off or changed"
    return text


def raise_first(comm: MPI.Comm, error: SwgparError | None) -> None:
    """Raise on all ranks the error of the first rank that has one; collective."""
    found = next((e for e in comm.allgather(error) if e is not None), None)
    if found is not None:
        raise found from None


def on_all(comm: MPI.Comm, task: Callable[[], T]) -> T:
    """What `task` returns; an error on one rank is raised on all, so that none waits. Collective.

    `task` must not contain collective calls after a statement that can fail on one rank only.
    """
    failure: SwgparError | None = None
    try:
        value = task()
    except SwgparError as error:
        failure = error
    raise_first(comm, failure)
    return value


def on_root(comm: MPI.Comm, task: Callable[[], T]) -> T:
    """What `task` returns on rank 0, on every rank; its error is raised on all. Collective."""
    return comm.bcast(on_all(comm, lambda: task() if comm.rank == 0 else None))


@contextmanager
def agreed(comm: MPI.Comm, path: Path, action: str = "write") -> Iterator[None]:
    """Run a block in which a rank may fail alone; its error, or OutputError, is raised on all.

    The block must not contain collective calls after a statement that can fail on one rank only.
    It is collective itself: every rank enters and leaves it.
    """
    failure: SwgparError | None = None
    try:
        yield
    except SwgparError as error:
        failure = error
    except Exception as error:
        # what a file of anybody holds may raise anything; else it is an error of the program
        if action != "read" and not isinstance(error, FAILURES):
            raise
        named = getattr(error, "filename", None) if action == "read" else None
        failure = OutputError(f"cannot {action} {named or path}: {reason_of(error)}")
    raise_first(comm, failure)


def reserve(path: Path, size: int) -> None:
    """Reserve `size` bytes for a file on the disk: a full disk is found here, not later."""
    if size == 0:
        return
    handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
    try:
        os.posix_fallocate(handle, 0, size)
    finally:
        os.close(handle)


def finish(temporary: Path, path: Path) -> None:
    """Flush a finished temporary file to the disk and give it its name.

    Raises OutputError where a results folder has a file of this name that no run has made.
    """
    made_files.note(path)
    sync(temporary)
    os.replace(temporary, path)
    sync(path.parent)


def discard(path: Path) -> None:
    """Remove a temporary file if it exists."""
    with suppress(OSError):
        path.unlink()


def write_file(path: Path, content: bytes) -> None:
    """Write a whole file atomically; call it on one rank only."""
    temporary = path.with_name(path.name + TEMPORARY)
    discard(temporary)
    try:
        with open(temporary, "xb") as file:
            file.write(content)
        finish(temporary, path)
    except BaseException:
        discard(temporary)
        raise


def write_from_root(comm: MPI.Comm, path: Path, content: bytes) -> None:
    """Write the content that rank 0 holds; collective, the error is raised on all ranks."""
    with agreed(comm, path):
        if comm.rank == 0:
            write_file(path, content)


def to_json(data: dict[str, Any]) -> bytes:
    """JSON text of a dict that may hold NumPy scalars and arrays, paths and dataclasses.

    Numbers that are not finite become null: JSON has none.
    """
    return (json.dumps(_finite(data), indent=2, allow_nan=False) + "\n").encode()


def plain(value: Any) -> Any:
    """A NumPy scalar or array, a path or a dataclass as the `json` module writes it."""
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    if isinstance(value, Path):
        return str(value)
    if is_dataclass(value):
        return {each.name: getattr(value, each.name) for each in fields(value)}
    raise TypeError(f"a {type(value).__name__} cannot be written as JSON")


def _finite(value: Any) -> Any:
    """The value in types of JSON, with None for numbers that are not finite."""
    if value is None or isinstance(value, (str, bool, int)):
        return value
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: _finite(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(one) for one in value]
    return _finite(plain(value))
