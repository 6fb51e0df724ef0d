"""Types of arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]
Ints = NDArray[np.int32]

SignedDistance = tuple[Floats, Floats, Floats]
"""Distance (n,) mm from a curve, positive outside, outward unit normal (n, 2), and k (n,) 1/mm with
the distance's Hessian k t t^T, at points (n, 2)."""
