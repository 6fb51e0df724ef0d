"""Corners of a line of straight pieces and the arcs that round them, from a CSV or DXF file.

An arc between two straight lines rounds the corner at which their tangents meet. A CSV file has the
corners, and with a third number on a line the radius that rounds it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from swgpar.errors import InputError
from swgpar.input.curve_file import chain_of, dxf_entities, read_rows

STRAIGHT = 1e-6
"""Angle (rad) between two lines that make one."""

TANGENT = 1e-3
"""Angle (rad) between a line and the arc that goes on from it, at most."""


class Corner(NamedTuple):
    """A corner at x, y with the radius that rounds it; mm for DXF files, else as in the file."""

    x: float
    y: float
    rounding: float


class _Piece(NamedTuple):
    """A straight line, or an arc with a radius, between two points x + i y; directions of its
    tangents."""

    start: complex
    end: complex
    first: complex
    last: complex
    radius: float

    def reversed(self) -> _Piece:
        return _Piece(self.end, self.start, -self.last, -self.first, self.radius)


def read_corners(path: str | Path, layer: str | None = None) -> list[Corner]:
    """Corners of an open line by increasing x, its ends among them.

    layer : of a DXF file; without it everything in the model space

    Raises InputError for what cannot be read, with the place.
    """
    path = Path(path)
    if path.suffix.lower() != ".dxf":
        rows = read_rows(path, layer, {2, 3})
        corners = [Corner(row[0], row[1], row[2] if len(row) > 2 else 0.0) for row in rows]
        return corners if corners[0].x <= corners[-1].x else corners[::-1]
    entities, scale = dxf_entities(path, layer)
    parts: list[Any] = []
    for entity in entities:
        polyline = entity.dxftype() in ("LWPOLYLINE", "POLYLINE")
        parts += entity.virtual_entities() if polyline else [entity]
    pieces = _in_order([_piece(part, scale, path) for part in parts], path)
    corners = [Corner(pieces[0].start.real, pieces[0].start.imag, 0.0)]
    for k, piece in enumerate(pieces):
        if piece.radius:
            corners.append(_rounded(pieces, k, path))
        elif k + 1 == len(pieces) or not (
            pieces[k + 1].radius or abs(np.angle(pieces[k + 1].first / piece.last)) < STRAIGHT
        ):
            corners.append(Corner(piece.end.real, piece.end.imag, 0.0))
    return corners


def _piece(part: Any, scale: float, path: Path) -> _Piece:
    """A line or arc of a DXF file."""
    kind = part.dxftype()
    if kind == "LINE":
        start, end = (scale * complex(p.x, p.y) for p in (part.dxf.start, part.dxf.end))
        along = (end - start) / abs(end - start)
        return _Piece(start, end, along, along, 0.0)
    if kind == "ARC":
        start, end = (scale * complex(p.x, p.y) for p in (part.start_point, part.end_point))
        centre, radius = (
            scale * complex(part.dxf.center.x, part.dxf.center.y),
            scale * part.dxf.radius,
        )
        first, last = (1j * (point - centre) / radius for point in (start, end))
        return _Piece(start, end, first, last, float(radius))
    raise InputError(
        f"{path} has a curve of the kind {kind}: allowed are straight lines, and arcs between them"
    )


def _in_order(pieces: list[_Piece], path: Path) -> list[_Piece]:
    """The pieces end to end, by increasing x."""
    order = chain_of([(piece.start, piece.end) for piece in pieces], path)
    chain = [pieces[k].reversed() if is_reversed else pieces[k] for k, is_reversed in order]
    if chain[0].start.real > chain[-1].end.real:
        chain = [piece.reversed() for piece in chain[::-1]]
    return chain


def _rounded(pieces: list[_Piece], k: int, path: Path) -> Corner:
    """The corner that the arc `k` rounds."""
    arc, beside = pieces[k], [*pieces[k - 1 : k][-1:], *pieces[k + 1 : k + 2]]
    bends = [np.pi]
    if 0 < k < len(pieces) - 1 and not any(piece.radius for piece in beside):
        turns = (arc.first / beside[0].last, beside[1].first / arc.last)
        bends = [float(abs(np.angle(turn))) for turn in turns]
    if max(bends) > TANGENT:
        x, y = arc.start.real, arc.start.imag
        raise InputError(
            f"{path}: the arc from ({x:.6g}, {y:.6g}) mm is not tangent to a straight line on both "
            "sides: allowed are arcs that round corners"
        )
    half = 0.5 * float(np.angle(arc.last / arc.first))
    corner = arc.start + arc.first * arc.radius * abs(np.tan(half))
    return Corner(corner.real, corner.imag, arc.radius)
