"""Random samples that do not depend on the number of ranks, and tasks dealt over the ranks.

Samples are drawn block by block. Every block has a counter-based stream of its own (Philox, keyed
by the seed and the block's number), so that it does not matter who draws it or when.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.errors import ConvergenceError
from swgpar.tasks import Send, share_tasks

Tasks = Mapping[str, Sequence[Callable[[], Any]]]
"""Groups of tasks by name."""


@dataclass(frozen=True)
class TaskSeconds:
    """Times of the tasks of a group, s. total : together;  largest : of the slowest"""

    total: float
    largest: float


def random_stream(seed: int, *key: int) -> np.random.Generator:
    """The stream of a seed and a key, such as the number of a block."""
    return np.random.Generator(np.random.Philox(np.random.SeedSequence(seed, spawn_key=key)))


def block_sizes(count: int, size: int) -> list[int]:
    """Sizes of the blocks that `count` samples are drawn in."""
    return [min(size, count - first) for first in range(0, count, size)]


def run_tasks(comm: MPI.Comm, groups: Tasks) -> tuple[dict[str, list[Any]], dict[str, TaskSeconds]]:
    """Results and times of all tasks by group, on every rank; each task runs on one. Collective.

    A ConvergenceError of a task is raised on all ranks.
    """
    tasks = [(name, task) for name, group in groups.items() for task in group]
    done: dict[int, tuple[Any, float]] = {}

    def run(number: int, send: Send) -> None:
        begin = time.perf_counter()
        try:
            result = tasks[number][1]()
        except ConvergenceError as error:
            result = error
        send((number, (result, time.perf_counter() - begin)))

    share_tasks(comm, len(tasks), run, lambda message: done.update([message]))
    done = comm.bcast(done)
    results: dict[str, list[Any]] = {name: [] for name in groups}
    seconds: dict[str, list[float]] = {name: [] for name in groups}
    for number, (name, _) in enumerate(tasks):
        result, taken = done[number]
        if isinstance(result, ConvergenceError):
            raise result
        results[name].append(result)
        seconds[name].append(taken)
    times = {name: TaskSeconds(sum(each), max(each, default=0.0)) for name, each in seconds.items()}
    return results, times
