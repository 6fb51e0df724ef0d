"""Tasks shared by the ranks, none of which only serves the others, and reports to rank 0."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from mpi4py import MPI

PAUSE = 0.05
"""Seconds between two looks of a rank that has nothing left to do; MPI's own waiting would take a
whole core."""

Send = Callable[[Any], None]
"""Takes a message to rank 0."""


def share_tasks(
    comm: MPI.Comm, count: int, run: Callable[[int, Send], None], receive: Send
) -> None:
    """Run tasks 0 to count - 1, each on one rank: a free rank takes the next one. Collective.

    run : called with a number, and with what sends a message to rank 0
    receive : called on rank 0 with every message
    """
    if comm.size == 1:
        for number in range(count):
            run(number, receive)
        return
    own = comm.Dup()
    counter, reports = _Counter(own), _Reports(own, receive)
    while (number := counter.take()) < count:
        run(number, reports.send)
    reports.end()
    counter.free()
    own.Free()


class _Counter:
    """The numbers 0, 1, 2, ... of which each rank takes the next; rank 0 has the counter.

    Creation and `free` are collective, `take` is not.
    """

    def __init__(self, comm: MPI.Comm) -> None:
        assert isinstance(comm, MPI.Intracomm)  # a window belongs to the ranks of one group
        size = MPI.INT64_T.Get_size()
        self._window = MPI.Win.Allocate(size if comm.rank == 0 else 0, size, comm=comm)
        if comm.rank == 0:
            self._window.Lock(0, MPI.LOCK_EXCLUSIVE)
            self._window.tomemory()[:] = bytes(size)
            self._window.Unlock(0)
        comm.Barrier()

    def take(self) -> int:
        """The next number."""
        one, number = np.ones(1, dtype=np.int64), np.empty(1, dtype=np.int64)
        self._window.Lock(0, MPI.LOCK_SHARED)
        self._window.Fetch_and_op(one, number, 0, op=MPI.SUM)
        self._window.Unlock(0)
        return int(number[0])

    def free(self) -> None:
        """Give the memory back."""
        self._window.Free()


class _Reports:
    """Messages of all ranks to rank 0, which looks at them between its own increments.

    comm : used by this object alone
    receive : called on rank 0 with every message
    """

    def __init__(self, comm: MPI.Comm, receive: Send) -> None:
        self._comm, self._receive = comm, receive
        self._sent: list[MPI.Request] = []
        self._ended = 0

    def send(self, message: Any) -> None:
        """Tell rank 0; does not wait."""
        if self._comm.rank == 0:
            self._receive(message)
            self.look()
        else:
            self._sent = [request for request in self._sent if not request.Test()]
            self._sent.append(self._comm.isend(message, 0))

    def look(self) -> None:
        """Receive what has arrived on rank 0."""
        while self._comm.iprobe():
            message = self._comm.recv()
            if message is None:
                self._ended += 1
            else:
                self._receive(message)

    def end(self) -> None:
        """Wait until every rank has come here and rank 0 has received everything; collective."""
        if self._comm.rank != 0:
            self.send(None)
        while self._comm.rank == 0 and self._ended < self._comm.size - 1:
            self.look()
            time.sleep(PAUSE)
        all_here = self._comm.Ibarrier()
        while not all_here.Test():
            time.sleep(PAUSE)
        MPI.Request.Waitall(self._sent)
