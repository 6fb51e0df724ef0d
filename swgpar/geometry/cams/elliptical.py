"""Elliptical cam (section 3.2.2): major semi-axis a along +y, minor semi-axis b along x."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.geometry.arrays import SignedDistance


@dataclass(frozen=True)
class EllipticalCam:
    """Ellipse with semi-axes a (along y) and b (along x), mm."""

    a: float
    b: float

    def evaluate(self, xy: np.ndarray) -> SignedDistance:
        """Signed distance, outward normal and Hessian factor at points near the curve.

        The foot point (b sin t, a cos t) solves ((b sin t, a cos t) - p) . (b cos t, -a sin t) = 0
        by Newton from the radial projection; with b^2 / a above the distance inside to round-off.
        """
        x, y = np.asarray(xy, dtype=float).T
        a, b = self.a, self.b
        t = np.arctan2(x / b, y / a)
        for _ in range(30):
            s, c = np.sin(t), np.cos(t)
            value = (b * s - x) * b * c - (a * c - y) * a * s
            slope = b * b * (c * c - s * s) + x * b * s - a * a * (c * c - s * s) + y * a * c
            step = value / slope
            t = t - step
            if np.max(np.abs(step), initial=0.0) < 1e-15:
                break
        s, c = np.sin(t), np.cos(t)
        normal = np.column_stack([a * s, b * c])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        distance = (x - b * s) * normal[:, 0] + (y - a * c) * normal[:, 1]
        curvature = a * b / (a * a * s * s + b * b * c * c) ** 1.5
        return distance, normal, curvature / (1.0 + curvature * distance)

    def outline(self, n: int) -> np.ndarray:
        """Points (n, 2), mm, of the curve, clockwise from the tip."""
        t = 2.0 * np.pi * np.arange(n) / n
        return np.column_stack([self.b * np.sin(t), self.a * np.cos(t)])
