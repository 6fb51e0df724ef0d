"""Signed distances between the outlines of two rigid gears.

An outline is sampled from the middle of the tooth to that of the space. The distance of a point is
that to the circle of curvature at the nearest sample, whose error is of third order in the spacing.
Outlines repeat and mirror themselves, so that a point and the place nearest to it lie in the same
half of the same pitch.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TypeVar

import numpy as np
import scipy
from numpy.typing import NDArray

from swgpar.geometry.arrays import Complex, Floats, as_complex, as_points
from swgpar.profiles.flank import FlankSegment, Segment, ToothProfile
from swgpar.profiles.tooth_motion import Pose, ToothMotion

FLANK_STEPS, LAND_STEPS = 1024, 64
"""Intervals between the samples of a flank, and of a land."""

ANGLES, STRIDE = 181, 64
"""Intervals of the angle between minor axes, and samples in an interval of the outline, at the
first level of the search."""

DIVISION, LEVELS = 4, 8
"""Parts into which the one or the other is divided from level to level, and number of levels."""

SHIFTS = np.arange(DIVISION) - 0.5 * (DIVISION - 1)
"""Middles of these parts, in parts from the middle of the interval."""

LEAF = 64
"""Samples that are compared with a point at once; along a curve more of them take less time."""

SPEED_MARGIN = 1.1
"""Largest speed in an interval over that in its middle."""

Indices = NDArray[np.intp]
Array = TypeVar("Array", Floats, Indices)


@dataclass(frozen=True)
class Feet:
    """Places of an outline that are nearest to points.

    distance : (n,) mm, below 0 in the material;  gradient : (n,) complex, of the distance
    sample : (n,) nearest samples
    """

    distance: Floats
    gradient: Complex
    sample: Indices


@dataclass(frozen=True)
class Outline:
    """Samples of half a pitch of a gear, along the top land, the flank and the root land.

    Where two segments meet, each of them has a sample.

    external : whether the teeth point outwards;  pitch : rad
    place : (n,) mm, arc lengths from the middle of the tooth
    point, normal : (n,) complex x + i y, mm, and unit vectors out of the material
    curvature : (n,) 1/mm, below 0 where convex
    flank : slice of the samples of the flank, its rounded edge and its root included
    """

    external: bool
    pitch: float
    place: Floats
    point: Complex
    normal: Complex
    curvature: Floats
    flank: slice

    @cached_property
    def _tree(self) -> scipy.spatial.cKDTree:
        xy = as_points(self.point)
        return scipy.spatial.cKDTree(xy, leafsize=LEAF, compact_nodes=False)

    @cached_property
    def _neighbours(self) -> tuple[Indices, Indices]:
        """Samples at the same place as each one, as the end of a segment and as the beginning of
        the next."""
        index = np.arange(len(self.place))
        meets = np.append(np.diff(self.place) == 0.0, False)
        return np.where(np.roll(meets, 1), index - 1, index), np.where(meets, index + 1, index)

    def distance(self, points: Complex) -> Feet:
        """Distance of points x + i y (n,), mm, from the samples."""
        xy = as_points(points)
        apart, nearest = self._tree.query(xy)
        before, after = self._neighbours[0][nearest], self._neighbours[1][nearest]
        distance, along = self._to_circle(points, after)
        gradient = self.normal[after]
        joint = np.flatnonzero((after != before) & (along < 0.0))
        if joint.size:
            former, along = self._to_circle(points[joint], before[joint])
            side = np.where(np.maximum(former, distance[joint]) > 0.0, 1.0, -1.0)
            away = (points - self.point[nearest])[joint] * side / np.maximum(apart[joint], 1e-300)
            smooth = along <= 0.0
            distance[joint] = np.where(smooth, former, side * apart[joint])
            gradient[joint] = np.where(smooth, self.normal[before[joint]], away)
        return Feet(distance, gradient, nearest)

    def _to_circle(self, points: Complex, samples: Indices) -> tuple[Floats, Floats]:
        """Signed distance (n,) mm to the circle of curvature, and the offset (n,) mm towards the
        root."""
        local = (points - self.point[samples]) * np.conj(self.normal[samples])
        height, square = local.real, np.abs(local) ** 2
        curvature = self.curvature[samples]
        bent = 1.0 - 2.0 * curvature * height + curvature**2 * square
        distance = (2.0 * height - curvature * square) / (1.0 + np.sqrt(np.maximum(bent, 0.0)))
        return distance, -local.imag if self.external else local.imag

    def part(self, sample: int) -> str:
        """Where a sample is: "tip", "flank" or "root"."""
        if self.flank.start <= sample < len(self.place) + self.flank.stop:
            return "flank"
        return "tip" if sample < self.flank.start else "root"

    def folded(self, points: Complex) -> tuple[Complex, NDArray[np.bool_]]:
        """Points x + i y (n,), mm, moved by pitches and mirrored into the half pitch of the
        samples, and whether they are mirrored."""
        angle = np.angle(-1j * points)
        angle -= self.pitch * np.round(angle / self.pitch)
        return 1j * np.abs(points) * np.exp(-1j * np.abs(angle)), angle > 0.0


@lru_cache(maxsize=16)
def outline(profile: ToothProfile) -> Outline:
    """Sampled outline of a gear; kept, because every search of a design asks for it."""
    ends = np.concatenate([profile.ends[0].point[:1], profile.ends[-1].point[1:]])
    top, bottom = np.arctan2(*ends.T)
    segments: list[FlankSegment] = [
        _land("top land", profile.r_tip_circle, 0.0, float(top)),
        *profile.segments,
        _land("root land", profile.r_root_circle, float(bottom), np.pi / profile.n_teeth),
    ]
    counts = [
        max(int(np.ceil(FLANK_STEPS * segment.length / profile.length)), 1)
        for segment in profile.segments
    ]
    counts = [LAND_STEPS, *counts, LAND_STEPS]
    local = [
        np.linspace(0.0, segment.length, count + 1)
        for segment, count in zip(segments, counts, strict=True)
    ]
    begins = np.cumsum([0.0, *(segment.length for segment in segments[:-1])])
    at = [segment.at(s) for segment, s in zip(segments, local, strict=True)]
    angle = np.concatenate([each.angle for each in at])
    return Outline(
        external=profile.external,
        pitch=2.0 * np.pi / profile.n_teeth,
        place=np.concatenate([begin + s for begin, s in zip(begins, local, strict=True)]),
        point=as_complex(np.concatenate([each.point for each in at])),
        normal=profile.sign * 1j * np.exp(1j * angle),
        curvature=profile.sign * np.concatenate([each.curvature for each in at]),
        flank=slice(LAND_STEPS + 1, -LAND_STEPS - 1),
    )


def _land(name: str, radius: float, low: float, high: float) -> Segment:
    """Arc about the axis between two angles, rad, from the tooth's centre line."""
    start = (radius * float(np.sin(low)), radius * float(np.cos(low)))
    return Segment(name, start, -low, -1.0 / radius, radius * (high - low))


