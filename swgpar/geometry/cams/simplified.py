"""Simplified cam (section 3.2.1): semicircles joined by straight lines, tips on the major axis."""

from __future__ import annotations

import numpy as np

from swgpar.geometry.cams.piecewise import Circle, Line, PiecewiseCam


def simplified(a: float, radius: float) -> PiecewiseCam:
    """Semicircles of `radius` (eq. 3.2) about (0, +-(a - radius)), mm; a circle if radius = a."""
    height = a - radius
    return PiecewiseCam(
        pieces=(
            Line((radius, 0.0), (1.0, 0.0)),
            Circle((0.0, height), radius),
            Line((-radius, 0.0), (-1.0, 0.0)),
        ),
        joints=np.array([[radius, height], [-radius, height]]),
        tangents=np.array([[0.0, 1.0], [0.0, -1.0]]),
    )
