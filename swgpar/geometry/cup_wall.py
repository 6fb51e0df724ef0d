"""The section of the flexible spline's wall behind its teeth: exact lines of both surfaces.

The wall runs from the back of the teeth to a fillet, and from there inwards as a closed end with a
bore or outwards as a flange. All lines are straight pieces, arcs and quarters of ellipses.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from swgpar.geometry.arrays import Floats

SAME = 1e-7
"""mm, length up to which pieces are left out."""

SHARP = 0.25
"""Radius over the thickness up to which a corner outside has a station of its own."""

BISECTIONS = 52
"""Halvings of the wall's length: to round-off."""

STRAIGHT = 1e-9
"""rad, by which a line turns at most at a point where it counts as straight."""


class WallPoint(NamedTuple):
    """Corners of both surfaces: distances from the back of the teeth, radii, and the radii that
    round them; mm."""

    distance: float
    radius: float
    outer_distance: float
    outer_radius: float
    rounding: float
    outer_rounding: float

    @property
    def across(self) -> Floats:
        """Way (2,) mm from the corner inside to that outside: along the axis, and out from it."""
        return np.array(
            [self.outer_distance - self.distance, self.outer_radius - self.radius], dtype=float
        )


class Arc(NamedTuple):
    """A rounded corner. start, end, center : (2,) distance and radius, mm"""

    start: Floats
    end: Floats
    center: Floats


class RoundedLine:
    """Radius over the distance from the back of the teeth: a polygon with rounded corners.

    points : (n, 2) distance, which increases, and radius, mm;  rounding : (n,) mm, 0 at both ends
    """

    def __init__(self, points: Floats, rounding: Floats) -> None:
        self.points, self.rounding = points, rounding
        sides = np.diff(points, axis=0)
        self._along = sides / np.linalg.norm(sides, axis=1)[:, None]

    def turning(self) -> Floats:
        """Angles (n - 2,) rad by which the line turns at inner points, positive outwards."""
        a, b = self._along[:-1].T, self._along[1:].T
        angle = np.arctan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1])
        return np.where(np.abs(angle) < STRAIGHT, 0.0, angle)

    def largest_rounding(self) -> Floats:
        """Radii (n - 2,) mm of arcs that take half of the shorter side; inf where straight."""
        half = 0.5 * np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        with np.errstate(divide="ignore"):
            return np.minimum(half[:-1], half[1:]) / np.tan(0.5 * np.abs(self.turning()))

    def _arc(self, k: int) -> Arc | None:
        """The arc at point k, None where the line is straight or not rounded."""
        radius, turning = self.rounding[k], self.turning()[k - 1]
        if radius == 0.0 or turning == 0.0:
            return None
        before, after = self._along[k - 1 : k + 1]
        reach = radius * np.tan(0.5 * abs(turning))
        start = self.points[k] - reach * before
        normal = np.sign(turning) * np.array([-before[1], before[0]])
        return Arc(start, self.points[k] + reach * after, start + radius * normal)

    def arcs(self) -> list[Arc]:
        """The rounded corners."""
        corners = (self._arc(k) for k in range(1, len(self.points) - 1))
        return [arc for arc in corners if arc is not None]

    def pieces(self) -> list[tuple[Floats, Floats, Floats | None]]:
        """Start, end and centre (2,) of arcs and, without a centre, straight pieces in order."""
        pieces: list[tuple[Floats, Floats, Floats | None]] = []
        at = self.points[0]
        for k, turning in enumerate(self.turning(), 1):
            arc = self._arc(k)
            if turning != 0.0:
                pieces.append((at, self.points[k] if arc is None else arc.start, None))
                at = self.points[k] if arc is None else arc.end
            if arc is not None:
                pieces.append((arc.start, arc.end, arc.center))
        pieces.append((at, self.points[-1], None))
        return [piece for piece in pieces if piece[1][0] - piece[0][0] > SAME]

    def corners(self) -> Floats:
        """Distances (n,) mm of the points at which the line turns."""
        return self.points[1:-1, 0][self.turning() != 0.0]

    @property
    def straight(self) -> float:
        """Distance (mm) as far as which the line keeps its first radius."""
        if self.points[1, 1] != self.points[0, 1]:
            return 0.0
        arcs = [arc.start[0] for arc in self.arcs()]
        return float(min([*arcs, *self.corners(), self.points[-1, 0]]))

    def radius(self, distance: Floats) -> Floats:
        """Radii (n,) mm at distances (n,) mm."""
        r = np.interp(distance, *self.points.T)
        for start, end, center in self.arcs():
            on = (distance > start[0]) & (distance < end[0])
            side = np.sign(start[1] - center[1])
            arm = np.hypot(*(start - center))
            r[on] = center[1] + side * np.sqrt(arm**2 - (distance[on] - center[0]) ** 2)
        return r


