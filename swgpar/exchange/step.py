"""STEP files of the flexible spline, the ring gear, its housing and the cam, by gmsh's OpenCASCADE kernel.

The bodies are undeformed and without crowning and slope, which are below the accuracy of many CAD programs. The axis is
z, the mid-plane of the face width z = 0, the closed end of the cup at z > 0. Units are mm.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GEARS
from swgpar.exchange.outlines import Edge, cam_outlines, gear_outline
from swgpar.meshing.gmsh_session import gmsh_model

PIECES = 32
"""Curves around a cam."""

SAME = 1e-7
"""mm, distance below which the ends of edges are one point."""


def write_step(design: DriveDesign, folder: Path) -> list[Path]:
    """Write flexible_spline.step, ring_gear.step, wave_generator.step and of a drive with one housing.step.

    Call it on one rank.
    """
    paths = []
    for name in (*GEARS, "wave_generator", *(["housing"] if design.housing else [])):
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


def _build(gmsh: ModuleType, design: DriveDesign, name: str) -> None:
    """The solid of a body in the present model."""
    width = design.drive.face_width
    if name == "wave_generator":
        half = 0.5 * design.wave_generator.face_width
        for points in cam_outlines(design):
            curves = closed_curve(gmsh, points, design.cam().evaluate(points)[1], -half)
            _extrude(gmsh, [gmsh.model.occ.addCurveLoop(curves)], 2.0 * half)
        return
    back = -0.5 * width
    if name == "housing":
        _extrude(
            gmsh, [_circle(gmsh, radius, back) for radius in (design.outer_radius, design.ring_outer_radius)], width
        )
        return
    teeth = _loop(gmsh, gear_outline(design, name), back)
    if name == "ring_gear":
        _extrude(gmsh, [_circle(gmsh, design.ring_outer_radius, back), teeth], width)
        return
    toothed = _extrude(gmsh, [teeth, _circle(gmsh, design.inner_radius, back)], width)
    if design.drive.model == "cup":
        gmsh.model.occ.fuse([toothed], [_wall(gmsh, design)])


def _extrude(gmsh: ModuleType, loops: Sequence[int], width: float) -> tuple[int, int]:
    """The solid between closed curves, the first outside; its dimension and tag."""
    surface = gmsh.model.occ.addPlaneSurface(list(loops))
    return next(entity for entity in gmsh.model.occ.extrude([(2, surface)], 0.0, 0.0, width) if entity[0] == 3)


def _circle(gmsh: ModuleType, radius: float, z: float) -> int:
    return gmsh.model.occ.addCurveLoop([gmsh.model.occ.addCircle(0.0, 0.0, z, radius)])


def closed_curve(gmsh: ModuleType, points: np.ndarray, normals: np.ndarray, z: float) -> list[int]:
    """Curves, one after the other, through the points (n, 2) of a closed curve with these normals (n, 2).

    They join with the exact tangent. OpenCASCADE integrates volumes with a limited number of points on a curve: one
    curve around a cam whose curvature jumps would give its volume to 0.3 % only.
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
            curves.append(occ.addSpline([start, *(occ.addPoint(*p, z) for p in edge.points[1:-1]), end]))
    return occ.addCurveLoop(curves)


def _wall(gmsh: ModuleType, design: DriveDesign) -> tuple[int, int]:
    """The wall of the cup behind the teeth: its section turned about the axis."""
    occ, cup, thickness, inner = gmsh.model.occ, design.cup, design.cup_thickness, design.inner_radius
    back = 0.5 * design.drive.face_width
    end, r_mid = back + cup.length, inner + thickness - cup.fillet_radius
    z_mid = end - cup.fillet_radius

    def point(r: float, z: float) -> int:
        return occ.addPoint(r, 0.0, z)

    center = point(r_mid, z_mid)
    wall, fillet = inner + thickness, cup.back_fillet
    outer = [point(wall, back + fillet), point(wall, z_mid), point(r_mid, end)]
    bore = [point(cup.inner_radius, end), point(cup.inner_radius, end - thickness)]
    curves = [occ.addLine(outer[0], outer[1]), occ.addCircleArc(outer[1], center, outer[2])]
    curves += [occ.addLine(outer[2], bore[0]), occ.addLine(bore[0], bore[1])]
    if cup.fillet_radius - thickness > SAME:
        inside = [point(r_mid, end - thickness), point(inner, z_mid)]
        curves += [occ.addLine(bore[1], inside[0]), occ.addCircleArc(inside[0], center, inside[1])]
        last = inside[1]
    else:
        last = center
        curves.append(occ.addLine(bore[1], center))
    first = point(inner, back)
    start = outer[0] if fillet == 0.0 else point(wall + fillet, back)
    curves += [occ.addLine(last, first), occ.addLine(first, start)]
    if fillet:
        curves.append(occ.addCircleArc(start, point(wall + fillet, back + fillet), outer[0]))
    section = occ.addPlaneSurface([occ.addCurveLoop(curves)])
    solid = occ.revolve([(2, section)], 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0 * np.pi)
    return next(entity for entity in solid if entity[0] == 3)
