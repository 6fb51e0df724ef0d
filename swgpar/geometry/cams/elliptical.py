"""Elliptical cam (section 3.2.2): major semi-axis a along +y, minor semi-axis b along x."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.geometry.cams.parametric import ParametricCam


@dataclass(frozen=True)
class EllipticalCam(ParametricCam):
    """Ellipse with semi-axes a (along y) and b (along x), mm.

    Foot points are found from everywhere but a distance inside of the least radius of curvature,
    b^2 / a.
    """

    a: float
    b: float

    def curve(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Points -b sin t + i a cos t."""
        sine, cosine = np.sin(t), np.cos(t)
        point = -self.b * sine + 1j * self.a * cosine
        return point, -self.b * cosine - 1j * self.a * sine, -point

    def near(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Those on the same ray."""
        return np.arctan2(-x / self.b, y / self.a)
