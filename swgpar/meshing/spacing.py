"""Division of lines into elements: counts, grading, points on straight lines and circles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from swgpar.geometry.arrays import Floats


def polar(radius: float | Floats, angle: float | Floats) -> Floats:
    """Return the points (n, 2), mm, at `radius`, mm, and `angle` (rad, clockwise from +y)."""
    return np.stack(np.broadcast_arrays(radius * np.sin(angle), radius * np.cos(angle)), axis=-1)


def line(start: Floats, end: Floats, fractions: Floats) -> Floats:
    """Points (n, 2) at the `fractions` (n,) of the straight line from `start` to `end`."""
    return start + np.asarray(fractions)[:, None] * (end - start)


def even(n: int) -> Floats:
    """Return n + 1 numbers from 0 to 1 at equal distances."""
    return np.linspace(0.0, 1.0, n + 1)


def graded(n: int, ratio: float) -> Floats:
    """Return n + 1 numbers from 0 to 1; each step is `ratio` times the one before."""
    steps = ratio ** np.arange(n)
    return np.concatenate(([0.0], np.cumsum(steps) / steps.sum()))


def share(total: int, lengths: Floats) -> NDArray[np.intp]:
    """Share `total` >= k elements out in proportion to `lengths` (k,), at least one each."""
    counts = np.ones(len(lengths), dtype=np.intp)
    for _ in range(total - len(lengths)):
        counts[np.argmax(lengths / counts)] += 1
    return counts


def split_count(n: int, first: float, second: float) -> tuple[int, int]:
    """Share `n` elements between two lengths, mm, at least one each; none for no length."""
    if min(first, second) <= 1e-9 * max(first, second):
        return (n, 0) if first > second else (0, n)
    counts = share(n, np.array((first, second)))
    return int(counts[0]), int(counts[1])
