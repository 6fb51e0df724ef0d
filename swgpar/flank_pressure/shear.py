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
    depth = (DEPTHS * half_width)[:, None]
    at = (0.5 * (low + high))[::2, None, None]
    before, after = at - low, at - high
    # a strip under uniform pressure: stresses of a half plane in closed form (Johnson, Contact
    # Mechanics, 2.5), with the sines and cosines of twice the angles by the lengths
    first, last = before**2 + depth**2, after**2 + depth**2
    normal = depth * (before / first - after / last) @ pressure
    shear = (after**2 / last - before**2 / first) @ pressure
    return float(np.hypot(normal, shear).max() / np.pi)
