"""What the deflection does to the rim of the flexible spline, in closed form."""

from __future__ import annotations

import numpy as np


def axial_travel(
    deflection: float, length: float, middle: float, height: float, lobes: int
) -> float:
    """Axial displacement (mm) of a tooth at the major axis towards the closed end of a cup.

    The cup is taken as a wall that bends without extension, with a radial deflection d / 2 cos
    n phi that grows linearly from the closed end, n lobes. Such a wall moves axially by r d /
    (2 n² L) (Love's inextensional mode), and the tooth leans by d / (2 L).

    deflection, length : mm, d and L;  middle : mm, radius r of the middle of the rim
    height : mm, of the pitch circle above it
    """
    return 0.5 * deflection / length * (middle / lobes**2 + height)


def omitted_bending(
    deflection: float, inner_radius: float, rim: float, n_teeth: int, lobes: int, elliptical: bool
) -> float:
    """Share of the bending strain that the plane model's condensed sectors leave out, at most.

    The change of the rim's curvature rotates the ends of a sector, a pitch apart, by theta
    relative to each other. The strain left out is theta^2 / 8, here divided by the bending
    strain. With n lobes the curvature changes by (n^2 - 1) d / (2 r^2) on a cam that the rim
    follows all around, as an ellipse. A ring that touches at its major axis only bends 1.4
    times as much there, on rollers 70 degrees apart 2.9 times: 3 covers both.

    deflection, inner_radius, rim : mm, d, r and the thickness of the rim
    """
    factor = 1.0 if elliptical else 3.0
    curvature = factor * 0.5 * (lobes**2 - 1) * deflection / inner_radius**2
    pitch = 2.0 * np.pi * inner_radius / n_teeth
    return (curvature * pitch) ** 2 / 8.0 / (0.5 * rim * curvature)
