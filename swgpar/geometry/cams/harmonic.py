"""Harmonic cam: the radius is a cosine of the polar angle, with two lobes or three."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.geometry.arrays import SignedDistance
from swgpar.geometry.cams.polar import distance_from, polar_outline


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

        Points inside must be nearer to the curve than its radius of curvature.
        """
        return distance_from(self._radius, xy)

    def outline(self, n: int) -> np.ndarray:
        """Points (n, 2), mm, of the curve at equal polar angles, counter-clockwise from +y."""
        return polar_outline(self._radius, n)
