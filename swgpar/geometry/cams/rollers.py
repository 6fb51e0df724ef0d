"""Two or four rollers as a cam (section 3.2.4): circles about centres on a circle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.geometry.arrays import SignedDistance
from swgpar.geometry.cams.piecewise import Circle
from swgpar.input.require import require


@dataclass(frozen=True)
class RollerCam:
    """Rollers of `radius` (mm), centres `reach` (mm) away from the axis at +-beta (rad) from +y and
    from -y; two of them where beta is 0."""

    reach: float
    beta: float
    radius: float

    @property
    def center(self) -> tuple[float, float]:
        """Centre of the roller in the first quadrant, mm."""
        return float(self.reach * np.sin(self.beta)), float(self.reach * np.cos(self.beta))

    @property
    def count(self) -> int:
        """Number of rollers."""
        return 4 if self.beta else 2

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
        each = n // self.count
        angle = 2.0 * np.pi * np.arange(each) / each
        roller = self.center + self.radius * np.column_stack([np.sin(angle), np.cos(angle)])
        signs = ((1, 1), (-1, 1), (-1, -1), (1, -1)) if self.beta else ((1, 1), (-1, -1))
        return np.concatenate([roller * sign for sign in signs])


def rollers(
    reach: float,
    beta: float,
    radius: float,
    name: str,
    *,
    centred: bool = True,
    beside: bool = False,
) -> RollerCam:
    """Rollers that keep clear of each other (section 5.5.1).

    reach : mm, of their centres from the axis;  beta : rad, 0 for two rollers;  radius : mm
    name : of the radius's key, for messages
    centred : whether the circle of the centres is given, or that of the outermost points
    beside : whether they lie beside each other along the axis, where they cannot touch
    """
    if beside:
        return RollerCam(reach, beta, radius)
    # neighbours lie at +-beta, opposite rollers on a diameter
    sine = np.sin(min(beta, 0.5 * np.pi - beta)) if beta else 1.0
    limit = reach * sine if centred else (reach + radius) * sine / (1.0 + sine)
    allowed = f"above 0 to below {limit:.6g} mm, where the rollers touch"
    require(radius < limit, name, radius, allowed)
    return RollerCam(reach, beta, radius)
