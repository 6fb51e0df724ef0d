"""Flanks from points: cubic splines by arc length through them, smooth but at corners.

The points are divided at corners, and at joints: given ones, or where the curvature jumps. Each
part has a spline of its own. At a joint both have the mean of the tangents that they have alone,
so that the flank is smooth there and its curvature may jump, as between arcs. Corners remain. A
mesh has nodes at joints: an element across a jump of the curvature has wrong pressures.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
import scipy
from numpy.typing import NDArray

from swgpar.errors import InputError
from swgpar.geometry.arrays import Complex, Floats, as_points
from swgpar.input.quantities import show
from swgpar.profiles.curved_segment import CurvedSegment, CurvePoints, points_of
from swgpar.profiles.flank import ToothProfile
from swgpar.profiles.flank_points import flank_points, place
from swgpar.profiles.keys import Points
from swgpar.profiles.teeth import Teeth

ROUNDS = 3
"""Fits, each over the arc lengths of the one before."""

SAMPLES = 513
"""Places of a spline at which its curvature is looked at."""

TURNS = 6
"""Changes between bent one way and the other along a part, at most: more are scatter."""

STRAIGHT = 0.05
"""Curvature times the module up to which a flank counts as straight."""

ROOT_CURVATURE = 1.0
"""Curvature times the module from which a concave end of the flank is its root."""

WHOLE = 0.04
"""Share of a part, at its upper end, that may be less bent where all of it is the root."""

LEAST_JUMP, UNUSUAL = 0.2, 4.0
"""Jump of the curvature times the module that is a joint, and over its change beside it."""

LINE = 3.0
"""Length of a chord that is a straight line, over that of the longer one beside it."""

KINK = np.radians(4.0)
"""Angle between both parts at a joint from which it is a corner."""

NEAR_POINTS, FAR_POINTS = 2, 5
"""Points on both sides between which the curvature jumps, and beyond which it is compared."""

TANGENT = np.radians(10.0)
"""Angle to the addendum or dedendum circle up to which the flank is made tangent to it."""

SAME = 1e-6
"""Angle (rad) between the parts at a joint that is none."""


@dataclass(frozen=True)
class FittedFlank:
    """A flank from points.

    deviation : mm, largest distance of a point from the flank
    between : mm, estimated largest error of the curve between the points: a third of what the
        points that are left out are off a curve through every second one. The error falls with
        the square of their distance where the curvature jumps, faster elsewhere
    corners : (n,) mm, radii of the corners
    """

    profile: ToothProfile
    deviation: float
    between: float
    corners: tuple[float, ...]


@dataclass(frozen=True)
class _Piece:
    """The part of a spline over arc lengths (points x + i y, mm) between `begin` and `end`, mm."""

    spline: scipy.interpolate.CubicSpline
    begin: float
    end: float

    def evaluate(self, t: Floats) -> CurvePoints:
        """Curve at the parameters t (n,), for `CurvedSegment`."""
        span = self.end - self.begin
        u = self.begin + span * t
        return points_of(self.spline(u), span * self.spline(u, 1), span**2 * self.spline(u, 2))

    def tangent(self, u: float) -> complex:
        """Unit tangent at the arc length u, mm."""
        along = complex(self.spline(u, 1))
        return along / abs(along)

    def cut(self, at: float) -> tuple[_Piece, _Piece]:
        """The parts before and behind an arc length, mm."""
        return _Piece(self.spline, self.begin, at), _Piece(self.spline, at, self.end)


def _fit(points: Complex, first: complex | None = None, last: complex | None = None) -> _Piece:
    """Spline by arc length through points x + i y (n,), with given unit tangents at its ends."""
    gauss, weight = np.polynomial.legendre.leggauss(4)
    lengths = np.abs(np.diff(points))
    free = "not-a-knot" if len(points) > 3 else "natural"
    ends = tuple(free if tangent is None else (1, tangent) for tangent in (first, last))
    for _ in range(ROUNDS):
        u = np.append(0.0, np.cumsum(lengths))
        spline = scipy.interpolate.CubicSpline(u, points, bc_type=ends)
        at = u[:-1, None] + 0.5 * np.diff(u)[:, None] * (1.0 + gauss)
        lengths = 0.5 * np.diff(u) * (np.abs(spline(at, 1)) @ weight)
    return _Piece(spline, 0.0, float(u[-1]))


def _smoothed(points: Complex, tolerance: float) -> Complex:
    """Points of a smoothing spline with this mean distance from points x + i y (n,); the ends
    stay."""
    if tolerance == 0.0 or len(points) < 6:
        return points
    weight = np.ones(len(points))
    weight[[0, -1]] = 1e3
    scatter = tolerance**2 * len(points)
    spline, _ = scipy.interpolate.splprep(
        [points.real, points.imag], w=weight, s=scatter, k=5, quiet=1
    )
    x, y = scipy.interpolate.splev(np.linspace(0.0, 1.0, min(len(points), 129)), spline)
    smooth: Complex = np.asarray(x) + 1j * np.asarray(y)
    smooth[[0, -1]] = points[[0, -1]]
    return smooth


def _jumps(points: Complex, corners: NDArray[np.intp], module: float) -> list[int]:
    """Points at which the curvature jumps, away from corners: by the circles through three points
    each."""
    before, after = points[1:-1] - points[:-2], points[2:] - points[1:-1]
    area = (np.conj(before) * after).imag
    curvature = np.zeros(len(points))
    curvature[1:-1] = 2.0 * area / np.abs(before * after * (before + after))
    curvature[[0, -1]] = curvature[[1, -2]]
    far, near = FAR_POINTS, NEAR_POINTS
    k = np.arange(far + 1, len(points) - far - 1)
    jump = np.abs(curvature[k + near] - curvature[k - near])
    usual = np.maximum(
        np.abs(curvature[k + far] - curvature[k + near]),
        np.abs(curvature[k - near] - curvature[k - far]),
    )
    found = (jump * module > LEAST_JUMP) & (jump > UNUSUAL * usual)
    for corner in corners:
        found &= np.abs(k - corner) > far
    jump = np.where(found, jump, 0.0)
    jumps: list[int] = []
    while jump.any():
        at = int(k[jump.argmax()])
        jumps.append(at)
        jump[np.abs(k - at) <= far] = 0.0
    return jumps


def _ends_of_lines(points: Complex) -> list[int]:
    """Ends of chords that are much longer than those beside them: they are straight lines."""
    length = np.abs(np.diff(points))
    beside = np.maximum(np.append(0.0, length[:-1]), np.append(length[1:], 0.0))
    long = np.flatnonzero(length > LINE * beside)
    return [*long.tolist(), *(long + 1).tolist()]


def _divisions(
    points: Complex, keys: Points, teeth: Teeth, name: str
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Points at which the flank is divided, and those of them that are corners."""
    turn = np.abs(np.angle(np.diff(points)[1:] / np.diff(points)[:-1]))
    corners = np.flatnonzero(turn >= np.radians(keys.corner)) + 1
    radius, joints = np.abs(points), []
    for joint in keys.joints:
        low, high = sorted((radius[0], radius[-1]))
        if not low < joint < high:
            raise InputError(
                f"{name}.joints has {show(joint)} mm: allowed above {low:.6g} to below "
                f"{high:.6g} mm, the radii of the flank"
            )
        joints.append(int(np.abs(radius - joint).argmin()))
    if not keys.joints:
        joints = _ends_of_lines(points)
        if keys.tolerance == 0.0:
            joints += _jumps(points, corners, teeth.module)
    inner = [k for k in {*corners.tolist(), *joints} if 0 < k < len(points) - 1]
    return np.array(sorted(inner), dtype=np.intp), corners


