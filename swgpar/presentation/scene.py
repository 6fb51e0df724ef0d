"""The deformed drive as a view that turns in a page of HTML, without a network: meshes, fields of
several increments, and a drawer in WebGL.

All sectors of a body are congruent: nodes, cells and triangles of the surface of one are stored.
Displacements, stresses and pressures are those of all nodes, with 16 bits each.
"""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from swgpar.load.load_states import Stage
from swgpar.presentation.deformed_figures import colour_limit
from swgpar.presentation.scene_solids import ball_solids, cam_solid, turned
from swgpar.results.field_sources import FieldSource

if TYPE_CHECKING:
    from swgpar.drive_results.drive_data import DriveData
    from swgpar.presentation.scene_solids import RigidSolid

LARGEST = 6_000_000
"""Bytes of the view in a report. Increments beyond them are left out."""

HEX_FACES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]

SCRIPTS = ("presentation/section_cut.js", "presentation/scene.js")

COLOURED = {
    "vm": "von Mises stress, nodal averages, MPa",
    "pressure": "contact pressure on the flexible spline, nodal averages, MPa",
}
"""Fields that the view shows, with the titles of their ranges of colours."""

WORD, LETTERS = 2, 4.0 / 3.0
"""Bytes of a stored value, and letters of a byte in the page."""


@dataclass(frozen=True)
class Scene:
    """What the view shows.

    content : what the drawer reads;  bodies, colours : names of what can be chosen
    increments : that can be chosen;  left_out : other increments with fields
    """

    content: dict[str, Any]
    bodies: list[str]
    colours: list[str]
    increments: int
    left_out: int


@dataclass(frozen=True)
class StoredSector:
    """A modelled body of congruent sectors.

    points : (n, 3) mm, of the first sector;  cells : (m, 8) of it;  sectors : that are modelled
    """

    points: np.ndarray
    cells: np.ndarray
    sectors: int


