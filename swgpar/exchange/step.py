"""STEP files of the flexible spline, the ring gear, its housing and the cam, by gmsh's OpenCASCADE
kernel.

The bodies are undeformed and without crowning and slope, which are below the accuracy of many CAD
programs. The axis is z, the mid-plane of the face width z = 0, the closed end of the cup at z > 0.
Units are mm.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from types import ModuleType
from typing import Literal

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GearName
from swgpar.exchange.outlines import Edge, cam_outlines, gear_outline
from swgpar.geometry.arrays import Floats
from swgpar.meshing.gmsh_session import gmsh_model

PIECES = 32
"""Curves around a cam."""

SAME = 1e-7
"""mm, distance below which the ends of edges are one point."""


Solid = GearName | Literal["wave_generator", "housing"]
"""Name of a solid, and of its file."""


def write_step(design: DriveDesign, folder: Path) -> list[Path]:
    """Write a STEP file of each gear, wave_generator.step and of a drive with one housing.step.

    Call it on one rank.
    """
    paths = []
    names: list[Solid] = [*design.gears, "wave_generator"]
    for name in [*names, "housing"] if design.housing else names:
        path = folder / f"{name}.step"
        with gmsh_model(name) as gmsh:
            _build(gmsh, design, name)
            gmsh.model.occ.synchronize()
            with _quiet():
                gmsh.write(str(path))
        paths.append(path)
    return paths


@contextmanager
def _quiet() -> Iterator[None]:
    """Drop what OpenCASCADE writes to the terminal."""
    sys.stdout.flush()
    kept = os.dup(1)
    with open(os.devnull, "wb") as nothing:
        os.dup2(nothing.fileno(), 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


def _build(gmsh: ModuleType, design: DriveDesign, name: Solid) -> None:
    """The solid of a body in the present model."""
    if name == "wave_generator":
        half = 0.5 * design.wave_generator.face_width
        for points in cam_outlines(design):
            curves = closed_curve(gmsh, points, design.cam().evaluate(points)[1], -half)
            _extrude(gmsh, [gmsh.model.occ.addCurveLoop(curves)], 2.0 * half)
        return
    back, front = design.axial_range("ring_gear" if name == "housing" else name)
    width = front - back
    if name == "housing":
        inner = design.geometry.gears["ring_gear"].outer_radius
        radii = (design.geometry.outer_radius, inner)
        _extrude(gmsh, [_circle(gmsh, radius, back) for radius in radii], width)
        return
    teeth = _loop(gmsh, gear_outline(design, name), back)
    if name != "flexible_spline":
        outer = _circle(gmsh, design.geometry.gears[name].outer_radius, back)
        _extrude(gmsh, [outer, teeth], width)
        return
    toothed = _extrude(gmsh, [teeth, _circle(gmsh, design.inner_radius, back)], width)
    if design.has_cup:
        gmsh.model.occ.fuse([toothed], [_wall(gmsh, design)])


def _extrude(gmsh: ModuleType, loops: Sequence[int], width: float) -> tuple[int, int]:
    """The solid between closed curves, the first outside; its dimension and tag."""
    surface = gmsh.model.occ.addPlaneSurface(list(loops))
    return _solid(gmsh.model.occ.extrude([(2, surface)], 0.0, 0.0, width))


def _solid(entities: Sequence[tuple[int, int]]) -> tuple[int, int]:
    return next(entity for entity in entities if entity[0] == 3)


def _circle(gmsh: ModuleType, radius: float, z: float) -> int:
    return gmsh.model.occ.addCurveLoop([gmsh.model.occ.addCircle(0.0, 0.0, z, radius)])


def closed_curve(gmsh: ModuleType, points: np.ndarray, normals: np.ndarray, z: float) -> list[int]:
    """Curves, one after the other, through the points (n, 2) of a closed curve with these normals
    (n, 2).

    They join with the exact tangent. OpenCASCADE integrates volumes with a limited number of points
    on a curve: one curve around a cam whose curvature jumps would give its volume to 0.3 % only.
    """
    occ = gmsh.model.occ
    tangents = np.column_stack([-normals[:, 1], normals[:, 0], np.zeros(len(normals))])
    if tangents[0, :2] @ (points[1] - points[0]) < 0.0:  # run through clockwise
        tangents = -tangents
    tags = [occ.addPoint(x, y, z) for x, y in points]
    ends = np.linspace(0, len(points), PIECES + 1).astype(int)
    tags, directions = [*tags, tags[0]], [*tangents.tolist(), tangents[0].tolist()]
    return [
        occ.addSpline(tags[first : last + 1], tangents=[*directions[first], *directions[last]])
        for first, last in pairwise(ends)
    ]


def _loop(gmsh: ModuleType, edges: Sequence[Edge], z: float) -> int:
    """A closed curve of edges, each of which begins where the one before ends."""
    occ, curves = gmsh.model.occ, []
    starts = [occ.addPoint(*edge.points[0], z) for edge in edges]
    for edge, start, end in zip(edges, starts, [*starts[1:], starts[0]], strict=True):
        if edge.center is not None:
            curves.append(occ.addCircleArc(start, occ.addPoint(*edge.center, z), end))
        elif len(edge.points) == 2:
            curves.append(occ.addLine(start, end))
        else:
            inside = [occ.addPoint(*point, z) for point in edge.points[1:-1]]
            curves.append(occ.addSpline([start, *inside, end]))
    return occ.addCurveLoop(curves)


class _Meridian:
    """Curves of a section in the plane of r and z, one after the other; `at` is the tag of the last
    point."""

    def __init__(self, gmsh: ModuleType, r: float, z: float) -> None:
        self.occ, self.place = gmsh.model.occ, (r, z)
        self.curves: list[int] = []
        self.first = self.at = self.occ.addPoint(r, 0.0, z)

    def _end(self, r: float, z: float) -> int:
        self.place = r, z
        return self.occ.addPoint(r, 0.0, z)

    def line(self, r: float, z: float) -> None:
        """A line to a point, unless it is the present one."""
        if np.hypot(r - self.place[0], z - self.place[1]) > SAME:
            start, self.at = self.at, self._end(r, z)
            self.curves.append(self.occ.addLine(start, self.at))

    def arc(self, r: float, z: float, center: tuple[float, float]) -> None:
        """The shorter arc to a point, or that of an ellipse with axes along r and z; none without a
        size."""
        arms = np.abs(np.subtract([self.place, (r, z)], center))
        sizes = arms.max(axis=0)
        if sizes.min() < SAME:  # a fillet without one of its sizes is a corner
            self.line(*center)
            self.line(r, z)
            return
        middle, start = self.occ.addPoint(center[0], 0.0, center[1]), self.at
        self.at = self._end(r, z)
        if np.ptp(np.hypot(*arms.T)) < SAME:
            self.curves.append(self.occ.addCircleArc(start, middle, self.at))
            return
        along = (1.0, 0.0) if sizes[0] > sizes[1] else (0.0, 1.0)
        major = self.occ.addPoint(center[0] + along[0], 0.0, center[1] + along[1])
        self.curves.append(self.occ.addEllipseArc(start, middle, major, self.at))

    def surface(self) -> int:
        """The closed section."""
        self.curves.append(self.occ.addLine(self.at, self.first))
        return self.occ.addPlaneSurface([self.occ.addCurveLoop(self.curves)])


def _wall(gmsh: ModuleType, design: DriveDesign) -> tuple[int, int]:
    """The wall of the cup behind the teeth: its section turned about the axis."""
    occ, wall, fillet = gmsh.model.occ, design.cup_sizes.wall, design.cup.back_fillet
    r_center, z_center = wall.center
    r_first = wall.outer.points[0, 1]
    section = _Meridian(gmsh, wall.inner.points[0, 1], wall.back)
    section.line(r_first + fillet, wall.back)
    if fillet:
        section.arc(r_first, wall.back + fillet, (r_first + fillet, wall.back + fillet))
    for _, end, center in wall.outer.pieces():
        _continue(section, wall.back, end, center)
    section.arc(r_center, wall.faces[1], (r_center, z_center))
    for z in wall.faces[::-1]:
        section.line(wall.edge, z)
    section.line(r_center, wall.faces[0])
    section.arc(wall.inner.points[-1, 1], z_center, (r_center, z_center))
    for end, _, center in wall.inner.pieces()[:0:-1]:
        _continue(section, wall.back, end, center)
    solid = occ.revolve([(2, section.surface())], 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0 * np.pi)
    return _solid(solid)


def _continue(section: _Meridian, back: float, end: Floats, center: Floats | None) -> None:
    """A piece of a wall's line to a distance from the back of the teeth and a radius."""
    distance, r = end
    if center is None:
        section.line(r, back + distance)
    else:
        section.arc(r, back + distance, (center[1], back + center[0]))