@lru_cache(maxsize=32)
def fitted_flank(keys: Points, teeth: Teeth, name: str = "profile") -> FittedFlank:
    """Build the flank of points, with the heights of `teeth`.

    name : section of the design file, for messages. Raises InputError where the points give no
    flank, with the place.
    """
    points = flank_points(keys, teeth.n_teeth, teeth.external, teeth.module, name)
    at, corners = _divisions(points, keys, teeth, name)
    parts = [
        points[begin : end + 1] for begin, end in zip([0, *at], [*at, len(points) - 1], strict=True)
    ]
    sharp = [k in corners for k in at]
    pieces = _pieces([_smoothed(part, keys.tolerance) for part in parts], sharp)
    _check_scatter(pieces, teeth, name)
    deviation = max(_farthest(piece, part) for piece, part in zip(pieces, parts, strict=True))
    between = max(_farthest(_fit(part[_every_second(len(part))]), part) / 3.0 for part in parts)
    if not keys.joints:
        pieces[-1:] = _with_root(pieces[-1], teeth, name)
    names = ["flank"] * (len(pieces) - 1) + ["root"]
    if keys.rounded_tip and len(pieces) > 1:
        names[0] = "tip"
    segments = tuple(
        CurvedSegment(noun, piece.evaluate) for noun, piece in zip(names, pieces, strict=True)
    )
    tip, root = float(abs(points[0])), float(abs(pieces[-1].spline(pieces[-1].end)))
    profile = ToothProfile(segments, teeth.external, tip, root, teeth.n_teeth)
    ends = [(one.tangent(one.end), two.tangent(two.begin)) for one, two in pairwise(pieces)]
    kinks = [abs(np.angle(two / one)) > SAME for one, two in ends]
    radii = np.abs([piece.spline(piece.end) for piece in pieces[:-1]])
    return FittedFlank(profile, deviation, between, tuple(radii[kinks].tolist()))