def sector_surface(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Triangles (n, 3) of the surface of one sector, without the sides where it meets its
    neighbours.

    points : (n, 3) mm, of the sector;  cells : (m, 8) hexahedra in VTK order
    """
    faces = cells[:, HEX_FACES].reshape(-1, 4)
    corners = np.sort(faces, axis=1)
    _, first, count = np.unique(corners, axis=0, return_index=True, return_counts=True)
    outside = faces[first[count == 1]]
    axis = points[:, :2].mean(axis=0)
    angle = np.arctan2(points[:, :2] @ [-axis[1], axis[0]], points[:, :2] @ axis)
    # the sides lie in planes through the axis, at the smallest and the largest angle
    ends = np.array([[angle.min()], [angle.max()]])
    off_ends = np.abs(angle[outside][:, None] - ends) >= 1e-6 * np.ptp(angle)
    quads = outside[off_ends.any(axis=2).all(axis=1)]
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def scene(result: DriveData) -> Scene | None:
    """The view of increments with fields; None without fields, or where one increment is too large.

    Reads files only: one rank may call it alone.
    """
    source = result.fields
    if source is None or not source.increments:
        return None
    meshes = {body: _sector_mesh(result, source, body) for body in result.summary.bodies}
    fields = {body: source.names(body, source.increments[-1]) for body in meshes}
    values = sum(
        mesh.sectors * len(mesh.points) * (3 + len(COLOURED.keys() & fields[body]))
        for body, mesh in meshes.items()
    )
    count = int(LARGEST / (WORD * LETTERS * values))
    if count < 1:
        return None
    known = source.increments
    chosen = np.unique(np.rint(np.linspace(len(known) - 1, 0, min(count, len(known)))).astype(int))
    numbers = [known[k] for k in chosen]
    solids = _solids(result, numbers[-1])
    places = np.concatenate([mesh.points for mesh in meshes.values()])
    low, high = float(places[:, 2].min()), float(places[:, 2].max())
    middle = [0.0, 0.0, 0.5 * (low + high)]
    content: dict[str, Any] = {
        "bodies": [
            *(_body(body, mesh, result.summary.copies) for body, mesh in meshes.items()),
            *(_rigid_body(name, solid) for name, solid in solids.items()),
        ],
        "increments": [
            {
                "label": _label(result, number),
                "turn": result.cam_angle(number),
                "bodies": [
                    *(_fields(source, body, number, fields[body]) for body in meshes),
                    *_solid_points(result, number, list(solids)),
                ],
            }
            for number in numbers
        ],
        "colours": [
            {"title": title, "limit": _limit(source, list(meshes), name, numbers[-1])}
            for name, title in COLOURED.items()
        ],
        "plane": result.is_plane,
        "radius": float(np.linalg.norm(places - middle, axis=1).max()),
        "moved": max(_largest_shift(source, body, numbers[-1]) for body in meshes),
        "ends": [low, high],
    }
    names = [body["name"] for body in content["bodies"]]
    return Scene(content, names, list(COLOURED.values()), len(numbers), len(known) - len(numbers))


def _sector_mesh(result: DriveData, source: FieldSource, body: str) -> StoredSector:
    points, cells = source.mesh(body)
    drive = result.summary.design.drive
    teeth = drive.teeth_rg if body in ("ring_gear", "housing") else drive.teeth_fs
    sectors = teeth // result.summary.copies
    return StoredSector(points[: len(points) // sectors], cells[: len(cells) // sectors], sectors)


def _body(name: str, mesh: StoredSector, copies: int) -> dict[str, Any]:
    return {
        "name": name.replace("_", " "),
        "sectors": mesh.sectors,
        "copies": copies,
        "points": _text(mesh.points, "<f4"),
        "faces": _text(sector_surface(mesh.points, mesh.cells), "<u4"),
        "cells": _text(mesh.cells, "<u4"),
    }


def _rigid_body(name: str, solid: RigidSolid) -> dict[str, Any]:
    return {
        "name": name,
        "sectors": 1,
        "copies": 1,
        "faces": _text(solid.triangles, "<u4"),
        "cells": _text(solid.cells, "<u4"),
    }


def _limit(source: FieldSource, bodies: list[str], name: str, number: int) -> float:
    """End of the range of colours of a field at an increment, of the nodes where it is not 0."""
    having = [body for body in bodies if name in source.names(body, number)]
    values = np.concatenate([source.read(body, name, number) for body in having])
    return colour_limit(values[values > 0.0]) if (values > 0.0).any() else 1.0


def _largest_shift(source: FieldSource, body: str, number: int) -> float:
    shift = source.read(body, "displacement", number)
    return float(np.linalg.norm(shift, axis=1).max())


def _fields(source: FieldSource, body: str, number: int, names: tuple[str, ...]) -> dict[str, Any]:
    """Displacements and coloured fields of a body; null for a field that it does not have."""
    shift = source.read(body, "displacement", number)
    reach = np.maximum(np.abs(shift).max(axis=0), 1e-9)
    values: list[dict[str, Any] | None] = []
    for name in COLOURED:
        if name not in names:
            values.append(None)
            continue
        field = source.read(body, name, number)
        most = max(float(field.max()), 1e-9)
        stored = np.rint(np.clip(field / most, 0.0, 1.0) * 65535.0)
        values.append({"most": most, "values": _text(stored, "<u2")})
    shifts = _text(np.rint(shift / reach * 32767.0), "<i2")
    return {"reach": reach.tolist(), "shifts": shifts, "values": values}


def _solids(result: DriveData, number: int) -> dict[str, RigidSolid]:
    """Rigid bodies by name, in the frame of the cam."""
    parts = result.summary.design.rigid_parts
    balls = ball_solids(parts, result.balls, number - 1) if result.balls else None
    return {"wave generator": cam_solid(parts)} | ({"balls": balls} if balls else {})


def _solid_points(result: DriveData, number: int, names: list[str]) -> list[dict[str, Any] | None]:
    """Places of the rigid bodies; null while the cam is not yet in place."""
    if result.history["step"][number - 1] < Stage.ENGAGE:
        return [None] * len(names)
    solids, angle = _solids(result, number), result.cam_angle(number)
    return [
        {"points": _text(turned(solids[name], angle), "<f4")} if name in solids else None
        for name in names
    ]


def _label(result: DriveData, number: int) -> str:
    angle = result.history["wg_angle_deg"][number - 1]
    return f"increment {number}, wave generator at {angle:.4g}°"


def _text(array: np.ndarray, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(array, dtype=kind).tobytes()).decode()
