"""Shear below a contact."""

from __future__ import annotations

import numpy as np

DEPTHS = np.linspace(0.05, 1.6, 32)
"""Depths at which the shear is evaluated, over the half width."""


def largest_shear(
    low: np.ndarray, high: np.ndarray, pressure: np.ndarray, half_width: float
) -> float:
    """Largest shear stress below a half plane under strips, half the difference of the principal
    stresses, MPa.

    low, high : (n,) mm, ends of the strips;  pressure : (n,) MPa, uniform on each;  half_width : mm
    """
    at = (0.5 * (low + high))[::2, None, None]
    depth = (DEPTHS * half_width)[:, None]
    # a strip under uniform pressure: stresses of a half plane in closed form (Johnson, Contact
    # Mechanics, 2.5)
    t1, t2 = np.arctan2(at - low, depth), np.arctan2(at - high, depth)
    sine, cosine = np.sin(2.0 * t1) - np.sin(2.0 * t2), np.cos(2.0 * t1) - np.cos(2.0 * t2)
    angle = t1 - t2
    across = -(2.0 * angle - sine) @ pressure / (2.0 * np.pi)
    normal = -(2.0 * angle + sine) @ pressure / (2.0 * np.pi)
    shear = cosine @ pressure / (2.0 * np.pi)
    return float(np.hypot(0.5 * (across - normal), shear).max())
