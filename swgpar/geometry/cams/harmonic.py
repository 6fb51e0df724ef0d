"""Harmonic cam: the radius is a cosine of the polar angle, with two lobes or three."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.geometry.cams.parametric import ParametricCam


@dataclass(frozen=True)
class HarmonicCam(ParametricCam):
    """Curve r(theta) = (a + b) / 2 + (a - b) / 2 cos(lobes theta), theta from +y; a and b in mm."""

    a: float
    b: float
    lobes: int

    def curve(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Points i r(theta) exp(i theta)."""
        wave, order = 0.5 * (self.a - self.b), self.lobes
        cosine, turn = wave * np.cos(order * t), 1j * np.exp(1j * t)
        r = 0.5 * (self.a + self.b) + cosine
        r1, r2 = -wave * order * np.sin(order * t), -(order**2) * cosine
        return r * turn, (r1 + 1j * r) * turn, (r2 - r + 2j * r1) * turn

    def near(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Those on the same ray."""
        return np.arctan2(-x, y)
