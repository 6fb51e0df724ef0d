"""Four-roller cam (section 3.2.4): rollers at +-beta from the major axis inside of radius a."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.geometry.arrays import SignedDistance
from swgpar.geometry.cams.piecewise import Circle
from swgpar.input.require import require


@dataclass(frozen=True)
class FourRollerCam:
    """Rollers of `radius` (mm), centres at +-beta (rad) from +y and from -y, (a - radius) out."""

    a: float
    beta: float
    radius: float

    @property
    def center(self) -> tuple[float, float]:
        """Centre of the roller in the first quadrant, mm."""
        reach = self.a - self.radius
        return float(reach * np.sin(self.beta)), float(reach * np.cos(self.beta))

    def evaluate(self, xy: np.ndarray) -> SignedDistance:
        """Distance to the nearest roller, its normal and Hessian factor at points (n, 2), mm.

        On the axes the nearest roller and the normal change, far from the surface.
        """
        xy = np.asarray(xy, dtype=float)
        sign = np.where(xy < 0.0, -1.0, 1.0)
        distance, normal, k = Circle(self.center, self.radius).evaluate(xy * sign)
        return distance, normal * sign, k

    def outline(self, n: int) -> np.ndarray:
        """Points (n, 2), mm, of all rollers."""
        angle = 2.0 * np.pi * np.arange(n // 4) / (n // 4)
        roller = self.center + self.radius * np.column_stack([np.sin(angle), np.cos(angle)])
        return np.concatenate([roller * signs for signs in ((1, 1), (-1, 1), (-1, -1), (1, -1))])


def four_roller(a: float, beta: float, radius: float, name: str = "r_4") -> FourRollerCam:
    """Cam of four rollers that keep clear of each other (section 5.5.1); mm, `beta` in rad."""
    # neighbours at +-beta: (a - r) sin beta > r, and r < a / 2 keeps the opposite pairs apart
    small = min(beta, 0.5 * np.pi - beta)
    limit = a * np.sin(small) / (1.0 + np.sin(small))
    allowed = f"above 0 to below {limit:.6g} mm, where the rollers touch"
    require(radius < limit, name, radius, allowed)
    return FourRollerCam(a, beta, radius)
