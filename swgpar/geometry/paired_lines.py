"""Two lines whose points belong together: both surfaces of a wall, or both faces of a closed end or
flange.

All lines are straight pieces and arcs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from swgpar.geometry.arrays import Floats

SAME = 1e-7
"""mm, length up to which pieces are left out."""

BISECTIONS = 52
"""Halvings of a line's length: to round-off."""

STRAIGHT = 1e-9
"""rad, by which a line turns at most at a point where it counts as straight."""


class WallPoint(NamedTuple):
    """Corners of both lines: distances, radii or heights, and the radii that round them; mm."""

    distance: float
    radius: float
    outer_distance: float
    outer_radius: float
    rounding: float
    outer_rounding: float

    @property
    def across(self) -> Floats:
        """Way (2,) mm from the corner inside to that outside: along the line, and out from it."""
        return np.array(
            [self.outer_distance - self.distance, self.outer_radius - self.radius], dtype=float
        )


class Arc(NamedTuple):
    """A rounded corner.

    start, end, center : (2,) distance and radius, mm;  angle : rad, by which the line turns
    """

    start: Floats
    end: Floats
    center: Floats
    angle: float

    @property
    def ends(self) -> Floats:
        """Distances (2,) mm of start and end."""
        return np.array([self.start[0], self.end[0]])


class RoundedLine:
    """Radius, or height, over a distance: a polygon with rounded corners.

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
        angle = float(abs(turning))
        reach = radius * np.tan(0.5 * angle)
        start = self.points[k] - reach * before
        normal = np.sign(turning) * np.array([-before[1], before[0]])
        return Arc(start, self.points[k] + reach * after, start + radius * normal, angle)

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
        for start, end, center, _ in self.arcs():
            on = (distance > start[0]) & (distance < end[0])
            side = np.sign(start[1] - center[1])
            arm = np.hypot(*(start - center))
            r[on] = center[1] + side * np.sqrt(arm**2 - (distance[on] - center[0]) ** 2)
        return r


@dataclass(frozen=True)
class PairedLines:
    """Two lines with as many points, which belong together. Places are counted by the distance on
    the inner line.

    For the wall distances are those from the back of the teeth; for closed end or flange they run
    from the fillet on, and heights from the plane of its far face towards the teeth.
    """

    inner: RoundedLine
    outer: RoundedLine

    @property
    def length(self) -> float:
        """Distance (mm) at which the inner line ends."""
        return float(self.inner.points[-1, 0])

    @property
    def thickness(self) -> float:
        """Distance (mm) between both lines at their ends."""
        return float(self.outer.points[-1, 1] - self.inner.points[-1, 1])

    def outer_distance(self, s: Floats) -> Floats:
        """Distances (n,) mm on the outer line of places s (n,) mm: points of both lines belong
        together, and shares of the way between them."""
        return np.interp(s, self.inner.points[:, 0], self.outer.points[:, 0])

    def places(self, r: Floats, s: Floats) -> Floats:
        """Places (n,) mm for points at radii r and distances s (n,) mm between the lines."""
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

    def parameters(self, r: Floats, s: Floats) -> tuple[Floats, Floats]:
        """Places (n,) mm, and depths (n,), 0 on the inner line and 1 on the outer one, of points at
        radii r and distances s (n,) mm."""
        place = self.places(r, s)
        beside = self.outer_distance(place)
        inner, ahead = self.inner.radius(place), beside - place
        up = self.outer.radius(beside) - inner
        on_line = np.clip(s, 0.0, self.length) - place
        return place, (on_line * ahead + (r - inner) * up) / (ahead**2 + up**2)

    @property
    def _arcs(self) -> tuple[Floats, Floats]:
        """Places (n,) mm of the points and lengths (n,) mm along the middle."""
        middle = 0.5 * (self.inner.points + self.outer.points)
        steps = np.linalg.norm(np.diff(middle, axis=0), axis=1)
        return self.inner.points[:, 0], np.append(0.0, np.cumsum(steps))

    def along(self, s: Floats) -> Floats:
        """Lengths (n,) mm along the middle as far as places s (n,) mm."""
        return np.interp(s, *self._arcs)

    def at_length(self, length: Floats) -> Floats:
        """Places (n,) mm at lengths (n,) mm along the middle."""
        if not (self.inner.corners().size or self.outer.corners().size):
            return length
        return np.interp(length, *self._arcs[::-1])

    def _of_outer(self, distance: Floats) -> Floats:
        """Places (n,) mm of distances (n,) mm on the outer line."""
        return np.interp(distance, self.outer.points[:, 0], self.inner.points[:, 0])

    def corners(self) -> Floats:
        """Places (n,) mm at which one of the lines turns."""
        return np.union1d(self.inner.corners(), self._of_outer(self.outer.corners()))

    def arcs(self) -> Floats:
        """Places at which the arcs of both lines begin and end, mm, and the angles by which they
        turn, rad: (n, 3)."""
        found = [(*arc.ends, arc.angle) for arc in self.inner.arcs()]
        found += [(*self._of_outer(arc.ends), arc.angle) for arc in self.outer.arcs()]
        return np.array(found).reshape(-1, 3)

    def stations(self, usual: Floats, fixed: Floats) -> Floats:
        """Places (n,) mm of stations, among them the corners and the ends of their arcs.

        usual : (m,) mm, from 0 to `length`, of which the last one stays;  fixed : (k,) mm, that
        stay too
        """
        corners, ends = self.corners(), self.arcs()[:, :2].ravel()
        keep = np.concatenate([fixed, usual[-1:], corners])
        stations = usual
        # all of them: between two that are close the wall may change its thickness
        for at in corners:
            stations = with_station(stations, at, keep, room=0.0)
        for at in ends:
            stations = with_station(stations, at, keep)
        return stations


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
    """Thicknesses (mm) at points: square to the distance where both corners are at the same
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


def ended(points: list[WallPoint], length: float) -> list[WallPoint]:
    """Points of lines that end at a distance, mm: with level lines as far as there behind the last
    one, which stays where it is beyond."""
    last = points[-1]
    if last.distance > length + SAME:
        return points
    if last.distance >= length - SAME:
        return [*points[:-1], last._replace(distance=length, outer_distance=length)]
    return [*points, WallPoint(length, last.radius, length, last.outer_radius, 0.0, 0.0)]


def rounded_lines(points: Sequence[WallPoint]) -> tuple[RoundedLine, RoundedLine]:
    """Inner and outer line through points."""
    s, r, outer_s, outer_r, rounding, outer_rounding = np.array(points).T
    return (
        RoundedLine(np.column_stack([s, r]), rounding),
        RoundedLine(np.column_stack([outer_s, outer_r]), outer_rounding),
    )
