"""A flank segment given by exact functions of a parameter, made to run by arc length."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import scipy

from swgpar.geometry.arrays import Complex, Floats, as_points
from swgpar.geometry.rotation import rotated
from swgpar.profiles.flank import FlankPoints, NearestPoints

PANELS, ORDER = 64, 6
"""Panels of the arc length's table and Gauss points in each: round-off on a tooth's curves."""

GAUSS = np.polynomial.legendre.leggauss(ORDER)

INVERSES = PANELS, 4 * PANELS
"""Pieces of the inverse of an arc length that are tried, one after the other."""

DEGREE = 7
"""Of the splines that replace an inverse or a costly curve."""

SMALL = 1e-11
"""Error of an arc length over the curve's, from which on its inverse is iterated; it moves a point
along the curve."""


@dataclass(frozen=True)
class CurvePoints:
    """A curve at parameters t (n,).

    point : (n, 2) mm;  angle : (n,) rad, of tangents;  speed : |dx/dt|, mm;  angle_rate : rad
    """

    point: Floats
    angle: Floats
    speed: Floats
    angle_rate: Floats


def points_of(z: Complex, first: Complex, second: Complex) -> CurvePoints:
    """Points of a curve x + i y : (n,) mm with its first and second derivatives by t."""
    speed = np.abs(first)
    return CurvePoints(
        as_points(z),
        np.angle(first),
        speed,
        (np.conj(first) * second).imag / speed**2,
    )


def by_pieces(spline: scipy.interpolate.BSpline) -> scipy.interpolate.PPoly:
    """The same polynomials, which take a third of the time to evaluate."""
    x = np.unique(spline.t)
    powers = range(spline.k, -1, -1)
    return scipy.interpolate.PPoly([spline(x[:-1], nu=k) / math.factorial(k) for k in powers], x)


@dataclass(frozen=True)
class _Cut:
    """What a segment is cut from: the curve, the arc length (mm) and the parameter at which the
    segment begins, its length (mm) and its share of the parameter's range."""

    curve: CurvedSegment
    first: float
    begin: float
    length: float
    share: float


@dataclass(frozen=True)
class CurvedSegment:
    """A smooth segment x(t), 0 <= t <= 1, run through from the tip towards the root.

    name : str
    evaluate : `CurvePoints` at parameters (n,), exact, a little beyond 0 and 1 too; speed above 0
    cut : from a curve whose arc lengths it has, None for a curve of its own
    """

    name: str
    evaluate: Callable[[Floats], CurvePoints]
    cut: _Cut | None = field(default=None, compare=False)

    def part(self, first: float, last: float) -> CurvedSegment:
        """The part between two local arc lengths, mm."""
        begin, end = self.parameter(np.array([first, last])).tolist()
        share = end - begin

        def evaluate(t: Floats) -> CurvePoints:
            curve = self.evaluate(begin + share * t)
            return replace(curve, speed=share * curve.speed, angle_rate=share * curve.angle_rate)

        return CurvedSegment(self.name, evaluate, _Cut(self, first, begin, last - first, share))

    def turned(self, angle: float) -> CurvedSegment:
        """The curve turned about the axis by `angle`, rad."""

        def evaluate(t: Floats) -> CurvePoints:
            curve = self.evaluate(t)
            return replace(curve, point=rotated(curve.point, angle), angle=curve.angle + angle)

        return CurvedSegment(self.name, evaluate)

    @cached_property
    def _table(self) -> tuple[Floats, Floats]:
        """Gauss points and weights on (0, 1), arc lengths (PANELS + 1,) mm at ends of panels."""
        point, weight = 0.5 * (GAUSS[0] + 1.0), 0.5 * GAUSS[1]
        start = np.arange(PANELS)[:, None] / PANELS
        speed = self.evaluate((start + point / PANELS).ravel()).speed.reshape(PANELS, -1)
        lengths = np.concatenate(([0.0], np.cumsum(speed @ weight / PANELS)))
        return np.stack((point, weight)), lengths

    @property
    def length(self) -> float:
        """Arc length, mm."""
        return self.cut.length if self.cut is not None else float(self._table[1][-1])

    def arc_length(self, t: Floats) -> Floats:
        """Return the arc lengths (n,), mm, at the parameters `t` : (n,)."""
        if (cut := self.cut) is not None:
            return cut.curve.arc_length(cut.begin + cut.share * t) - cut.first
        (point, weight), ends = self._table
        panel = np.clip((t * PANELS).astype(int), 0, PANELS - 1)
        part = t - panel / PANELS
        speed = self.evaluate((panel[:, None] / PANELS + part[:, None] * point).ravel()).speed
        return ends[panel] + part * (speed.reshape(len(t), -1) @ weight)

    @cached_property
    def _inverse(self) -> tuple[scipy.interpolate.PPoly, bool]:
        """Parameters by arc lengths (mm), and whether they need no iteration."""
        for panels in INVERSES:
            t = np.linspace(0.0, 1.0, panels + 1)
            ends = self._table[1] if panels == PANELS else self.arc_length(t)
            inverse = by_pieces(scipy.interpolate.make_interp_spline(ends, t, DEGREE))
            between = 0.5 * (ends[:-1] + ends[1:])
            error = np.abs(self.arc_length(inverse(between)) - between).max()
            if exact := bool(error < SMALL * self.length):
                break
        return inverse, exact

    def parameter(self, s: Floats) -> Floats:
        """Parameters (n,) at the arc lengths `s` : (n,) mm, by Newton's method where the table is
        not exact."""
        s = np.asarray(s, dtype=np.float64)
        if (cut := self.cut) is not None:
            return (cut.curve.parameter(cut.first + s) - cut.begin) / cut.share
        inverse, exact = self._inverse
        t: Floats = inverse(s)
        for _ in range(0 if exact else 6):
            step = (self.arc_length(t) - s) / self.evaluate(t).speed
            t = t - step
            if np.max(np.abs(step), initial=0.0) < 1e-8:  # the next step would be its square
                break
        return t

    def at(self, s: Floats) -> FlankPoints:
        """Return points, angles and curvatures at the local arc lengths `s` : (n,) mm."""
        curve = self.evaluate(self.parameter(s))
        return FlankPoints(curve.point, curve.angle, curve.angle_rate / curve.speed)

    @cached_property
    def _samples(self) -> scipy.spatial.cKDTree:
        return scipy.spatial.cKDTree(self.evaluate(np.linspace(0.0, 1.0, 257)).point)

    def nearest(self, points: Floats) -> NearestPoints:
        """The nearest points to `points` (n, 2), mm; their places are parameters."""
        t = self._samples.query(points)[1] / 256.0
        moving = np.arange(len(points))  # points whose iteration goes on
        for _ in range(20):
            curve = self.evaluate(t[moving])
            c, s = np.cos(curve.angle), np.sin(curve.angle)
            x, y = (curve.point - points[moving]).T
            # half the slope of the squared distance and its derivative, over the speed
            value = x * c + y * s
            slope = curve.speed - curve.angle_rate * (x * s - y * c)
            step = value / np.where(slope > 0.1 * curve.speed, slope, curve.speed)
            new = np.clip(t[moving] - step, 0.0, 1.0)
            # coordinates of 100 mm leave 1e-13, and the next step would be the square
            still = np.abs(new - t[moving]) > 1e-12
            t[moving] = new
            moving = moving[still]
            if not moving.size:
                break
        curve = self.evaluate(t)
        return NearestPoints(t, curve.point, curve.angle)
