"""A tooth flank as a chain of smoothly joined segments, by arc length."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swgpar.errors import InputError
from swgpar.geometry.arrays import Floats
from swgpar.geometry.bracketed_root import root_between
from swgpar.geometry.rotation import rotated

MISMATCH = 1e-9
"""Of points, over the tip radius, and of tangents (rad) where segments join."""

OF_POINTS = 1e-3
"""rad, of tangents of a flank from points with few digits."""


@dataclass(frozen=True)
class NearestPoints:
    """Points of a segment nearest to given ones.

    place : (n,) where they are, for `FlankSegment.arc_length`
    point : (n, 2) mm;  angle : (n,) rad, of the tangents there
    """

    place: Floats
    point: Floats
    angle: Floats


class FlankPoints(NamedTuple):
    """Points of a segment.

    point : (n, 2) mm;  angle : (n,) rad, of the tangents from +x, counter-clockwise
    curvature : (n,) 1/mm, change of that angle per arc length
    """

    point: Floats
    angle: Floats
    curvature: Floats


class FlankSegment(Protocol):
    """A smooth piece of a flank, from the tip towards the root; local arc lengths s in mm."""

    @property
    def name(self) -> str:
        """Name of the piece."""

    @property
    def length(self) -> float:
        """Arc length, mm."""

    def at(self, s: Floats) -> FlankPoints:
        """Points, angles and curvatures at `s` : (n,)."""

    def nearest(self, points: Floats) -> NearestPoints:
        """The nearest points to `points` (n, 2), mm."""

    def arc_length(self, place: Floats) -> Floats:
        """Local arc lengths (n,), mm, of the places (n,) of nearest points."""

    def part(self, first: float, last: float) -> FlankSegment:
        """The part between two arc lengths."""

    def turned(self, angle: float) -> FlankSegment:
        """The segment turned about the axis by `angle`, rad."""


@dataclass(frozen=True)
class Segment:
    """A piece of constant curvature of a flank, run through from the tip towards the root.

    name : name of the segment, for example ``tip`` or ``straight``
    start : mm, first point (x, y)
    direction : rad, angle of the unit tangent at `start` from +x, counter-clockwise
    curvature : 1/mm, change of that angle per arc length; 0 for a line;  length : mm, arc length
    """

    name: str
    start: tuple[float, float]
    direction: float
    curvature: float
    length: float

    def at(self, s: Floats) -> FlankPoints:
        """Return points, angles and curvatures at the local arc lengths `s` : (n,) mm."""
        half = 0.5 * self.curvature * s
        # chord of an arc: exact for any curvature, the straight line included
        chord = s * np.sinc(half / np.pi)
        middle = self.direction + half
        x, y = self.start
        points = np.stack((x + chord * np.cos(middle), y + chord * np.sin(middle)), axis=-1)
        return FlankPoints(
            points, self.direction + self.curvature * s, np.full_like(s, self.curvature)
        )

    def part(self, first: float, last: float) -> Segment:
        """The part between two local arc lengths, mm."""
        begin = self.at(np.array([first]))
        x, y = begin.point[0].tolist()
        return replace(self, start=(x, y), direction=float(begin.angle[0]), length=last - first)

    def turned(self, angle: float) -> Segment:
        """The segment turned about the axis by `angle`, rad."""
        x, y = rotated(np.array(self.start), angle).tolist()
        return replace(self, start=(x, y), direction=self.direction + angle)

    def nearest(self, points: Floats) -> NearestPoints:
        """The nearest points to `points` (n, 2), mm; their places are local arc lengths."""
        s = self._nearest(points)
        foot = self.at(s)
        return NearestPoints(s, foot.point, foot.angle)

    def arc_length(self, place: Floats) -> Floats:
        """Local arc lengths (n,), mm, of the places (n,) of nearest points: these."""
        return place

    def _nearest(self, points: Floats) -> Floats:
        offset = points - np.asarray(self.start)
        tangent = np.array((np.cos(self.direction), np.sin(self.direction)))
        along = offset @ tangent
        across = offset @ np.array((-tangent[1], tangent[0]))
        if self.curvature == 0.0:
            return np.clip(along, 0.0, self.length)
        # polar angle about the centre of the arc, measured from the middle of the arc so that the
        # cut lies opposite
        radius = 1.0 / self.curvature
        angle = np.arctan2(along * np.sign(radius), (radius - across) * np.sign(radius))
        middle = 0.5 * self.curvature * self.length
        angle = middle + np.remainder(angle - middle + np.pi, 2.0 * np.pi) - np.pi
        return np.clip(angle * radius, 0.0, self.length)


@dataclass(frozen=True)
class ToothProfile:
    """One flank, on the side x > 0, of a tooth centred on +y, from its tip end T to its root end R.

    segments : the chain, from T to R; segments of no length are left out.
        The last one is the root: its fillet, which is tangent to the dedendum circle. The flank
        that works ends where it begins. A first segment with the name ``tip`` is a rounded tip
        edge; others have other names.
    external : True for teeth that point outwards (flexible spline), False for internal ones (ring
        gear)
    r_tip_circle, r_root_circle : mm, addendum and dedendum radii;  n_teeth : number of teeth
    """

    segments: tuple[FlankSegment, ...]
    external: bool
    r_tip_circle: float
    r_root_circle: float
    n_teeth: int

    def __post_init__(self) -> None:
        names = [segment.name for segment in self.segments]
        if "tip" in names[1:] or "root" in names[:-1]:
            raise ValueError(
                f"the segments of a flank are {', '.join(names)}: allowed is the name tip for the "
                f"first one only, and root for the last one only"
            )

    @cached_property
    def breaks(self) -> Floats:
        """Arc lengths of all segment ends, 0 and the total length included: (k,) mm."""
        return np.concatenate(([0.0], np.cumsum([segment.length for segment in self.segments])))

    @property
    def length(self) -> float:
        """Arc length from T to R, mm."""
        return float(self.breaks[-1])

    @property
    def root_start(self) -> float:
        """Arc length at which the root begins, mm; 0 for a flank of one segment."""
        return float(self.breaks[-2])

    @property
    def tip_end(self) -> float:
        """Arc length at which the rounded tip edge ends, mm; 0 for a sharp edge."""
        return float(self.breaks[1]) if self.segments[0].name == "tip" else 0.0

    @property
    def sign(self) -> float:
        """+1 for external, -1 for internal teeth: the outward normal is the tangent rotated by +90
        degrees on external teeth, by -90 degrees on internal ones."""
        return 1.0 if self.external else -1.0

    @cached_property
    def ends(self) -> list[FlankPoints]:
        """Beginning and end of every segment."""
        return [segment.at(np.array([0.0, segment.length])) for segment in self.segments]

    @property
    def kinks(self) -> Floats:
        """Angles (k - 2,), rad, by which tangents turn counter-clockwise where segments meet."""
        begin, end = np.array([each.angle for each in self.ends]).T
        return np.angle(np.exp(1j * (begin[1:] - end[:-1])))

    @property
    def has_corners(self) -> bool:
        """Whether segments join with an angle, as pieces of a swept area and parts of points do."""
        return bool(np.any(np.abs(self.kinks) > MISMATCH))

    def thinned(self, c_P: float) -> ToothProfile:
        """The flank of a tooth that is thinner by (1 - c_P) of half a pitch (eq. 3.22): turned
        about the axis, towards the centre line of its tooth."""
        if c_P == 1.0:
            return self
        angle = 0.5 * (1.0 - c_P) * np.pi / self.n_teeth
        return replace(self, segments=tuple(one.turned(angle) for one in self.segments))

    def _split(self, s: ArrayLike) -> tuple[Floats, NDArray[np.intp], Floats]:
        s = np.atleast_1d(np.asarray(s, dtype=np.float64))
        index = np.clip(
            np.searchsorted(self.breaks, s, side="right") - 1, 0, len(self.segments) - 1
        )
        return s, index, s - self.breaks[index]

    def at(self, s: ArrayLike) -> FlankPoints:
        """Return points, angles and curvatures at the arc lengths `s` : (n,) mm, in less time than
        each of them alone; curvatures are changes of the angle."""
        s, index, local = self._split(s)
        every = np.flatnonzero(np.bincount(index))
        if len(every) == 1:
            return self.segments[every[0]].at(local)
        found = FlankPoints(np.empty((s.size, 2)), np.empty(s.size), np.empty(s.size))
        for k in every:
            inside = index == k
            for values, each in zip(found, self.segments[k].at(local[inside]), strict=True):
                values[inside] = each
        return found

    def point(self, s: ArrayLike) -> Floats:
        """Return the points at the arc lengths `s` : (n,) mm, as (n, 2) mm."""
        return self.at(s).point

    def tangent(self, s: ArrayLike) -> Floats:
        """Return the unit tangents (n, 2), from T towards R, at the arc lengths `s` : (n,) mm."""
        direction = self.at(s).angle
        return np.stack((np.cos(direction), np.sin(direction)), axis=-1)

    def normal(self, s: ArrayLike) -> Floats:
        """Return the unit normals (n, 2), out of the material, at the arc lengths `s` : (n,) mm."""
        return self.normals(self.at(s).angle)

    def normals(self, angle: Floats) -> Floats:
        """Return the unit normals (n, 2), out of the material, where tangents have the angles
        (n,) rad."""
        return self.sign * np.stack((-np.sin(angle), np.cos(angle)), axis=-1)

    def curvature(self, s: ArrayLike) -> Floats:
        """Curvature (n,), 1/mm: d tangent / d s = curvature * normal; negative where convex."""
        return self.sign * self.at(s).curvature

    def crowning_weight(self, s: ArrayLike) -> Floats:
        """Return the share (n,) of the crowning that is applied at the arc lengths `s` : (n,) mm.

        One on the active profile; it falls to zero along the root towards R, with continuous slope,
        so that the root circle stays where it is, and along a rounded tip edge towards T. A sharp
        edge is crowned in full.
        """
        s, index, local = self._split(s)
        weight = np.ones_like(s)
        last = len(self.segments) - 1
        for k, segment in enumerate(self.segments):
            if k == last or segment.name == "tip":
                inside = index == k
                x = np.clip(local[inside] / segment.length, 0.0, 1.0)
                x = 1.0 - x if k == last else x
                weight[inside] = x * x * (3.0 - 2.0 * x)
        return weight

    def distance(self, points: ArrayLike) -> tuple[Floats, Floats]:
        """Return the signed distance to the flank and the arc length of the nearest point.

        points : (n, 2) mm

        Returns the distance (n,) mm, positive outside the material, and s (n,) mm.
        """
        points = np.atleast_2d(np.asarray(points, dtype=np.float64))
        found = [segment.nearest(points) for segment in self.segments]
        offsets = np.array([points - feet.point for feet in found])
        gaps = np.linalg.norm(offsets, axis=2)
        nearest = gaps.argmin(axis=0)
        foot, angle = np.empty(len(points)), np.empty(len(points))
        for k, (begin, segment) in enumerate(zip(self.breaks[:-1], self.segments, strict=True)):
            here = nearest == k
            if here.any():
                foot[here] = begin + segment.arc_length(found[k].place[here])
                angle[here] = found[k].angle[here]
        every = np.arange(len(points))
        normal = self.sign * np.stack((-np.sin(angle), np.cos(angle)), axis=-1)
        side = np.einsum("ij,ij->i", offsets[nearest, every], normal)
        # the normal of a sharp tip end does not tell a point in the tooth from one over its top
        # land
        beyond = self.sign * (np.linalg.norm(points, axis=1) - self.r_tip_circle) >= 0.0
        side[(nearest == 0) & (found[0].place == 0.0) & beyond] = 1.0
        return np.copysign(gaps[nearest, every], side), foot

    def polar_angle(self, s: ArrayLike) -> Floats:
        """Angle (n,), rad, between the tooth's centre line and the points at `s` : (n,) mm."""
        x, y = self.point(s).T
        return np.arctan2(x, y)

    def thickness(self, radius: float) -> float:
        """Thickness of the tooth along the circle of `radius`, mm, that its flank crosses once, or
        on which it ends."""

        def beyond(s: float) -> float:
            return float(np.hypot(*self.point(s)[0])) - radius

        if abs(beyond(0.0)) < 1e-12 * radius:  # an addendum of 0
            return self.top_land
        s = root_between(beyond, 0.0, self.length, xtol=1e-14 * radius)
        return 2.0 * radius * float(self.polar_angle(s)[0])

    @property
    def top_land(self) -> float:
        """Width of the top land, along the addendum circle, mm."""
        return float(2.0 * self.r_tip_circle * self.polar_angle(0.0)[0])

    @property
    def root_land(self) -> float:
        """Width of the dedendum circle between two neighbouring teeth, mm."""
        angle = np.pi / self.n_teeth - self.polar_angle(self.length)[0]
        return float(2.0 * self.r_root_circle * angle)


