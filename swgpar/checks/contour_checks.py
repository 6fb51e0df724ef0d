"""Checks of the points of a contour: of the wall, and of closed end or flange."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from swgpar.errors import InputError
from swgpar.geometry.paired_lines import PairedLines, WallPoint
from swgpar.input.quantities import Section
from swgpar.input.require import require

THINNEST = 0.1
"""Thickness of a wall, closed end or flange over that of the rim, at least."""

STEEP, STEEPEST = 45.0, 80.0
"""Slope (degrees) of a surface, at most: with both corners of a point at the same distance, and
with a corner outside of its own."""

LARGEST_LEAN = 50.0
"""Angle (degrees) of the line between both corners of a point from square to the wall, at most:
elements have these lines as sides."""

ROUND_OFF = 1.0 + 1e-9
"""Factor on largest values that follow from others."""

END_NAMES = {
    "distance": "radius",
    "radius": "distance",
    "thickness": "thickness",
    "outer_distance": "near_radius",
    "outer_radius": "near_distance",
    "rounding": "rounding",
    "outer_rounding": "near_rounding",
}
WALL_NAMES = {name: name for name in END_NAMES}
"""Keys of the points of closed end or flange, and of a wall, by those of a wall."""


@dataclass(frozen=True)
class Contour:
    """A contour that is checked.

    key : of its points;  given : these points, without a first one that says what is known
    points : their corners with those at the beginning and at the end;  lines : through them
    length : mm, distance of the end;  first : number of the first given point
    names : keys of a point by those of the wall
    distance, radius : distances and heights (mm) of the lines as the values of these keys
    least : mm, thickness and distance of points, at least;  lowest : mm, height of the inner line
    to, beside, opposite : in words what the contour goes as far as, what lies beside a point, and
    where the corner on its inner line is
    """

    key: str
    given: Sequence[Section]
    points: Sequence[WallPoint]
    lines: PairedLines
    length: float
    first: int
    names: Mapping[str, str]
    distance: Callable[[float], float]
    radius: Callable[[float], float]
    least: float
    lowest: float
    to: str
    beside: str
    opposite: str

    def value(self, k: int, name: str) -> Any:
        """Value of a key of point k, from 1 on, by its name at the wall."""
        return getattr(self.given[k - 1], self.names[name])

    def point(self, k: int) -> str:
        """The key of point k."""
        return f"{self.key}.{k - 1 + self.first}"

    def key_of(self, k: int, name: str) -> str:
        """The key of a quantity of point k."""
        return f"{self.point(k)}.{self.names[name]}"

    def require(
        self, fits: bool, k: int, name: str, value: float, limits: tuple[float, float], words: str
    ) -> None:
        """Refuse a distance or a height of point k outside of limits (mm) of the lines."""
        convert = self.distance if name.endswith("distance") else self.radius
        ends = [convert(limit) for limit in limits]
        if not name.endswith("distance"):
            ends.sort()
        form = "{:g} to {:g} mm ({})" if name.endswith("distance") else "{:.5g} to {:.5g} mm ({})"
        require(fits, self.key_of(k, name), convert(value), form.format(*ends, words))


def check_corners(key: str, given: Sequence[Section], names: Mapping[str, str]) -> None:
    """Raise InputError for a point without a thickness or a corner outside."""
    for k, point in enumerate(given, 1):
        radius, distance, thickness = (
            getattr(point, names[name]) for name in ("outer_radius", "outer_distance", "thickness")
        )
        if radius is None:
            if thickness is None:
                raise InputError(
                    f"{key}.{k}.thickness is missing: it is needed without {names['outer_radius']}"
                )
            allowed = f"only with {names['outer_radius']}"
            require(distance is None, f"{key}.{k}.{names['outer_distance']}", distance, allowed)
        else:
            allowed = f"only without {names['outer_radius']}"
            require(thickness is None, f"{key}.{k}.thickness", thickness, allowed)


def check_contour(contour: Contour) -> None:
    """Raise InputError unless every point lies behind the one before, and no surface is too
    steep."""
    points, length = contour.points, contour.length
    for k in range(1, len(contour.given) + 1):
        point, before = points[k], points[k - 1]
        at, first = point.distance, before.distance + contour.least
        behind = first <= at * ROUND_OFF and at <= length * ROUND_OFF
        first, last = contour.distance(first), contour.distance(length)
        allowed = f"{first:g} ({THINNEST:g} rims behind the point before) to {last:g} mm "
        allowed += f"({contour.to})"
        require(behind, contour.key_of(k, "distance"), contour.distance(at), allowed)
        if contour.value(k, "outer_radius") is None and before.outer_distance == before.distance:
            _check_slopes(contour, k, STEEP)
        else:
            _check_slopes(contour, k, STEEPEST)
            _check_outside(contour, k)
    for k in range(1, len(contour.given) + 1):
        if contour.value(k, "outer_radius") is not None:
            _check_lean(contour, k)
    _check_roundings(contour)


def _check_roundings(contour: Contour) -> None:
    """Arcs end in the middle of the shorter side, at most."""
    limits = [line.largest_rounding() for line in (contour.lines.inner, contour.lines.outer)]
    for k in range(1, len(contour.given) + 1):
        own = contour.value(k, "outer_rounding") is not None
        point = contour.points[k]
        radii = (point.rounding, point.outer_rounding)
        for name, radius, of_line in zip(
            ("rounding", "outer_rounding"), radii, limits, strict=True
        ):
            # the last point may be the end
            limit = float(of_line[k - 1]) if k <= len(of_line) else 0.0
            allowed = f"0 to {limit:.4g} mm (half of the shorter side)"
            key = contour.key_of(k, name if own else "rounding")
            require(radius <= limit * ROUND_OFF, key, radius, allowed)


def _check_slopes(contour: Contour, k: int, degrees: float) -> None:
    """Both surfaces between two points. degrees : of the steepest"""
    point, before, names = contour.points[k], contour.points[k - 1], contour.names
    steep = float(np.tan(np.radians(degrees))) * ROUND_OFF
    step = (point.distance - before.distance) * steep
    more = f", {STEEPEST:g} with {names['outer_distance']} and {names['outer_radius']}"
    words = f"no steeper than {degrees:g} degrees from {contour.distance(before.distance):g} mm on"
    words += "" if degrees == STEEPEST else more
    low, high = max(before.radius - step, contour.lowest), before.radius + step
    fits = abs(point.radius - before.radius) <= step
    contour.require(fits, k, "radius", point.radius, (low, high), words)
    if degrees == STEEPEST:
        return
    thickness, outer = point.outer_radius - point.radius, before.outer_radius
    low = max(outer - step - point.radius, contour.least)
    high = outer + step - point.radius
    allowed = f"{low:.5g} to {high:.5g} mm ({words}, {THINNEST:g} rims)"
    fits = low <= thickness * ROUND_OFF and thickness <= high
    require(fits, contour.key_of(k, "thickness"), thickness, allowed)


def _check_outside(contour: Contour, k: int) -> None:
    """The corner outside."""
    point, before, length = contour.points[k], contour.points[k - 1], contour.length
    at, first = point.outer_distance, before.outer_distance + contour.least
    last = length if point.distance < length else point.distance
    low = last if point.distance >= length else first
    fits = low <= at * ROUND_OFF and at <= last * ROUND_OFF
    words = f"behind the point before, as far as {contour.to}"
    contour.require(fits, k, "outer_distance", at, (low, last), words)
    step = (at - before.outer_distance) * float(np.tan(np.radians(STEEPEST))) * ROUND_OFF
    low, high = before.outer_radius - step, before.outer_radius + step
    fits = low <= point.outer_radius <= high
    words = f"no steeper than {STEEPEST:g} degrees"
    contour.require(fits, k, "outer_radius", point.outer_radius, (low, high), words)
    across = float(np.hypot(*point.across))
    allowed = f"a corner {contour.least:g} mm ({THINNEST:g} rims) or more from that "
    allowed += contour.opposite
    key = contour.key_of(k, "outer_radius")
    fits = across * ROUND_OFF >= contour.least
    require(fits, key, contour.radius(point.outer_radius), allowed)


def _check_lean(contour: Contour, k: int) -> None:
    """The line between both corners is about square to the wall on both sides of it."""
    points = contour.points
    before, point, after = points[k - 1], points[k], points[min(k + 1, len(points) - 1)]
    across, names = complex(*point.across), contour.names
    for other, way in ((before, 1.0), (after, -1.0)):
        for wall in (
            complex(point.distance - other.distance, point.radius - other.radius),
            complex(
                point.outer_distance - other.outer_distance,
                point.outer_radius - other.outer_radius,
            ),
        ):
            if wall == 0.0:
                continue
            lean = 90.0 - float(np.degrees(np.angle(across / (way * wall))))
            if abs(lean) > 90.0:
                raise InputError(
                    f"{contour.point(k)}: its corner of {names['outer_distance']} and "
                    f"{names['outer_radius']} lies beyond that {contour.opposite}: allowed are "
                    "lines that do not cross, from files in their order"
                )
            if abs(lean) > LARGEST_LEAN:
                raise InputError(
                    f"{contour.point(k)}: the line between its corners leans by {abs(lean):.3g} "
                    f"degrees from square to {contour.beside} beside it: allowed up to "
                    f"{LARGEST_LEAN:g} degrees, by {names['outer_distance']} and "
                    f"{names['outer_radius']} on the bisector of both sides"
                )
