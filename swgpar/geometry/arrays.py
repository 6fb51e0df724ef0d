"""Types of arrays, and points of a plane as pairs and as complex numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]
Ints = NDArray[np.int32]

SignedDistance = tuple[Floats, Floats, Floats]
"""Distance (n,) mm from a curve, positive outside, outward unit normal (n, 2), and k (n,) 1/mm with
the distance's Hessian k t t^T, at points (n, 2)."""


def as_complex(points: Floats) -> Complex:
    """Points (n, 2) as x + i y (n,)."""
    return np.ascontiguousarray(points, dtype=np.float64).view(np.complex128)[:, 0]


def as_points(z: Complex) -> Floats:
    """Points x + i y (n,) as (n, 2)."""
    return np.ascontiguousarray(z, dtype=np.complex128).view(np.float64).reshape(-1, 2)
