"""Error of the last of several windows, each on a finer mesh than the one before."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

LOWEST_ORDER, ASSUMED_ORDER, HIGHEST_ORDER = 1.0, 1.5, 2.5
"""Bounds of the observed order, and the order that two windows are judged by. In roots 2 to 3.4 is
seen, but it rests on two differences only, at the ends of teeth about 1. With the highest one the
error of most windows is 0.5 to 3 times the true one (docs/verification/effectivity.md)."""


def error_of(levels: Sequence[float], ratio: float, highest: float = HIGHEST_ORDER) -> float:
    """Error of the last value on meshes whose element sizes have this ratio, by the order observed
    on the last three. highest : order that is not exceeded

    Two values are judged by `ASSUMED_ORDER`; a single one, the others being left out, has no bound.
    """
    if len(levels) < 2 or math.isnan(levels[-2]):
        return np.inf
    last = levels[-1] - levels[-2]
    if len(levels) == 2:
        return abs(last) / (ratio ** min(ASSUMED_ORDER, highest) - 1.0)
    before = levels[-2] - levels[-3]
    # a last change that is small by chance is no convergence
    change = max(abs(last), abs(before) / ratio**highest)
    order = LOWEST_ORDER  # changes of different signs show none
    if before * last > 0.0:
        order = float(np.clip(np.log(before / last) / np.log(ratio), LOWEST_ORDER, highest))
    return change / (ratio**order - 1.0)


def error_at_ends(ends: Sequence[float], between: Sequence[float], ratio: float) -> float:
    """Error of the last value at the ends of the teeth, which is the largest one.

    Where it falls from window to window, the largest stress is not above it, and not below the one
    between the ends. Where that was the larger one on the window before, the largest of both is
    followed: coarser windows may have no node at the end that is read.
    """
    error = error_of(ends, ratio)
    if len(between) != len(ends) or len(ends) == 1:
        return error
    if ends[-1] < ends[-2]:
        return min(error, ends[-1] - between[-1] + error_of(between, ratio))
    if ends[-2] < between[-2]:
        return min(error, error_of(list(np.fmax(ends, between)), ratio))
    return error
