"""The section of the flexible spline's wall behind its teeth: exact lines of both surfaces.

The wall runs from the back of the teeth to a fillet, and from there inwards as a closed end with a
bore or outwards as a flange. All lines are straight pieces, arcs and quarters of ellipses.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swgpar.geometry.arrays import Floats
from swgpar.geometry.paired_lines import (
    SAME,
    PairedLines,
    WallPoint,
    ended,
    rounded_lines,
    thicknesses,
)

SHARP = 0.25
"""Radius over the thickness up to which a corner outside has a station of its own."""

INSIDE = 1e-6
"""Share of its thickness by which a point may lie outside of closed end or flange."""


class EndPoint(NamedTuple):
    """Corners of both faces of closed end or flange: radii, heights over the plane of the far face
    beside the fillet towards the teeth, and the radii that round them; mm."""

    radius: float
    height: float
    near_radius: float
    near_height: float
    rounding: float
    near_rounding: float


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
class CupWall(PairedLines):
    """The section of the wall. Its lines run from the back of the teeth to the fillet.

    back, end : mm, z of the back of the teeth, and of the far face of closed end or flange beside
    the fillet
    fillet : mm, radius between wall and end on the outer side (closed end) or inner side (flange)
    inside : mm, radius of the fillet in the corner on the other side; None: a quarter of an ellipse
    around the centre of `fillet`
    end_thickness : mm, of closed end or flange beside the fillet
    edge : mm, radius of its bore or rim
    outwards : whether the wall ends in a flange
    end_contour : corners of closed end or flange between fillet and edge; none where it is flat
    """

    back: float
    end: float
    fillet: float
    inside: float | None
    end_thickness: float
    edge: float
    outwards: bool
    end_contour: tuple[EndPoint, ...] = ()

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
        """z (mm) of closed end or flange on the inner and on the outer line, beside the fillet."""
        near = self.end - self.end_thickness
        return (self.end, near) if self.outwards else (near, self.end)

    @property
    def _side(self) -> float:
        """Way of closed end or flange along r."""
        return 1.0 if self.outwards else -1.0

    def on_plate(self, radius: Floats, z: Floats) -> tuple[Floats, Floats]:
        """Way (mm) from the fillet towards the edge, and height (mm) above the plane of the far
        face, towards the teeth, of points of closed end or flange."""
        return self._side * (radius - self.center[0]), self.end - z

    def off_plate(self, way: Floats, height: Floats) -> Floats:
        """Points (n, 2) r and z, mm, at ways and heights (n,) mm; see `on_plate`."""
        return np.stack((self.center[0] + self._side * way, self.end - height), axis=-1)

    @cached_property
    def plate_points(self) -> list[WallPoint]:
        """Corners of closed end or flange from the fillet to its edge, by ways and heights."""
        begin, side = self.center[0], self._side
        width = abs(self.edge - begin)
        points = [WallPoint(0.0, 0.0, 0.0, self.end_thickness, 0.0, 0.0)]
        for k, p in enumerate(self.end_contour):
            way, beside = side * (p.radius - begin), side * (p.near_radius - begin)
            if k or abs(way) > SAME:  # the first one is known
                rounding = p.rounding, p.near_rounding
                points.append(WallPoint(way, p.height, beside, p.near_height, *rounding))
        return ended(points, width)

    @cached_property
    def plate(self) -> PairedLines:
        """Closed end or flange: heights of the far face (inner line) and of that towards the teeth
        over the way from the fillet."""
        return PairedLines(*rounded_lines(self.plate_points))

    @cached_property
    def plate_scale(self) -> tuple[Floats, Floats]:
        """Ways (n,) mm of the corners of closed end or flange, and lengths (n,) mm as far as there
        along its middle in proportion to the length over which bending decays, which goes with the
        root of the thickness; where that is `end_thickness` they are true lengths."""
        points = self.plate.inner.points, self.plate.outer.points
        middle = 0.5 * (points[0] + points[1])
        thickness = np.array(thicknesses(self.plate_points))
        mean = 0.5 * (thickness[:-1] + thickness[1:])
        steps = np.linalg.norm(np.diff(middle, axis=0), axis=1) * np.sqrt(self.end_thickness / mean)
        return points[0][:, 0], np.append(0.0, np.cumsum(steps))

    def faces_at(self, radius: float) -> tuple[float, float]:
        """z (mm) of the near and of the far face of closed end or flange at a radius, mm; beside it
        those at its ends."""
        near, far = self._heights_at(radius)
        return self.end - near, self.end - far

    def thickness_at(self, radius: float) -> float:
        """Thickness (mm) of closed end or flange along the axis at a radius, mm."""
        near, far = self._heights_at(radius)
        return near - far

    def _heights_at(self, radius: float) -> tuple[float, float]:
        """Heights (mm) of the near and of the far face of closed end or flange at a radius, mm."""
        way, _ = self.on_plate(np.array([radius]), np.zeros(1))
        at = np.clip(way, 0.0, self.plate.length)
        near, far = (line.radius(at)[0] for line in (self.plate.outer, self.plate.inner))
        return float(near), float(far)

    @property
    def farthest(self) -> float:
        """Largest z (mm) of closed end or flange."""
        return self.end - min(point.radius for point in self.plate_points)

    def is_on_plate(self, radius: Floats, z: Floats) -> NDArray[np.bool_]:
        """Whether points (n,), mm, of the section belong to closed end or flange."""
        way, height = self.on_plate(radius, z)
        _, depth = self.plate.parameters(height, way)
        within = np.abs(depth - 0.5) <= 0.5 + INSIDE
        return (way >= 0.0) & ((z > self.center[1]) | within)


def decay_length(radius: float, thickness: float) -> float:
    """Length (mm) over which a disturbance of a wall decays, of its radius and thickness (mm)."""
    return math.sqrt(radius * thickness)


def end_reach(fillet: float, inside: float | None, end_thickness: float) -> float:
    """Distance (mm) from the far face of closed end or flange at which the turn begins."""
    return fillet if inside is None else max(fillet, end_thickness + inside)
