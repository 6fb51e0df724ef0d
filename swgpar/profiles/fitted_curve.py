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

INTERVALS = 16, 1024
"""Of the first and the last spline that is tried; each one has twice those of the one before. Of a
short curve with many of them tangents show the round-off of its points."""

BEYOND = 0.01
"""Share of the parameter's range by which a spline goes on at either end."""

CLOSE, TURNED = 1e-10, 0.25 * MISMATCH
"""Distance of a spline over the length of its curve, and angle between the tangents (rad), at the
ends and in the middles of its intervals, at most: so that pieces still join."""


def _evaluated(spline: scipy.interpolate.BSpline, angle: float) -> Callable[[Floats], CurvePoints]:
    """What `CurvedSegment` evaluates of a spline of points (n, 2) mm.

    angle : rad, of a middle tangent
    """
    pieces = by_pieces(spline)
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
    t, before = np.linspace(-BEYOND, 1.0 + BEYOND, INTERVALS[0] + 1), np.inf
    known = curve.evaluate(t)
    points, angle = known.point, float(known.angle[len(t) // 2])
    while np.isfinite(points).all():
        spline = scipy.interpolate.make_interp_spline(t, points, DEGREE)
        between = np.concatenate([0.5 * (t[:-1] + t[1:]), [0.0, 1.0]])
        exact = curve.evaluate(between)
        tangent = np.exp(-1j * exact.angle) * (spline(between, nu=1) @ (1.0, 1j))
        distance = np.linalg.norm(spline(between) - exact.point, axis=1).max()
        turned = np.abs(np.angle(tangent)).max()
        if distance < CLOSE * float(exact.speed.mean()) and turned < TURNED:
            return CurvedSegment(curve.name, _evaluated(spline, angle))
        # beyond that there is round-off alone, which grows with the number of points
        if turned > before or len(t) > INTERVALS[1]:
            break
        before = turned
        # the middles are the further points of the next spline
        order = np.argsort(np.concatenate([t, between[:-2]]), kind="stable")
        t = np.concatenate([t, between[:-2]])[order]
        points = np.concatenate([points, exact.point[:-2]])[order]
    return curve
