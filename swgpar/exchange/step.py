"""STEP files of the flexible spline, the ring gear, its housing and the cam, by gmsh's OpenCASCADE
kernel.

The bodies are undeformed and without crowning and slope, which are below the accuracy of many CAD
programs. The axis is z, the mid-plane of the face width z = 0, the closed end of the cup at z > 0.
Units are mm.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from itertools import pairwise
from pathlib import Path
from types import ModuleType
from typing import Literal

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GearName
from swgpar.errors import OutputError
from swgpar.exchange.outlines import Edge, gear_outline
from swgpar.geometry.arrays import Floats
from swgpar.geometry.cams import cam_outlines
from swgpar.geometry.cup_wall import CupWall
from swgpar.geometry.disc_surface import TwoDiscSurface
from swgpar.meshing.gmsh_session import gmsh_model

END = b"END-ISO-10303-21;"
"""Last word of a STEP file."""

PIECES = 32
"""Curves around a cam."""

SAME = 1e-7
"""mm, distance below which the ends of edges are one point."""


OutlineStep = tuple[tuple[float, float], tuple[float, float] | None]
"""Next corner of an outline, and the center of the arc to it."""

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
            with _quiet(), suppress(Exception):  # Gmsh has no class for its errors
                gmsh.write(str(path))
        # OpenCASCADE does not always say that it cannot write
        if not path.exists() or not path.read_bytes().rstrip().endswith(END):
            raise OutputError(f"cannot write {path.name}: it is not complete, the disk may be full")
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
        surface, half = design.cam_surface(), 0.5 * design.wave_generator.face_width
        if isinstance(surface, TwoDiscSurface):
            for side in (1.0, -1.0):
                z, y = 0.5 * side * surface.distance - half, side * surface.cam.reach
                circle = gmsh.model.occ.addCircle(0.0, y, z, surface.cam.radius)
                _extrude(gmsh, [gmsh.model.occ.addCurveLoop([circle])], 2.0 * half)
            return
        for points in cam_outlines(design.cam()):
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
    teeth = _loop(gmsh, gear_outline(design, name), lambda xy: np.append(xy, back))
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


def _loop(gmsh: ModuleType, edges: Sequence[Edge], place: Callable[[Floats], Floats]) -> int:
    """A closed curve of edges, each of which begins where the one before ends. An arc whose ends
    have different distances from its center is that of an ellipse with axes along the coordinates.

    place : from the plane of the edges into space
    """
    occ, curves = gmsh.model.occ, []

    def point(at: Floats) -> int:
        return occ.addPoint(*place(at))

    starts = [point(edge.points[0]) for edge in edges]
    for edge, start, end in zip(edges, starts, [*starts[1:], starts[0]], strict=True):
        if edge.center is None and len(edge.points) == 2:
            curves.append(occ.addLine(start, end))
        elif edge.center is None:
            curves.append(occ.addSpline([start, *map(point, edge.points[1:-1]), end]))
        else:
            arms, middle = np.abs(edge.points[[0, -1]] - edge.center), point(edge.center)
            if np.ptp(np.hypot(*arms.T)) < SAME:
                curves.append(occ.addCircleArc(start, middle, end))
            else:
                along = np.eye(2)[arms.max(axis=0).argmax()]
                major = point(edge.center + along)
                curves.append(occ.addEllipseArc(start, middle, major, end))
    return occ.addCurveLoop(curves)


def _wall(gmsh: ModuleType, design: DriveDesign) -> tuple[int, int]:
    """The wall of the cup behind the teeth: its section turned about the axis."""
    occ = gmsh.model.occ
    section = _loop(gmsh, _wall_section(design), lambda rz: np.insert(rz, 1, 0.0))
    surface = occ.addPlaneSurface([section])
    return _solid(occ.revolve([(2, surface)], 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0 * np.pi))


def _wall_section(design: DriveDesign) -> list[Edge]:
    """The closed section in the plane of r and z, from the inner surface below the teeth."""
    wall, fillet = design.cup_sizes.wall, design.cup.back_fillet
    center, first, back = wall.center, wall.outer.points[0, 1], wall.back
    start = (wall.inner.points[0, 1], back)
    # ends of the edges with the centers of arcs; those of the lines of the wall are (s, r)
    path: list[OutlineStep] = [((first + fillet, back), None)]
    if fillet:
        path.append(((first, back + fillet), (first + fillet, back + fillet)))
    path += [_from_back(back, end, middle) for _, end, middle in wall.outer.pieces()]
    side = -1.0 if wall.outwards else 1.0

    def placed(point: tuple[float, float]) -> tuple[float, float]:
        return center[0] + side * point[0], center[1] + point[1]

    inner, outer = (
        [(placed(end), middle and placed(middle)) for end, middle in turn.steps()]
        for turn in wall.turns
    )
    path += outer
    faces = (wall.plate.inner, wall.plate.outer)  # the far one, and that towards the teeth
    of_outer, of_inner = faces[::-1] if wall.outwards else faces
    path += [_from_plate(wall, end, middle) for _, end, middle in of_outer.pieces()]
    path.append(_from_plate(wall, of_inner.points[-1], None))
    path += [_from_plate(wall, start, middle) for start, _, middle in of_inner.pieces()[::-1]]
    # the inner line is followed back to the wall
    ends = [(float(wall.inner.points[-1, 1]), center[1]), *(end for end, _ in inner)]
    path.append((ends[-1], None))
    path += [(end, middle) for end, (_, middle) in zip(ends[-2::-1], inner[::-1], strict=True)]
    path += [_from_back(back, end, middle) for end, _, middle in wall.inner.pieces()[:0:-1]]
    edges, place = [], start
    for end, middle in [*path, (start, None)]:
        if middle is not None and np.abs(np.subtract([place, end], middle)).max(0).min() < SAME:
            # a fillet without one of its sizes is a corner
            edges.append(Edge(np.array([place, middle])))
            place, middle = middle, None
        if middle is not None or np.hypot(*np.subtract(place, end)) > SAME:
            edges.append(Edge(np.array([place, end]), middle and np.array(middle)))
            place = end
    return edges


def _from_plate(wall: CupWall, end: Floats, middle: Floats | None) -> OutlineStep:
    """A way and a height on closed end or flange as r and z, also those of a center."""

    def placed(point: Floats) -> tuple[float, float]:
        r, z = wall.off_plate(*point).tolist()
        return r, z

    return placed(end), middle if middle is None else placed(middle)


def _from_back(back: float, end: Floats, middle: Floats | None) -> OutlineStep:
    """A distance from the back of the teeth and a radius as r and z, also those of a center."""
    return (end[1], back + end[0]), middle if middle is None else (middle[1], back + middle[0])
