"""Root of a function of one variable between two places.

SciPy's `brentq` would do, but `scipy.optimize` takes 0.05 s and more to load beside the parts of
SciPy that a design needs, a tenth of `swgpar check`.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable

MOST = 200
"""Evaluations at most. Bisection alone needs some 60 for round-off."""

EPS = sys.float_info.epsilon


def root_between(
    function: Callable[[float], float], low: float, high: float, xtol: float = 0.0
) -> float:
    """A root of a continuous function, to `xtol` and round-off [Chandrupatla, Advances
    in Engineering Software 28 (1997), 145-149].

    function : its values at `low` and `high` have different signs, or one of them is zero

    Inverse quadratic interpolation where the last three values allow it, else bisection. Raises
    ValueError where the signs are equal.
    """
    a, b = float(high), float(low)
    fa, fb = float(function(a)), float(function(b))
    if not fa * fb <= 0.0:
        raise ValueError(f"no change of sign between {low:g} and {high:g}")
    c, fc, share = b, fb, 0.5
    for _ in range(MOST):
        best, value = (a, fa) if abs(fa) < abs(fb) else (b, fb)
        tolerance = 2.0 * EPS * abs(best) + 0.5 * xtol
        if value == 0.0 or abs(b - a) <= 2.0 * tolerance:
            return best
        least = tolerance / abs(b - a)
        x = a + min(max(share, least), 1.0 - least) * (b - a)
        fx = float(function(x))
        if math.copysign(1.0, fx) == math.copysign(1.0, fa):
            c, fc = a, fa
        else:
            c, fc, b, fb = b, fb, a, fa
        a, fa = x, fx
        share = _share(a, b, c, fa, fb, fc)
    return a if abs(fa) < abs(fb) else b


def _share(a: float, b: float, c: float, fa: float, fb: float, fc: float) -> float:
    """Share of the way from a to b to the next place, from the values at three places."""
    if fc == fb or c == b:
        return 0.5
    xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
    if not (phi**2 < xi and (1.0 - phi) ** 2 < 1.0 - xi):
        return 0.5
    first = fa / (fb - fa) * fc / (fb - fc)
    return first + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
