"""A curve that costs much to evaluate, such as an envelope, replaced by a spline."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
import scipy

from swgpar.geometry.arrays import Floats, as_complex
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


@dataclass(frozen=True)
class _Splines:
    """Splines through points at the same places t (n,), whose values are products with the points.

    between : (m,) middles of the intervals, and the ends of the curve
    unit : splines (n,) of which each is 1 at one of the places and 0 at the others
    """

    t: Floats
    between: Floats
    unit: scipy.interpolate.BSpline

    @cached_property
    def values(self) -> tuple[Floats, Floats]:
        """Of the splines `unit`, and of their slopes, (m, n), at the places `between`."""
        return self.unit(self.between), self.unit(self.between, nu=1)

    @cached_property
    def _pieces(self) -> tuple[Floats, Floats]:
        """Coefficients (DEGREE + 1, p, n) of the polynomials of `unit`, and their p + 1 ends."""
        pieces = by_pieces(self.unit)
        return pieces.c, pieces.x

    def through(self, points: Floats) -> scipy.interpolate.PPoly:
        """The spline through points (n, 2), its first and its second derivative, in six columns."""
        coefficients, ends = self._pieces
        # near their middle there is less round-off
        middle = points[len(points) // 2]
        c = coefficients @ (points - middle)
        c[-1] += middle
        power = np.arange(DEGREE, -1, -1.0)[:, None, None]
        first, second = np.zeros_like(c), np.zeros_like(c)
        first[1:] = (power * c)[:-1]
        second[1:] = (power * first)[:-1]
        return scipy.interpolate.PPoly.construct_fast(
            np.concatenate([c, first, second], axis=2), ends
        )


@cache
def _splines(intervals: int) -> _Splines:
    """Splines of a number of intervals; kept, because every curve needs them."""
    t = np.linspace(-BEYOND, 1.0 + BEYOND, intervals + 1)
    between = np.concatenate([0.5 * (t[:-1] + t[1:]), [0.0, 1.0]])
    unit = scipy.interpolate.make_interp_spline(t, np.eye(intervals + 1), DEGREE)
    return _Splines(t, between, unit)


def _evaluated(spline: scipy.interpolate.PPoly, angle: float) -> Callable[[Floats], CurvePoints]:
    """What `CurvedSegment` evaluates of a spline of points (n, 2) mm and its derivatives.

    angle : rad, of a middle tangent
    """
    back = np.exp(-1j * angle)

    def evaluate(t: Floats) -> CurvePoints:
        z, first, second = spline(t).view(np.complex128).T
        curve = points_of(z, back * first, back * second)
        # counted from the middle tangent, the angle does not jump by a turn
        return CurvePoints(curve.point, curve.angle + angle, curve.speed, curve.angle_rate)

    return evaluate


def fitted(curve: CurvedSegment) -> CurvedSegment:
    """The curve as a spline through some of its points; itself where a spline is not
    `CLOSE`, as beside a cusp."""
    intervals, before = INTERVALS[0], np.inf
    known = curve.evaluate(_splines(intervals).t)
    points, angle = known.point, float(known.angle[intervals // 2])
    while np.isfinite(points).all():
        splines = _splines(intervals)
        exact = curve.evaluate(splines.between)
        value, slope = splines.values
        middle = points[intervals // 2]
        tangent = np.exp(-1j * exact.angle) * as_complex(slope @ (points - middle))
        distance = np.linalg.norm(value @ (points - middle) + middle - exact.point, axis=1).max()
        turned = np.abs(np.angle(tangent)).max()
        if distance < CLOSE * float(exact.speed.mean()) and turned < TURNED:
            return CurvedSegment(curve.name, _evaluated(splines.through(points), angle))
        # beyond that there is round-off alone, which grows with the number of points
        if turned > before or intervals >= INTERVALS[1]:
            break
        before = turned
        # the middles are the further points of the next spline
        both = np.empty((2 * intervals + 1, 2))
        both[::2], both[1::2] = points, exact.point[:-2]
        points = both
        intervals *= 2
    return curve
