"""The deformed drive as a view that turns in a page of HTML, without a network: the surface and a
drawer in WebGL.

All sectors of a body are congruent: the triangles of one are stored, and places, displacements and
stresses of all. Places have 16 bits, stresses 8.
"""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from swgpar.presentation.deformed_figures import colour_limit

if TYPE_CHECKING:
    from swgpar.design.sections import GearName
    from swgpar.drive_results.drive_data import DriveData

MOST_NODES = 400_000
"""Nodes of the surface up to which it goes into a report; it then has some 7 MB."""

HEX_FACES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]

SCRIPT = "presentation/scene.js"


@dataclass(frozen=True)
class Scene:
    """content : what the drawer reads;  limit : end of the colour range, MPa"""

    content: dict[str, Any]
    bodies: list[str]
    limit: float


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
    """The view of the last increment with fields; None without fields, or where it would be too
    large.

    Reads files only: one rank may call it alone.
    """
    if not result.increments:
        return None
    stresses = {body: result.field("vm", body=body) for body in result.gears}
    limit = colour_limit(*stresses.values())
    bodies = [_body(result, body, stresses[body] / limit) for body in result.gears]
    if sum(body.pop("nodes") for body in bodies) > MOST_NODES:
        return None
    low = np.min([body["low"] for body in bodies], axis=0)
    high = np.max([np.add(body["low"], body["span"]) for body in bodies], axis=0)
    radius = float(np.abs([low[:2], high[:2]]).max())
    content = {
        "bodies": bodies,
        "copies": result.summary.copies,
        "plane": result.is_plane,
        "radius": radius,
        "centre": [0.0, 0.0, float(0.5 * (low[2] + high[2]))],
    }
    return Scene(content, [body.replace("_", " ") for body in result.gears], limit)


def _body(result: DriveData, body: GearName, values: np.ndarray) -> dict[str, Any]:
    """Surface of a body in the form that the drawer reads."""
    points, cells = result.mesh(body)
    drive = result.summary.design.drive
    teeth = drive.teeth_rg if body == "ring_gear" else drive.teeth_fs
    per_sector = result.summary.bodies[body].elements_whole // teeth
    sectors = len(cells) // per_sector
    stride = len(points) // sectors
    triangles = sector_surface(points[:stride], cells[:per_sector])
    used, corners = np.unique(triangles, return_inverse=True)
    chosen = (used + stride * np.arange(sectors)[:, None]).ravel()
    place, shift = points[chosen], result.field("displacement", body=body)[chosen]
    low, span = place.min(axis=0), np.maximum(np.ptp(place, axis=0), 1e-9)
    reach = np.maximum(np.abs(shift).max(axis=0), 1e-9)
    return {
        "nodes": len(chosen),
        "sectors": sectors,
        "stride": len(used),
        "low": low.tolist(),
        "span": span.tolist(),
        "reach": reach.tolist(),
        "points": _text(np.rint((place - low) / span * 65535.0), "<u2"),
        "shifts": _text(np.rint(shift / reach * 32767.0), "<i2"),
        "values": _text(np.rint(np.clip(values[chosen], 0.0, 1.0) * 255.0), "<u1"),
        "faces": _text(corners.reshape(-1), "<u4"),
    }


def _text(array: np.ndarray, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(array, dtype=kind).tobytes()).decode()
