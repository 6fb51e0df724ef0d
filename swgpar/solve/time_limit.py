"""What ends a run between two Newton iterations, for all its solvers, also those on coarser meshes:
its time limit, or who has begun it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from mpi4py import MPI

_limit: ContextVar[tuple[float, float] | None] = ContextVar("time limit", default=None)
"""Seconds of the limit, and the time.monotonic() at which it has passed."""

_stop: ContextVar[Callable[[], bool] | None] = ContextVar("stop", default=None)
"""Whether the run is to end."""


@contextmanager
def limited(seconds: float | None) -> Iterator[None]:
    """Limit the wall time (s) of the block, from now on; None sets no limit."""
    token = _limit.set(None if seconds is None else (seconds, time.monotonic() + seconds))
    try:
        yield
    finally:
        _limit.reset(token)


@contextmanager
def stopped_by(stop: Callable[[], bool] | None) -> Iterator[None]:
    """End the block where `stop` says so, which rank 0 calls; None never does."""
    token = _stop.set(stop)
    try:
        yield
    finally:
        _stop.reset(token)


def ending(comm: MPI.Comm) -> str:
    """Why a run ends now, by the clock and the `stop` of rank 0; empty where it goes on.
    Collective where there is either."""
    limit, stop = _limit.get(), _stop.get()
    if limit is None and stop is None:
        return ""
    found = ""
    if comm.rank == 0 and limit is not None and time.monotonic() > limit[1]:
        found = f"the time limit of {limit[0]:g} s (solver.time_limit) has passed"
    elif comm.rank == 0 and stop is not None and stop():
        found = "the run was stopped"
    return str(comm.bcast(found))
