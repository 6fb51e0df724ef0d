"""Harmonic cam: the radius is a cosine of the polar angle, with two lobes or three."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.geometry.arrays import SignedDistance

MOST_STEPS = 30
"""Newton steps to a foot point: near the curve some 5 reach round-off."""


@dataclass(frozen=True)
class HarmonicCam:
    """Curve r(theta) = (a + b) / 2 + (a - b) / 2 cos(lobes theta), theta from +y; a and b in mm."""

    a: float
    b: float
    lobes: int

    def _radius(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Radius, mm, and its first two derivatives by theta."""
        wave, order = 0.5 * (self.a - self.b), self.lobes
        cosine, sine = wave * np.cos(order * theta), np.sin(order * theta)
        return 0.5 * (self.a + self.b) + cosine, -wave * order * sine, -(order**2) * cosine

    def evaluate(self, xy: np.ndarray) -> SignedDistance:
        """Signed distance, outward normal and Hessian factor at points near the curve.

        The foot point X solves (X - p) . X' = 0 by Newton from the polar angle of p. Points inside
        must be nearer to the curve than its radius of curvature.
        """
        x, y = np.asarray(xy, dtype=float).T
        size, angle = np.hypot(x, y), np.arctan2(-x, y)
        theta = angle
        for _ in range(MOST_STEPS):
            r, r1, r2 = self._radius(theta)
            # the point in the radial and the circumferential direction of the foot point
            along, across = size * np.cos(angle - theta), size * np.sin(angle - theta)
            value = (r - along) * r1 - across * r
            slope = r1 * r1 + r * along + (r - along) * r2 - 2.0 * across * r1
            step = value / slope
            theta = theta - step
            if np.max(np.abs(step), initial=0.0) < 1e-15:
                break
        r, r1, r2 = self._radius(theta)
        speed = np.hypot(r, r1)
        sine, cosine = np.sin(theta), np.cos(theta)
        normal = np.column_stack([-r * sine + r1 * cosine, r * cosine + r1 * sine]) / speed[:, None]
        distance = (x + r * sine) * normal[:, 0] + (y - r * cosine) * normal[:, 1]
        curvature = (r * r + 2.0 * r1 * r1 - r * r2) / speed**3
        return distance, normal, curvature / (1.0 + curvature * distance)

    def outline(self, n: int) -> np.ndarray:
        """Points (n, 2), mm, of the curve at equal polar angles, counter-clockwise from +y."""
        theta = 2.0 * np.pi * np.arange(n) / n
        radius = self._radius(theta)[0]
        return radius[:, None] * np.column_stack([-np.sin(theta), np.cos(theta)])
