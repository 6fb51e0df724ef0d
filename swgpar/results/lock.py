"""A lock on a results folder: two runs cannot write into it at once, on this machine or another one.

The system keeps the lock (flock) for as long as the process lives, so that one of a process that was killed is none.
Where a file system has no locks, the record in the file decides.
"""

from __future__ import annotations

import fcntl
import functools
import json
import os
import platform
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar

from swgpar.errors import OutputError

NAME = "swgpar.lock"
"""In the results folder while a run writes there."""

Function = TypeVar("Function", bound=Callable[..., Any])

_held: dict[str, int] = {}
"""Resolved folder -> open file of its lock, of this process."""


def acquire(folder: Path) -> None:
    """Lock an existing folder for this process until `release`; call it on one rank.

    Raises OutputError when another process holds the lock, OSError when its file cannot be written.
    """
    name, path = str(folder.resolve()), folder / NAME
    while name not in _held:
        file = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            found = _read(file)
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise OutputError(_refusal(folder, found)) from None
            except OSError:  # a file system without locks
                if found and not _has_ended(found):
                    raise OutputError(f"{_refusal(folder, found)}; if that process has ended, remove {path}") from None
            if not _is_same(file, path):  # removed by the process that held it before
                continue
            record = {"host": platform.node(), "process": os.getpid(), "begun": _begin_of(os.getpid())}
            record["since"] = time.strftime("%Y-%m-%d %H:%M:%S")
            os.ftruncate(file, 0)
            os.pwrite(file, json.dumps(record).encode(), 0)
            _held[name], file = file, -1
        finally:
            if file >= 0:
                os.close(file)


def release(folder: str) -> None:
    """Give up the lock of a resolved folder."""
    file = _held.pop(folder)
    with suppress(OSError):
        os.unlink(Path(folder) / NAME)
    os.close(file)


def releasing(function: Function) -> Function:
    """Decorator: locks that the function acquires are released when it returns or raises."""

    @functools.wraps(function)
    def wrapped(*arguments: Any, **keywords: Any) -> Any:
        before = set(_held)
        try:
            return function(*arguments, **keywords)
        finally:
            for folder in set(_held) - before:
                release(folder)

    return wrapped  # type: ignore[return-value]


def _read(file: int) -> dict[str, Any]:
    """The record of who holds the lock; empty when there is none."""
    with suppress(OSError, ValueError):
        record = json.loads(os.pread(file, 4096, 0))
        if isinstance(record, dict):
            return record
    return {}


def _refusal(folder: Path, record: dict[str, Any]) -> str:
    who = "another process"
    if {"process", "host", "since"} <= set(record):
        who = f"process {record['process']} on {record['host']} since {record['since']}"
    return f"{folder} is in use by {who}: wait for its end, stop it, or choose another folder"


def _has_ended(record: dict[str, Any]) -> bool:
    """Whether the process of a record is one of this machine that lives no more."""
    number = record.get("process")
    if record.get("host") != platform.node() or not isinstance(number, int):
        return False
    return _begin_of(number) != record.get("begun")


def _begin_of(process: int) -> str:
    """When a process of this machine began, in ticks since the start of it; empty when there is none."""
    with suppress(OSError):
        return Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[19]
    return ""


def _is_same(file: int, path: Path) -> bool:
    with suppress(OSError):
        return os.path.samestat(os.fstat(file), os.stat(path))
    return False