def _every_second(count: int) -> NDArray[np.intp]:
    """Indices of every second of so many points, with the last one."""
    return np.unique(np.append(np.arange(0, count, 2), count - 1))


def _pieces(parts: list[Complex], sharp: list[bool]) -> list[_Piece]:
    """Splines of the parts with a common tangent where they meet, but at corners."""
    alone = [_fit(part) for part in parts]
    first: list[complex | None] = [None] * len(parts)
    last: list[complex | None] = [None] * len(parts)
    for k, is_corner in enumerate(sharp):
        if is_corner:
            continue
        tangents = alone[k].tangent(alone[k].end), alone[k + 1].tangent(0.0)
        if abs(np.angle(tangents[1] / tangents[0])) > KINK:
            continue
        # a straight line keeps its direction
        straight = [len(part) == 2 for part in parts[k : k + 2]]
        mean = sum(tangents) if straight[0] == straight[1] else tangents[straight.index(True)]
        last[k] = first[k + 1] = complex(mean / abs(mean))
    first[0] = _along_circle(parts[0][0], alone[0].tangent(0.0))
    last[-1] = _along_circle(parts[-1][-1], alone[-1].tangent(alone[-1].end))
    return [_fit(*each) for each in zip(parts, first, last, strict=True)]


def _along_circle(point: complex, tangent: complex) -> complex | None:
    """Unit tangent of the circle about the axis through a point, where a flank is nearly tangent to
    it; else None."""
    circle = 1j * point / abs(point)
    circle *= np.sign((np.conj(circle) * tangent).real)
    return complex(circle) if abs(np.angle(tangent / circle)) < TANGENT else None


def _bends(piece: _Piece, teeth: Teeth) -> tuple[Floats, Floats]:
    """Arc lengths (n,) mm of a part, and curvatures (n,) there over 1 / module; above 0 where
    concave."""
    t = np.linspace(0.0, 1.0, SAMPLES)
    curve = piece.evaluate(t)
    span = piece.end - piece.begin
    return piece.begin + span * t, teeth.sign * curve.angle_rate / curve.speed * teeth.module


def _check_scatter(pieces: list[_Piece], teeth: Teeth, name: str) -> None:
    """Refuse a curve that winds from point to point."""
    for piece in pieces:
        u, bends = _bends(piece, teeth)
        side = np.sign(np.where(np.abs(bends) > STRAIGHT, bends, 0.0))
        at = np.flatnonzero(side)
        changes = at[1:][np.diff(side[at]) != 0.0]
        if len(changes) > TURNS:
            raise InputError(
                f"{name}.points scatter: the curve through them winds {len(changes)} times, first "
                f"at {place(piece.spline(u[changes[0]]))}: allowed are smoother points or a larger "
                f"{name}.tolerance, the mean distance of the points from a smooth curve"
            )


def _with_root(piece: _Piece, teeth: Teeth, name: str) -> list[_Piece]:
    """The last part, cut where its root begins; it is the root where all of it is one."""
    u, bends = _bends(piece, teeth)
    sharp = bends >= ROOT_CURVATURE
    if not sharp[-SAMPLES // 8 :].any():
        raise InputError(
            f"{name}.points have no fillet at the root, {place(piece.spline(piece.end))}: allowed "
            f"is a concave end with a radius below {teeth.module / ROOT_CURVATURE:g} mm, or "
            f"{name}.joints with the radius from the axis at which the root begins"
        )
    # from the end: up to where the curve is no longer bent so much
    last = int(np.flatnonzero(sharp)[-1])
    before = np.flatnonzero(~sharp[:last])
    if not len(before) or before[-1] < WHOLE * SAMPLES:
        return [piece]
    return list(piece.cut(float(u[before[-1] + 1])))


def _farthest(piece: _Piece, points: Complex) -> float:
    """Largest distance of points x + i y (n,) from a part, mm."""
    segment = CurvedSegment("flank", piece.evaluate)
    xy = as_points(points)
    return float(np.linalg.norm(segment.nearest(xy).point - xy, axis=1).max())
