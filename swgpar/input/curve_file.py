"""Points of a plane curve from a CSV or DXF file: of cams, teeth and walls.

CSV: two numbers on a line, separated by a comma, a semicolon, a tab or spaces. With semicolons the
decimal sign may be a comma. What follows # is left out, and so is one line of words at the top.

DXF: lines, arcs, circles, ellipses, splines and polylines of the model space, or of one layer,
joined end to end. Lengths have the unit of the file, mm without one. The corners of a polyline
without arcs are taken as points of the curve. Other straight lines are divided.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence, Sized
from pathlib import Path
from typing import Any

import numpy as np

from swgpar.errors import InputError
from swgpar.input.quantities import show
from swgpar.input.regular_file import read_regular, require_regular

MOST_POINTS = 100_000
"""Points of a file, at most."""

SAGITTA = 1e-5
"""Largest distance (mm) of a curve of a DXF file from the chords between its points."""

JOIN = 1e-3
"""Largest gap (mm) between the ends of two curves that are joined."""

DIVISIONS = 2000
"""Parts of the length of a curve into which straight lines are divided."""

KINDS = ("LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "LWPOLYLINE", "POLYLINE")


def read_curve(path: str | Path, layer: str | None = None, *, divided: bool = True) -> np.ndarray:
    """Points (n, 2) of a curve in their order; a closed curve does not repeat the first one.

    Numbers of a CSV file are as they stand there; those of a DXF file are mm.

    layer : of a DXF file; without it everything in the model space
    divided : whether straight lines of a DXF file get points between their ends

    Raises InputError for what cannot be read, with the line or the place.
    """
    path = Path(path)
    if path.suffix.lower() == ".dxf":
        points = _of_dxf(path, layer, divided)
    else:
        points = np.array(read_rows(path, layer, {2}))
    if len(points) > 1 and np.hypot(*(points[0] - points[-1])) <= 1e-9 * np.abs(points).max():
        points = points[:-1]
    _require_few(points, path)
    return points


def _require_few(points: Sized, path: Path) -> None:
    if len(points) > MOST_POINTS:
        raise InputError(f"{path} has {len(points)} points: allowed up to {MOST_POINTS}")


def read_rows(path: Path, layer: str | None, lengths: Collection[int]) -> list[list[float]]:
    """Numbers of the lines of a CSV file, as they stand there.

    layer : of a DXF file, which is refused;  lengths : how many numbers a line may have

    Raises InputError for what cannot be read, with the line.
    """
    if path.suffix.lower() not in (".csv", ".txt", ".dat"):
        raise InputError(f"{path} cannot be read as a curve: allowed .csv, .txt, .dat and .dxf")
    if layer is not None:
        raise InputError(f"layer = {show(layer)} has no meaning with {path}: allowed for DXF")
    try:
        text = read_regular(path).decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is no UTF-8 text"
        raise InputError(f"{path} cannot be read: {reason}") from None
    points: list[list[float]] = []
    words = 0
    for number, line in enumerate(text.splitlines(), 1):
        content = line.split("#")[0].strip()
        if not content:
            continue
        try:
            values = numbers_of(content)
        except ValueError:
            words += 1
            if points or words > 1:
                raise _bad_line(path, number, line, lengths) from None
            continue
        if len(values) not in lengths or not np.isfinite(values).all():
            raise _bad_line(path, number, line, lengths)
        points.append(values)
    if not points:
        raise InputError(f"{path} has no points: allowed are lines of {_counted(lengths)}")
    _require_few(points, path)
    return points


def numbers_of(line: str) -> list[float]:
    """Numbers of a line, with one kind of separator: semicolons, commas, or tabs and spaces; with
    semicolons the decimal sign may be a comma. Raises ValueError for anything else."""
    if ";" in line:
        parts = line.strip("; \t").replace(",", ".").split(";")
    elif "," in line:
        parts = line.strip(", \t").split(",")
    else:
        parts = line.split()
    return [float(part) for part in parts]


def _bad_line(path: Path, number: int, line: str, lengths: Collection[int]) -> InputError:
    allowed = _counted(lengths)
    return InputError(f"{path}, line {number}: {show(line)} is no point: allowed are {allowed}")


def _counted(lengths: Collection[int]) -> str:
    return f"{' or '.join({2: 'two', 3: 'three'}[length] for length in sorted(lengths))} numbers"


def dxf_entities(path: Path, layer: str | None) -> tuple[list[Any], float]:
    """Lines, arcs, splines and polylines of a DXF file, of one layer or all, and mm in its unit."""
    try:
        from ezdxf.enums import InsertUnits
        from ezdxf.filemanagement import readfile
        from ezdxf.lldxf.const import DXFError
        from ezdxf.units import conversion_factor
    except ImportError:
        raise InputError(
            "a DXF file needs the package ezdxf: pip install 'swgpar[exchange]'"
        ) from None
    try:
        require_regular(path)
        document = readfile(path)
        scale = 1.0
        if document.units:
            scale = conversion_factor(InsertUnits(document.units), InsertUnits.Millimeters)
    except OSError as error:
        reason = error.strerror or "it is no DXF file"
        raise InputError(f"{path} cannot be read: {reason}") from None
    except (DXFError, ValueError) as error:
        raise InputError(f"{path} cannot be read: {' '.join(str(error).split())}") from None
    entities = [one for one in document.modelspace() if one.dxftype() in KINDS]
    layers = sorted({one.dxf.layer for one in entities})
    if layer is not None:
        entities = [one for one in entities if one.dxf.layer == layer]
    if not entities:
        names = ", ".join(map(show, layers)) or "a file with lines, arcs, splines or polylines"
        raise InputError(
            f"{path} has no curve{'' if layer is None else f' on the layer {show(layer)}'}: "
            f"allowed {names}"
        )
    return entities, scale


def _of_dxf(path: Path, layer: str | None, divided: bool) -> np.ndarray:
    entities, scale = dxf_entities(path, layer)
    curve = _joined([scale * _points_of(entity, SAGITTA / scale) for entity in entities], path)
    corners_only = all(getattr(entity, "has_arc", True) is False for entity in entities)
    return _divided(curve) if divided and not corners_only else curve


def _points_of(entity: Any, sagitta: float) -> np.ndarray:
    """Points (n, 2) of an entity, in the unit of the file."""
    kind = entity.dxftype()
    if kind in ("LWPOLYLINE", "POLYLINE"):
        return _of_polyline(entity, sagitta)
    if kind == "LINE":
        return np.array([(p.x, p.y) for p in (entity.dxf.start, entity.dxf.end)])
    return np.array([(p.x, p.y) for p in entity.flattening(sagitta)])


def _of_polyline(entity: Any, sagitta: float) -> np.ndarray:
    """Its corners, or points of its lines and arcs."""
    if entity.has_arc:
        parts = [_points_of(part, sagitta) for part in entity.virtual_entities()]
        return np.concatenate([parts[0], *(part[1:] for part in parts[1:])])
    of_corners = (
        entity.vertices_in_wcs if entity.dxftype() == "LWPOLYLINE" else entity.points_in_wcs
    )
    corners = np.array([(p.x, p.y) for p in of_corners()])
    return np.concatenate([corners, corners[:1]]) if entity.is_closed else corners


def _divided(curve: np.ndarray) -> np.ndarray:
    """The curve with its long straight lines divided."""
    step = np.hypot(*np.diff(curve, axis=0).T)
    parts = np.maximum(np.ceil(step * DIVISIONS / max(step.sum(), 1e-300)), 1).astype(int)
    pieces = [
        start + (end - start) * (np.arange(count) / count)[:, None]
        for start, end, count in zip(curve[:-1], curve[1:], parts, strict=True)
    ]
    return np.concatenate([*pieces, curve[-1:]])


def chain_of(ends: Sequence[tuple[complex, complex]], path: Path) -> list[tuple[int, bool]]:
    """Numbers of curves that meet end to end, in their order, and whether each is reversed.

    ends : x + i y (mm) of each, in any order and direction;  path : of their file, for messages
    """
    chain, left, (begin, end) = [(0, False)], list(range(1, len(ends))), ends[0]
    while left:
        gaps = np.abs(np.array([end, begin])[:, None, None] - np.array([ends[k] for k in left]))
        at, k, side = np.unravel_index(gaps.argmin(), gaps.shape)
        if gaps[at, k, side] > JOIN:
            tip = (end, begin)[at]
            raise InputError(
                f"{path} has more than one curve: the nearest end of another one is "
                f"{gaps[at, k, side]:.3g} mm away from the end at ({tip.real:.5g}, {tip.imag:.5g}) "
                f"mm, allowed up to {JOIN:g} mm; name one layer"
            )
        number = left.pop(k)
        if at == 0:
            chain.append((number, bool(side == 1)))
            end = ends[number][1 - side]
        else:
            chain.insert(0, (number, bool(side == 0)))
            begin = ends[number][1 - side]
    return chain


def _joined(pieces: list[np.ndarray], path: Path) -> np.ndarray:
    """One curve of pieces that meet end to end; where two meet, it has the point of that which is
    nearer to the first one of the file."""
    chain = chain_of([(complex(*piece[0]), complex(*piece[-1])) for piece in pieces], path)
    parts = [pieces[k][::-1] if is_reversed else pieces[k] for k, is_reversed in chain]
    first = chain.index((0, False))
    before, after = parts[:first], parts[first + 1 :]
    joined = [*(part[:-1] for part in before), parts[first], *(part[1:] for part in after)]
    return np.concatenate(joined)
