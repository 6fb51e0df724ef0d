"""Oval cam: arcs of two radii, about the major and the minor axis, that join smoothly.

Along an arc the bending of the spline does not change. Of all shapes with the same deflection, arcs
of the half angle 45 degrees have the least largest bending: 0.80 of that on an ellipse.
"""

from __future__ import annotations

import numpy as np

from swgpar.geometry.cams.piecewise import Circle, PiecewiseCam
from swgpar.input.require import require


def arcs(a: float, b: float, beta: float, name: str) -> PiecewiseCam:
    """Oval with the semi-axes a and b, mm.

    beta : rad, half angle of the arcs about the major axis;  name : of its key, for messages

    Raises InputError where the arcs about the major axis would have no radius.
    """
    sine, cosine = np.sin(beta), np.cos(beta)
    offset = (a - b) / (1.0 - (1.0 - sine) / cosine)
    radius, outer = a - offset, a - offset + offset / cosine
    least = np.degrees(0.5 * np.pi - 2.0 * np.arctan(b / a))
    require(radius > 0.0, name, np.degrees(beta), f"above {least:.3g} to below 90 deg")
    joint = np.array([radius * sine, offset + radius * cosine])
    return PiecewiseCam(
        pieces=(
            Circle((b - outer, 0.0), outer),
            Circle((0.0, offset), radius),
            Circle((outer - b, 0.0), outer),
        ),
        joints=joint * [[1.0, 1.0], [-1.0, 1.0]],
        tangents=np.array([[-cosine, sine], [-cosine, -sine]]),
    )
