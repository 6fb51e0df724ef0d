"""Cams whose radius is a function of the polar angle."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from swgpar.geometry.arrays import Floats, SignedDistance

MOST_STEPS = 30
"""Newton steps to a foot point: near the curve some 5 reach round-off."""

CONVERGED = 1e-14
"""Step (rad) at which a foot point is found."""


class PolarCurve(ABC):
    """A curve whose radius is a function of the polar angle."""

    @abstractmethod
    def radius(self, theta: Floats) -> tuple[Floats, Floats, Floats]:
        """Radius (n,) mm and its first two derivatives at angles (n,) rad from the major axis,
        counter-clockwise."""

    def evaluate(self, xy: np.ndarray) -> SignedDistance:
        """Signed distance, outward normal and Hessian factor at points (n, 2) mm near the curve.

        The foot point X solves (X - p) . X' = 0 by Newton from the polar angle of p. Points inside
        must be nearer to the curve than its radius of curvature.
        """
        x, y = np.asarray(xy, dtype=float).T
        size, angle = np.hypot(x, y), np.arctan2(-x, y)
        theta = angle
        for _ in range(MOST_STEPS):
            r, r1, r2 = self.radius(theta)
            # the point in the radial and the circumferential direction of the foot point
            along, across = size * np.cos(angle - theta), size * np.sin(angle - theta)
            value = (r - along) * r1 - across * r
            slope = r1 * r1 + r * along + (r - along) * r2 - 2.0 * across * r1
            step = value / slope
            theta = theta - step
            if np.max(np.abs(step), initial=0.0) < CONVERGED:
                break
        r, r1, r2 = self.radius(theta)
        speed = np.hypot(r, r1)
        sine, cosine = np.sin(theta), np.cos(theta)
        normal = np.column_stack([-r * sine + r1 * cosine, r * cosine + r1 * sine]) / speed[:, None]
        distance = (x + r * sine) * normal[:, 0] + (y - r * cosine) * normal[:, 1]
        curvature = (r * r + 2.0 * r1 * r1 - r * r2) / speed**3
        return distance, normal, curvature / (1.0 + curvature * distance)

    def outline(self, n: int) -> np.ndarray:
        """Points (n, 2), mm, of the curve at equal polar angles, counter-clockwise from +y."""
        theta = 2.0 * np.pi * np.arange(n) / n
        return self.radius(theta)[0][:, None] * np.column_stack([-np.sin(theta), np.cos(theta)])


@dataclass(frozen=True)
class PolarCam(PolarCurve):
    """A smooth curve through radii with their derivatives at equal angles around one lobe.

    Between two angles the radius is the polynomial of fifth degree that has all six values, so
    that the curvature is continuous.

    values : (3, n + 1) mm, radius and its first two derivatives by the angle, from one lobe's tip
    to the next
    lobes : of the cam
    deviation : mm, largest radial distance of the curve from what it stands for
    """

    values: Floats
    lobes: int
    deviation: float

    def radius(self, theta: Floats) -> tuple[Floats, Floats, Floats]:
        """See `PolarCurve`."""
        count = self.values.shape[1] - 1
        width = 2.0 * np.pi / (self.lobes * count)
        place = np.mod(theta / width, count)
        k = np.minimum(place.astype(int), count - 1)
        t = place - k
        r, slope, bend = self.values * np.array([[1.0], [width], [width**2]])
        a0, a1, a2 = r[k], slope[k], 0.5 * bend[k]
        # what the parabola at the first angle misses at the second
        miss = r[k + 1] - (a0 + a1 + a2)
        miss1 = slope[k + 1] - (a1 + 2.0 * a2)
        miss2 = bend[k + 1] - 2.0 * a2
        a3 = 10.0 * miss - 4.0 * miss1 + 0.5 * miss2
        a4 = -15.0 * miss + 7.0 * miss1 - miss2
        a5 = 6.0 * miss - 3.0 * miss1 + 0.5 * miss2
        value = a0 + t * (a1 + t * (a2 + t * (a3 + t * (a4 + t * a5))))
        first = a1 + t * (2.0 * a2 + t * (3.0 * a3 + t * (4.0 * a4 + t * 5.0 * a5)))
        second = 2.0 * a2 + t * (6.0 * a3 + t * (12.0 * a4 + t * 20.0 * a5))
        return value, first / width, second / width**2


def mirrored_lobe(half: Floats) -> Floats:
    """Values (3, 2 n + 1) around a lobe, from those (3, n + 1) of the half from its tip on."""
    back = half[:, -2::-1] * np.array([[1.0], [-1.0], [1.0]])
    return np.concatenate([half, back], axis=1)
