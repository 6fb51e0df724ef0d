"""The time limit of a run, for all its solvers: on its own mesh and on coarser ones."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from mpi4py import MPI

_limit: ContextVar[tuple[float, float] | None] = ContextVar("time limit", default=None)
"""Seconds of the limit, and the time.monotonic() at which it has passed."""


@contextmanager
def limited(seconds: float | None) -> Iterator[None]:
    """Limit the wall time (s) of the block, from now on; None sets no limit."""
    token = _limit.set(None if seconds is None else (seconds, time.monotonic() + seconds))
    try:
        yield
    finally:
        _limit.reset(token)


def passed(comm: MPI.Comm) -> float | None:
    """The limit (s) if passed by the clock of rank 0, else None; collective where there is one."""
    limit = _limit.get()
    if limit is None:
        return None
    seconds, end = limit
    return seconds if comm.bcast(time.monotonic() > end) else None