@dataclass(frozen=True)
class Turn:
    """A quarter turn of a line around a pivot, from the direction of r to that of z.

    width, height : mm, distances of its straight ends from the pivot, along r and z
    radius : mm, that rounds its corner; None: the turn is a quarter of an ellipse
    """

    width: float
    height: float
    radius: float | None

    def distance(self, angle: Floats) -> Floats:
        """Distances (n,) mm from the pivot at angles (n,) rad from the direction of r."""
        cosine, sine = np.cos(angle), np.sin(angle)
        if self.radius is None:
            return 1.0 / np.hypot(cosine / self.width, sine / self.height)
        x, y = self.width - self.radius, self.height - self.radius
        with np.errstate(divide="ignore"):
            straight = np.minimum(self.width / cosine, self.height / sine)
        along, across = x * cosine + y * sine, x * sine - y * cosine
        on_arc = along + np.sqrt(np.maximum(self.radius**2 - across**2, 0.0))
        beside = (straight * sine <= y) | (straight * cosine <= x)
        return np.where(beside, straight, on_arc)

    def steps(self) -> list[tuple[tuple[float, float], tuple[float, float] | None]]:
        """Ends (along r and z, mm) of its edges with the centres of arcs, from r to z."""
        if self.radius is None:
            return [((0.0, self.height), (0.0, 0.0))]
        x, y = self.width - self.radius, self.height - self.radius
        arc = [((x, self.height), (x, y))] if self.radius else []
        return [((self.width, y), None), *arc, ((0.0, self.height), None)]


@dataclass(frozen=True)
class CupWall:
    """The section of the wall.

    inner, outer : lines over the distance from the back of the teeth, as far as the fillet, with
        as many points; places of the wall are counted by the distance on the inner line
    back, end : mm, z of the back of the teeth and of the far face of the closed end or flange
    fillet : mm, radius between wall and end on the outer side (closed end) or inner side (flange)
    inside : mm, radius of the fillet in the corner on the other side; None: a quarter of an ellipse
    around the centre of `fillet`
    end_thickness : mm, of the closed end or flange;  edge : mm, radius of its bore or rim
    outwards : whether the wall ends in a flange
    """

    inner: RoundedLine
    outer: RoundedLine
    back: float
    end: float
    fillet: float
    inside: float | None
    end_thickness: float
    edge: float
    outwards: bool

    @property
    def length(self) -> float:
        """Length (mm) of the wall as far as the fillet."""
        return float(self.inner.points[-1, 0])

    @property
    def thickness(self) -> float:
        """Thickness (mm) of the wall where the fillet begins."""
        return float(self.outer.points[-1, 1] - self.inner.points[-1, 1])

    def outer_distance(self, s: Floats) -> Floats:
        """Distances (n,) mm on the outer line of places s (n,) mm of the wall: points of both lines
        belong together, and shares of the way between them."""
        return np.interp(s, self.inner.points[:, 0], self.outer.points[:, 0])

    def places(self, r: Floats, s: Floats) -> Floats:
        """Places (n,) mm of the wall for points at radii r and distances s (n,) mm in it."""
        if np.array_equal(self.inner.points[:, 0], self.outer.points[:, 0]):
            return np.clip(s, 0.0, self.length)
        low, high = np.zeros_like(s), np.full_like(s, self.length)
        for _ in range(BISECTIONS):
            place = 0.5 * (low + high)
            outer = self.outer_distance(place)
            inside, outside = self.inner.radius(place), self.outer.radius(outer)
            # which side of the line between both surfaces the point is on
            beyond = (s - place) * (outside - inside) - (r - inside) * (outer - place) > 0.0
            low, high = np.where(beyond, place, low), np.where(beyond, high, place)
        return 0.5 * (low + high)

    @property
    def _arcs(self) -> tuple[Floats, Floats]:
        """Places (n,) mm of the points and lengths (n,) mm along the middle of the wall."""
        middle = 0.5 * (self.inner.points + self.outer.points)
        steps = np.linalg.norm(np.diff(middle, axis=0), axis=1)
        return self.inner.points[:, 0], np.append(0.0, np.cumsum(steps))

    def along(self, s: Floats) -> Floats:
        """Lengths (n,) mm along the middle of the wall as far as places s (n,) mm."""
        return np.interp(s, *self._arcs)

    def at_length(self, length: Floats) -> Floats:
        """Places (n,) mm at lengths (n,) mm along the middle of the wall."""
        if not (self.inner.corners().size or self.outer.corners().size):
            return length
        return np.interp(length, *self._arcs[::-1])

    @property
    def center(self) -> tuple[float, float]:
        """Radius and z (mm) of the pivot of the turn from the wall into closed end or flange: there
        both lines have begun to turn."""
        inner, outer = self.inner.points[-1, 1], self.outer.points[-1, 1]
        if self.inside is None:
            r = inner + self.fillet if self.outwards else outer - self.fillet
            return float(r), self.end - self.fillet
        if self.outwards:
            r = max(outer + self.inside, inner + self.fillet)
        else:
            r = min(inner - self.inside, outer - self.fillet)
        return float(r), self.end - end_reach(self.fillet, self.inside, self.end_thickness)

    @property
    def turns(self) -> tuple[Turn, Turn]:
        """The turns of the inner and of the outer line around the pivot."""
        (r, z), lines = self.center, (self.inner, self.outer)
        radii = (self.fillet, self.inside) if self.outwards else (self.inside, self.fillet)
        inner, outer = (
            Turn(abs(float(line.points[-1, 1]) - r), face - z, radius)
            for line, face, radius in zip(lines, self.faces, radii, strict=True)
        )
        return inner, outer

    def turn_angles(self, number: int) -> Floats:
        """Angles (n,) rad of stations of the turn, `number` or one more: a corner has one."""
        angle = np.linspace(0.0, 0.5 * np.pi, number + 1)
        convex = self.turns[0 if self.outwards else 1]
        if self.inside is None or self.fillet > SHARP * min(self.thickness, self.end_thickness):
            return angle
        corner = np.arctan2(convex.height, convex.width)
        if number == 1:
            return np.insert(angle, 1, corner)
        angle[1 + int(np.abs(angle[1:-1] - corner).argmin())] = corner
        return angle

    @property
    def arm(self) -> float:
        """Mean distance (mm) of the middle of the turn from the pivot."""
        half = 0.5 * min(self.thickness, self.end_thickness)
        return self.fillet - half if self.inside is None else self.inside + half

    @property
    def faces(self) -> tuple[float, float]:
        """z (mm) of the closed end or flange on the inner and on the outer line."""
        near = self.end - self.end_thickness
        return (self.end, near) if self.outwards else (near, self.end)

    def stations(self, usual: Floats, first: float) -> Floats:
        """Places (n,) mm of stations, among them the corners and the ends of their arcs.

        usual : (m,) mm, from 0 to `length`;  first : mm, as far as which they stay
        """
        places = self.inner.points[:, 0], self.outer.points[:, 0]
        corners = np.union1d(self.inner.corners(), np.interp(self.outer.corners(), *places[::-1]))
        inner, outer = (
            np.array([point[0] for arc in line.arcs() for point in (arc.start, arc.end)])
            for line in (self.inner, self.outer)
        )
        ends = np.append(inner, np.interp(outer, *places[::-1]))
        keep = np.concatenate([usual[usual <= first], usual[-1:], corners])
        stations = usual
        # all of them: between two that are close the wall may change its thickness
        for at in corners:
            stations = with_station(stations, at, keep, room=0.0)
        for at in ends:
            stations = with_station(stations, at, keep)
        return stations


