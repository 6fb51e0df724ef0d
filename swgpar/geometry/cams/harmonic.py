"""Harmonic cam: the radius is a cosine of the polar angle, with two lobes or three."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.geometry.arrays import Floats
from swgpar.geometry.cams.polar import PolarCurve


@dataclass(frozen=True)
class HarmonicCam(PolarCurve):
    """Curve r(theta) = (a + b) / 2 + (a - b) / 2 cos(lobes theta), theta from +y; a and b in mm."""

    a: float
    b: float
    lobes: int

    def radius(self, theta: Floats) -> tuple[Floats, Floats, Floats]:
        """See `PolarCurve`."""
        wave, order = 0.5 * (self.a - self.b), self.lobes
        cosine, sine = wave * np.cos(order * theta), np.sin(order * theta)
        return 0.5 * (self.a + self.b) + cosine, -wave * order * sine, -(order**2) * cosine
