"""Limits and rates of values on meshes of different element size."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

ORDERS = 0.2, 6.0
"""Orders that are taken for an asymptotic behaviour."""


def limit(values: list[float], sizes: list[float] | None = None) -> tuple[float, float | None]:
    """Limit and order p of the last three values, as v + c h^p; sizes h are halved from each to the
    next by default.

    Without such an order, or with fewer values, the last value, and no order. With halved sizes
    this is Aitken's extrapolation.
    """
    if len(values) < 3:
        return values[-1], None
    a, b, c = values[-3:]
    h = np.array(sizes[-3:] if sizes else [4.0, 2.0, 1.0])
    if b == c or (a - b) / (b - c) <= 0.0:
        return c, None

    def mismatch(p: float) -> float:
        high, middle, low = (h / h[2]) ** p
        return (high - middle) / (middle - low) - (a - b) / (b - c)

    low, high = ORDERS
    if mismatch(low) * mismatch(high) > 0.0:
        return c, None
    order = float(brentq(mismatch, low, high))
    return c + (c - b) / ((h[1] / h[2]) ** order - 1.0), order


def rates(errors: list[float]) -> list[float | None]:
    """Observed orders in the element size where each mesh halves it; none for the first or beside
    an error of zero."""
    pairs = zip(errors[:-1], errors[1:])
    return [None, *(float(np.log2(a / b)) if a > 0.0 and b > 0.0 else None for a, b in pairs)]
