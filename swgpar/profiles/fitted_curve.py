"""A curve that costs much to evaluate, such as an envelope, replaced by a spline."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy

from swgpar.geometry.arrays import Floats
from swgpar.profiles.curved_segment import (
    DEGREE,
    CurvedSegment,
    CurvePoints,
    by_pieces,
    points_of,
)
from swgpar.profiles.flank import MISMATCH

INTERVALS = 16, 32, 64, 128, 256, 512, 1024
"""Of splines that are tried, one after the other: of a short curve with many of them tangents show
the round-off of its points."""

BEYOND = 0.01
"""Share of the parameter's range by which a spline goes on at either end."""

CLOSE, TURNED = 1e-10, 0.25 * MISMATCH
"""Distance of a spline over the length of its curve, and angle between the tangents (rad), at the
ends and in the middles of its intervals, at most: so that pieces still join."""


def _spline(t: Floats, points: Floats, angle: float) -> Callable[[Floats], CurvePoints]:
    """Spline through points (n, 2) mm at the parameters t (n,), for `CurvedSegment`.

    angle : rad, of its middle tangent
    """
    pieces = by_pieces(scipy.interpolate.make_interp_spline(t, points, DEGREE))
    kinds = [pieces, pieces.derivative(1), pieces.derivative(2)]
    # derivatives have fewer coefficients
    c = [np.pad(one.c, ((k, 0), (0, 0), (0, 0))) for k, one in enumerate(kinds)]
    every = scipy.interpolate.PPoly(np.concatenate(c, axis=2), pieces.x)
    back = np.exp(-1j * angle)

    def evaluate(t: Floats) -> CurvePoints:
        z, first, second = np.ascontiguousarray(every(t)).view(np.complex128).T
        curve = points_of(z, back * first, back * second)
        # counted from the middle tangent, the angle does not jump by a turn
        return replace(curve, angle=curve.angle + angle)

    return evaluate


def fitted(curve: CurvedSegment) -> CurvedSegment:
    """The curve as a spline through some of its points; itself where a spline is not
    `CLOSE`, as beside a cusp."""
    angle, before = float(curve.evaluate(np.array([0.5])).angle[0]), np.inf
    for count in INTERVALS:
        t = np.linspace(-BEYOND, 1.0 + BEYOND, count + 1)
        points = curve.evaluate(t).point
        if not np.isfinite(points).all():
            return curve
        known = CurvedSegment(curve.name, _spline(t, points, angle))
        between = np.array([0.0, *(t[:-1] + 0.5 * (t[1] - t[0])), 1.0])
        exact, found = (of.evaluate(between) for of in (curve, known))
        length = float(exact.speed.mean())
        distance = np.linalg.norm(found.point - exact.point, axis=1).max()
        turned = np.abs(found.angle - exact.angle).max()
        if distance < CLOSE * length and turned < TURNED:
            return known
        if turned > before:  # round-off, which grows with their number
            return curve
        before = turned
    return curve