def check_flank(profile: ToothProfile, *, corners: bool = False) -> None:
    """Refuse a flank that is broken, ends beside its circles, folds back, or leaves its half tooth.

    corners : whether segments may join with an angle, and tangents be off by `OF_POINTS`
    """
    begin, end = np.array([each.point for each in profile.ends]).transpose(1, 0, 2)
    jumps = np.linalg.norm(begin[1:] - end[:-1], axis=1)
    bent = (np.abs(profile.kinks) > MISMATCH) & (not corners)
    broken = np.flatnonzero((jumps > MISMATCH * profile.r_tip_circle) | bent)
    if broken.size:
        before, after = profile.segments[broken[0] : broken[0] + 2]
        raise InputError(f"the {before.name} and {after.name} segments do not join smoothly")
    for name, at, circle, radius in (
        ("tip", begin[0], "addendum", profile.r_tip_circle),
        ("root", end[-1], "dedendum", profile.r_root_circle),
    ):
        reached = float(np.hypot(*at))
        if abs(reached - radius) > MISMATCH * profile.r_tip_circle:
            raise InputError(
                f"the {name} end has the radius {reached:.10g} mm, that of the {circle} circle is "
                f"{radius:.10g} mm"
            )
    s = np.unique(np.concatenate((np.linspace(0.0, profile.length, 257), profile.breaks)))
    found = profile.at(s)
    angle = np.arctan2(*found.point.T)
    if angle[0] <= 0.0:
        raise InputError("the tip end crosses the tooth's centre line, no top land is left")
    if angle[-1] >= np.pi / profile.n_teeth:
        raise InputError("the root end crosses the edge of the tooth sector, no root land is left")
    if angle.min() <= 0.0 or angle.max() >= np.pi / profile.n_teeth:
        raise InputError("the flank leaves its half of the tooth sector")
    outward = found.point[:, 0] * np.cos(found.angle) + found.point[:, 1] * np.sin(found.angle)
    back = OF_POINTS if corners else MISMATCH
    if np.any(profile.sign * outward > back * profile.r_tip_circle):
        raise InputError("the flank folds back between tip and root")
