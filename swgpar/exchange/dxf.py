"""DXF files of the tooth profiles and the cam: one sector of each gear, whole outlines, and the
cam, in mm."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.exchange.outlines import Edge, gear_outline
from swgpar.exchange.wall_lines import wall_lines
from swgpar.geometry.cams import cam_outlines


def write_dxf(design: DriveDesign, folder: Path) -> list[Path]:
    """Write drive.dxf with a layer for each gear, the wave generator and, if there is one, the
    housing; for a cup wall.dxf too.

    Call it on one rank.

    Raises InputError without the package ezdxf.
    """
    document = new_document()
    space = document.modelspace()
    for gear in design.gears:
        document.layers.add(gear)
        draw(space, gear_outline(design, gear), gear)
        outer = design.geometry.gears[gear].outer_radius
        rim = design.inner_radius if gear == "flexible_spline" else outer
        space.add_circle((0.0, 0.0), rim, dxfattribs={"layer": gear})
    if design.housing is not None:
        document.layers.add("housing")
        space.add_circle((0.0, 0.0), design.geometry.outer_radius, dxfattribs={"layer": "housing"})
    document.layers.add("wave_generator")
    for points in cam_outlines(design.cam()):  # within 0.02 µm of the curve
        space.add_lwpolyline(points.tolist(), close=True, dxfattribs={"layer": "wave_generator"})
    path = folder / "drive.dxf"
    document.saveas(path)
    return [path, *_write_wall(design, folder)]


def _write_wall(design: DriveDesign, folder: Path) -> list[Path]:
    """Write wall.dxf with both surfaces of a cup's wall, on the layers inner and outer, and both
    faces of closed end or flange, on end_far and end_near: distance from the back of the teeth, and
    radius."""
    lines = wall_lines(design)
    if not lines:
        return []
    document = new_document()
    for layer, one in lines.items():
        document.layers.add(layer)
        edges = [
            Edge(
                np.array([one.place(start), one.place(end)]),
                None if centre is None else one.place(centre),
            )
            for start, end, centre in one.line.pieces()
        ]
        draw(document.modelspace(), edges, layer)
    path = folder / "wall.dxf"
    document.saveas(path)
    return [path]


def new_document() -> Any:
    """An empty DXF document in mm; raises InputError without the package ezdxf."""
    try:
        from ezdxf.filemanagement import new
    except ImportError:
        raise InputError(
            "DXF files need the package ezdxf: pip install 'swgpar[exchange]'"
        ) from None
    return new("R2010", units=4)  # mm


def draw(space: Any, edges: Iterable[Edge], layer: str) -> None:
    """Lines, arcs and splines of an outline."""
    attributes = {"layer": layer}
    for edge in edges:
        if edge.center is None and len(edge.points) == 2:
            space.add_line(*edge.points.tolist(), dxfattribs=attributes)
        elif edge.center is None:
            space.add_cad_spline_control_frame(edge.points.tolist(), dxfattribs=attributes)
        else:
            arms = edge.points - edge.center
            angles = np.degrees(np.arctan2(arms[:, 1], arms[:, 0]))
            # an arc of DXF runs counter-clockwise
            if arms[0, 0] * arms[1, 1] - arms[0, 1] * arms[1, 0] < 0.0:
                angles = angles[::-1]
            radius = float(np.hypot(*arms[0]))
            space.add_arc(tuple(edge.center), radius, angles[0], angles[1], dxfattribs=attributes)
