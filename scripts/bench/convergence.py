"""Limits and rates of values on meshes of which each has elements half as long as the one before."""

from __future__ import annotations

import numpy as np


def limit(values: list[float]) -> float:
    """Aitken's extrapolation of the last three values: exact for an error of any single power of the element size.

    The last value itself where the differences do not shrink.
    """
    first, second = values[-2] - values[-3], values[-1] - values[-2]
    if not abs(second) < abs(first):
        return values[-1]
    return values[-1] + second**2 / (first - second)


def rates(errors: list[float]) -> list[float | None]:
    """Observed orders in the element size, none for the first mesh or beside an error of zero."""
    pairs = zip(errors[:-1], errors[1:])
    return [None, *(float(np.log2(a / b)) if a > 0.0 and b > 0.0 else None for a, b in pairs)]