def decay_length(radius: float, thickness: float) -> float:
    """Length (mm) over which a disturbance of a wall decays, of its radius and thickness (mm)."""
    return math.sqrt(radius * thickness)


def end_reach(fillet: float, inside: float | None, end_thickness: float) -> float:
    """Distance (mm) from the far face of closed end or flange at which the turn begins."""
    return fillet if inside is None else max(fillet, end_thickness + inside)


def with_station(stations: Floats, at: float, keep: Floats, room: float = 0.25) -> Floats:
    """The stations (n,) with one at `at`, unless a kept one is close; another close one moves.

    keep : (m,) stations that do not move;  room : share of the distance to the next one within
    which a station is close to a kept one
    """
    near = int(np.abs(stations - at).argmin())
    gap = np.diff(stations)[min(near, len(stations) - 2)]
    fixed = bool(np.isclose(stations[near], keep, rtol=0.0, atol=1e-9).any())
    if abs(stations[near] - at) >= (max(room * gap, 1e-9) if fixed else 0.5 * gap):
        return np.insert(stations, int(np.searchsorted(stations, at)), at)
    moved = stations.copy()
    if not fixed:
        moved[near] = at
    return moved


def thicknesses(points: Sequence[WallPoint]) -> list[float]:
    """Thicknesses (mm) of the wall at points: across the axis where both corners are at the same
    distance, else across the thinner of the pieces beside it."""
    found = []
    for k, point in enumerate(points):
        along, across = point.across
        if along == 0.0:
            found.append(float(across))
            continue
        beside = (*points[:k][-1:], *points[k + 1 : k + 2])
        sides = [
            np.array([other.distance - point.distance, other.radius - point.radius])
            for other in beside
        ]
        found.append(
            min(abs(float(x * across - y * along)) / float(np.hypot(x, y)) for x, y in sides)
        )
    return found


def rounded_lines(points: Sequence[WallPoint]) -> tuple[RoundedLine, RoundedLine]:
    """Inner and outer line through points."""
    s, r, outer_s, outer_r, rounding, outer_rounding = np.array(points).T
    return (
        RoundedLine(np.column_stack([s, r]), rounding),
        RoundedLine(np.column_stack([outer_s, outer_r]), outer_rounding),
    )
