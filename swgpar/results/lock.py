"""A lock on a results folder: two runs, on any machines, cannot write into it at once.

The system keeps the lock for as long as the process lives, so that one of a process that was killed
is none. Where a file system has no locks, a file with the owner decides.
"""

from __future__ import annotations

import errno
import functools
import os
import platform
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from swgpar.errors import OutputError
from swgpar.results.made_files import refuse_link

if TYPE_CHECKING:
    from filelock import BaseFileLock

NAME = "swgpar.lock"
"""In the results folder while a run writes there: number and machine of its process."""

OWNER = "swgpar.owner"
"""The same where the file system has no locks."""

WITHOUT_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP)
"""Error numbers of file systems that have no locks."""

Function = TypeVar("Function", bound=Callable[..., Any])

_held: dict[str, BaseFileLock] = {}
"""Resolved folder -> its lock, of this process."""


def acquire(folder: Path) -> None:
    """Lock an existing folder until the function decorated with `releasing` ends; on one rank.

    Raises OutputError when another process holds the lock, OSError when its file cannot be written.
    """
    # here, so that commands without results start sooner
    from filelock import FileLock, SoftFileLock, Timeout

    name, path, owner = str(folder.resolve()), folder / NAME, folder / OWNER
    if name in _held:
        return
    lock: BaseFileLock = FileLock(path, timeout=0.0, fallback_to_soft=False)
    for file in (path, owner):
        refuse_link(file)
    try:
        lock.acquire()
        path.write_text(f"{os.getpid()}\n{platform.node()}\n", encoding="utf-8")
    except Timeout:
        raise OutputError(_refusal(folder, path)) from None
    except OSError as error:
        if error.errno not in WITHOUT_LOCKS:
            raise
        lock = SoftFileLock(owner, timeout=0.0)
        try:
            lock.acquire()
        except Timeout:
            raise OutputError(
                f"{_refusal(folder, owner)}; if that process has ended, remove {owner}"
            ) from None
    _held[name] = lock


def releasing(function: Function) -> Function:
    """Decorator: locks that the function acquires are released when it returns or raises."""

    @functools.wraps(function)
    def wrapped(*arguments: Any, **keywords: Any) -> Any:
        before = set(_held)
        try:
            return function(*arguments, **keywords)
        finally:
            for folder in set(_held) - before:
                _release(folder)

    return wrapped  # type: ignore[return-value]


def _release(folder: str) -> None:
    """Give up the lock of a resolved folder."""
    with suppress(OSError):
        os.unlink(Path(folder) / NAME)
    _held.pop(folder).release()


def _refusal(folder: Path, path: Path) -> str:
    """Who holds the lock, by the lines of its file: the number of a process, its machine."""
    who = "another process"
    with suppress(OSError, ValueError, IndexError):
        process, host = path.read_text(encoding="utf-8").splitlines()[:2]
        since = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(path.stat().st_mtime))
        # filelock adds the namespace of a container to the name of its machine
        who = f"process {int(process)} on {host.partition('?')[0]} since {since}"
    return f"{folder} is in use by {who}: wait for its end, stop it, or choose another folder"
