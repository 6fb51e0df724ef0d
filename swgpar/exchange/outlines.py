"""Outlines of gears and cams as lines, arcs and curves through exact points, in the plane of the
section.

Arcs are exact. Other curves pass through exact points, so many that the curve between them stays
within `TOLERANCE` of the exact one.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GearName
from swgpar.geometry.rotation import rotated
from swgpar.profiles.flank import Segment, ToothProfile

TOLERANCE = 1e-4
"""mm, of the curves through points."""

FLANK_POINTS = 33
"""On a segment of a flank that is no arc: an involute of module 1 is met to 0.01 µm."""


class Edge(NamedTuple):
    """A piece of an outline.

    points : (n, 2) mm, from start to end; two points are a line
    center : (2,) mm of an arc from the first to the last of the points, else None
    """

    points: np.ndarray
    center: np.ndarray | None = None

    def turned(self, angle: float) -> Edge:
        """The edge rotated about the axis, rad."""
        center = None if self.center is None else rotated(self.center, angle)
        return Edge(rotated(self.points, angle), center)

    def mirrored(self) -> Edge:
        """The edge at (-x, y), run through from its end to its start."""
        flip = np.array([-1.0, 1.0])
        return Edge(self.points[::-1] * flip, None if self.center is None else self.center * flip)


def flank_edges(profile: ToothProfile) -> list[Edge]:
    """The flank at x > 0, from its root to its tip."""
    edges = []
    for (begin, end), segment in zip(pairwise(profile.breaks), profile.segments, strict=True):
        if not isinstance(segment, Segment):
            edges.append(Edge(profile.point(np.linspace(begin, end, FLANK_POINTS))[::-1]))
            continue
        ends = segment.at(np.array([segment.length, 0.0])).point
        if segment.curvature == 0.0:
            edges.append(Edge(ends))
            continue
        normal = np.array([-np.sin(segment.direction), np.cos(segment.direction)])
        edges.append(Edge(ends, ends[1] + normal / segment.curvature))
    return edges[::-1]


def gear_outline(design: DriveDesign, gear: GearName) -> list[Edge]:
    """The closed toothed outline of an undeformed gear, counter-clockwise, its first tooth on +y or
    beside it."""
    profile = design.profile(gear)
    right = flank_edges(profile)
    left = [edge.mirrored() for edge in right[::-1]]
    axis = np.zeros(2)
    pitch = 2.0 * np.pi / profile.n_teeth
    tip = Edge(np.array([right[-1].points[-1], left[0].points[0]]), axis)
    root = Edge(np.array([left[-1].points[-1], rotated(right[0].points[0], pitch)]), axis)
    tooth = [*right, tip, *left, root]
    phase = 0.0 if gear == "flexible_spline" else 0.5 * pitch
    return [edge.turned(phase + pitch * k) for k in range(profile.n_teeth) for edge in tooth]