@dataclass(frozen=True)
class NearestPlace:
    """Where a tooth of the flexible spline comes nearest to the ring gear, or is deepest in it.

    distance : mm, below 0 where they overlap;  psi : rad, material angle of the tooth
    spline, ring : parts of their outlines, "tip", "flank" or "root"
    """

    distance: float
    psi: float
    spline: str
    ring: str


@dataclass(frozen=True)
class _Intervals:
    """Distances from the middle of intervals of the spline's outline, each at a pose of the tooth.

    middle : (n,) samples;  feet : on the ring gear
    rate : (n,) mm, by the angle of the pose;  speed : (n,) mm, of the points by that angle
    reach : (n,) mm, to the ends of the interval;  slope : (n,) largest change of the distance
    along the outline, over the arc length
    """

    middle: Indices
    feet: Feet
    rate: Floats
    speed: Floats
    reach: Floats
    slope: Floats


@dataclass(frozen=True)
class OutlinePair:
    """Outlines of the flexible spline and of a ring gear, and the motion of the spline's tooth.

    The half of the spline's tooth at x > 0 is looked at.
    """

    spline: Outline
    ring: Outline
    motion: ToothMotion

    @cached_property
    def _bend(self) -> float:
        """Largest curvature of both outlines, 1/mm."""
        return float(max(np.abs(self.spline.curvature).max(), np.abs(self.ring.curvature).max()))

    def _intervals(self, pose: Pose, first: Indices, stride: int, *, facing: bool) -> _Intervals:
        """Intervals of `stride` samples from the samples `first` (n,), each at its own pose (n,).

        facing : whether the flank of the ring gear that the spline's faces counts alone, else all
        """
        middle, last, reach = self._parts(first, stride)
        turn = pose.turn
        arm = turn * self.spline.point[middle]
        velocity, points = pose.c1 + 1j * pose.angle1 * arm, pose.c + arm
        to_tooth = np.exp(1j * np.pi / self.motion.teeth_rg)
        if facing:
            places, mirrored = self.motion.mirrored(points), np.ones(len(points), dtype=bool)
        else:
            places, mirrored = self.ring.folded(points * to_tooth)
        feet = self.ring.distance(places)
        # the gradient in the slot's frame, from its radial and circumferential parts
        polar = np.conj(places) * feet.gradient
        polar = np.where(mirrored, np.conj(polar), polar)
        back = np.conj(polar * points) / np.abs(points) ** 2
        along = [
            np.abs((back * turn * self.spline.normal[at]).imag) for at in (first, middle, last)
        ]
        return _Intervals(
            middle, feet, np.abs((back * velocity).real), np.abs(velocity), reach, np.max(along, 0)
        )

    def _parts(self, first: Indices, stride: int) -> tuple[Indices, Indices, Floats]:
        """Middles and last samples (n,) of intervals, and the reach (n,) mm from the middle to the
        ends."""
        place, end = self.spline.place, len(self.spline.place) - 1
        middle, last = np.minimum(first + stride // 2, end), np.minimum(first + stride, end)
        return middle, last, np.maximum(place[middle] - place[first], place[last] - place[middle])

    def _lowest(self, intervals: _Intervals, step: float) -> Floats:
        """Smallest distances (n,) mm that intervals may hold, with `step` rad of the pose's angle.

        The distance changes no faster than the places move, and near the middle by its gradient.
        """
        turned = 0.5 * step * SPEED_MARGIN
        far = turned * intervals.speed + intervals.reach
        near = turned * intervals.rate + SPEED_MARGIN * intervals.slope * intervals.reach
        return intervals.feet.distance - np.minimum(far, near + self._bend * far**2)

    def nearest_place(self, below: float = np.inf) -> NearestPlace:
        """The nearest place of all while the cam turns by one lobe, to all parts of the ring
        gear.

        below : mm; where no distance is smaller, some place that is no nearer, in less time
        """
        step, stride = 2.0 * np.pi / self.motion.line.lobes / ANGLES, STRIDE
        psi, first = (
            grid.ravel()
            for grid in np.meshgrid(
                step * (np.arange(ANGLES) - 0.5 * (ANGLES - 1)),
                np.arange(0, len(self.spline.place), stride),
                indexing="ij",
            )
        )
        kept = self._reaching(psi, first, stride, step, below)
        psi, first = psi[kept], first[kept]
        nearest = NearestPlace(np.inf, 0.0, "", "")
        for level in range(LEVELS):
            if not psi.size:
                break
            angles, index = np.unique(psi, return_inverse=True)
            pose = self.motion.pose(angles).taken(index)
            intervals = self._intervals(pose, first, stride, facing=False)
            k = int(np.argmin(intervals.feet.distance))
            if intervals.feet.distance[k] < nearest.distance:
                nearest = NearestPlace(
                    float(intervals.feet.distance[k]),
                    float(psi[k]),
                    self.spline.part(intervals.middle[k]),
                    self.ring.part(intervals.feet.sample[k]),
                )
            kept = self._lowest(intervals, step) < min(nearest.distance, below)
            psi, first = psi[kept], first[kept]
            if level % 2 == 0 and stride > 1:
                psi, first = self._divided(psi, first, stride)
                stride //= DIVISION
            else:
                step /= DIVISION
                psi = (psi[:, None] + step * SHIFTS).ravel()
                first = np.repeat(first, DIVISION)
        return nearest

    def _reaching(
        self, psi: Floats, first: Indices, stride: int, step: float, below: float
    ) -> NDArray[np.bool_]:
        """Intervals that may come as near to the circle of the ring gear's tips as the tooth at the
        major axis comes to the ring gear, and nearer than `below`, mm."""
        starts = np.arange(0, len(self.spline.place), stride)
        middle, _, reach = self._parts(first, stride)
        at_axis = self.motion.pose(np.zeros(1)).taken(np.zeros(len(starts), dtype=np.intp))
        known = self._intervals(at_axis, starts, stride, facing=False).feet.distance.min()
        angles, index = np.unique(psi, return_inverse=True)
        pose = self.motion.pose(angles).taken(index)
        arm = pose.turn * self.spline.point[middle]
        moved = 0.5 * step * SPEED_MARGIN * np.abs(pose.c1 + 1j * pose.angle1 * arm)
        apart = np.abs(self.ring.point).min() - np.abs(pose.c + arm)
        return apart - moved - reach < min(known, below)

    def _divided(self, owner: Array, first: Indices, stride: int) -> tuple[Array, Indices]:
        """Parts of intervals of `stride` samples: what belongs to each, and their first samples."""
        if stride == 1:
            return owner, first
        first = (first[:, None] + stride // DIVISION * np.arange(DIVISION)).ravel()
        inside = first < len(self.spline.place)
        return np.repeat(owner, DIVISION)[inside], first[inside]

    def facing_gaps(
        self, psi: Floats, rotation: Floats | float = 0.0, exact_below: float = np.inf
    ) -> Floats:
        """Smallest distances (n,) mm of the spline's flank from the tooth that it faces, below 0
        where they overlap.

        psi : (n,) rad, material angles of the tooth
        rotation : rad, of the spline's material beyond its place in the slot; scalar or (n,)
        exact_below : mm; wider gaps are those of a few places, which are no smaller
        """
        rotation = np.broadcast_to(rotation, psi.shape)
        slip = self.motion.teeth_fs / self.motion.teeth_rg * rotation
        pose = self.motion.pose(psi + rotation).turned(slip)
        flank, stride = self.spline.flank, STRIDE * DIVISION
        starts = np.arange(flank.start, len(self.spline.place) + flank.stop, stride)
        tooth, first = np.repeat(np.arange(len(psi)), len(starts)), np.tile(starts, len(psi))
        gaps = np.full(len(psi), np.inf)
        while True:
            intervals = self._intervals(pose.taken(tooth), first, stride, facing=True)
            np.minimum.at(gaps, tooth, intervals.feet.distance)
            if stride == 1:
                return gaps
            kept = self._lowest(intervals, 0.0) < np.minimum(gaps, exact_below)[tooth]
            tooth, first = self._divided(tooth[kept], first[kept], stride)
            stride //= DIVISION


@lru_cache(maxsize=16)
def nearest_place(spline: ToothProfile, ring: ToothProfile, motion: ToothMotion) -> NearestPlace:
    """`OutlinePair.nearest_place` of two profiles; kept, because conjugate teeth, the check and its
    remarks ask for it."""
    return OutlinePair(outline(spline), outline(ring), motion).nearest_place()
