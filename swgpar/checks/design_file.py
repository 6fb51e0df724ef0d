"""From a design file to a checked design."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from swgpar.checks.contour_checks import END_NAMES, WALL_NAMES
from swgpar.checks.fit_checks import check_fit
from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GEARS, GearName
from swgpar.errors import InputError
from swgpar.input.corner_file import Corner, read_corners
from swgpar.input.curve_file import read_curve
from swgpar.input.toml_file import validate

GEAR_SECTIONS: tuple[GearName, ...] = (*GEARS, "dynamic_spline")
"""Sections that have a tooth profile."""

AT_TEETH = 1e-6
"""mm behind the teeth up to which a point of a file is the beginning of the wall there."""

FILES = (
    ("contour", "inner", "outer"),
    ("end_contour", "end_far", "end_near"),
)
"""Lists of points in [cup] that files may take the place of: key, and beginnings of the keys of
both files and their layers."""


def make_drive(table: dict[str, Any]) -> DriveDesign:
    """A checked design from the content of its file; every problem is an InputError of one
    sentence."""
    design = validate(DriveDesign, with_points(table)).made_by(make_drive)
    check_fit(design)
    return design


def with_points(table: dict[str, Any]) -> dict[str, Any]:
    """The content of a design file with the points of files in place of their names: of the cam,
    of tooth profiles and of the wall."""
    table = dict(table)
    if "wave_generator" in table:
        table["wave_generator"] = _read_points(table["wave_generator"], "wave_generator", True)
    for gear in GEAR_SECTIONS:
        section = table.get(gear)
        if isinstance(section, dict) and "profile" in section:
            profile = _read_points(section["profile"], f"{gear}.profile", False)
            table[gear] = {**section, "profile": profile}
    if "cup" in table:
        table["cup"] = _read_wall(table["cup"])
    return table


def _read_wall(section: Any) -> Any:
    """A section [cup] with the contours of its files; one without them as it is."""
    if not isinstance(section, dict):
        return section
    for key, *sides in FILES:
        section = _read_contour(section, key, sides)
    return section


def _read_contour(section: dict[str, Any], key: str, sides: list[str]) -> dict[str, Any]:
    """A section [cup] with the points of both files in place of their names."""
    names = [f"{side}_{what}" for what in ("file", "layer") for side in sides]
    values = [section.get(name) for name in names]
    files, layers = values[:2], values[2:]
    if not all(isinstance(each, str | None) for each in values) or files == [None, None]:
        return section
    if None in files or section.get(key):
        raise InputError(
            f"cup.{names[0]} and cup.{names[1]} belong together: allowed are both without "
            f"cup.{key}, or neither"
        )
    lines = [read_corners(str(file), layer) for file, layer in zip(files, layers, strict=True)]
    points = _wall_points(*lines) if key == "contour" else _end_points(section, *lines)
    return {**{name: value for name, value in section.items() if name not in names}, key: points}


def _wall_points(inner: list[Corner], outer: list[Corner]) -> list[dict[str, float]]:
    """Points of the wall behind the back of the teeth."""
    behind = [[one for one in line if one.x > AT_TEETH] for line in (inner, outer)]
    return _contour_points(behind, WALL_NAMES)


def _end_points(
    section: dict[str, Any], far: list[Corner], near: list[Corner]
) -> list[dict[str, float]]:
    """Points of closed end or flange, from its fillet on."""
    lines = [
        sorted((Corner(one.y, one.x, one.rounding) for one in line), key=lambda one: one.x)
        for line in (far, near)
    ]
    points = _contour_points(lines, END_NAMES)
    return points if section.get("shape") == "hat" else points[::-1]


def _contour_points(lines: list[list[Corner]], names: Mapping[str, str]) -> list[dict[str, float]]:
    """Points of a contour by the corners of its two lines. names : of keys, by those of a wall"""
    keys = ("distance", "radius", "rounding")
    return [
        {names[key]: value for key, value in zip(keys, first, strict=True)}
        | {names[f"outer_{key}"]: value for key, value in zip(keys, second, strict=True)}
        for first, second in _paired(*lines)
    ]


def _read_points(section: Any, name: str, divided: bool) -> Any:
    """A section of the type "points" with the points of its file; any other one as it is.

    divided : whether straight lines get points; without them a flank has them as they are
    """
    if not isinstance(section, dict) or section.get("type") != "points":
        return section
    file, layer = section.get("file"), section.get("layer")
    if not isinstance(file, str) or not isinstance(layer, str | None):
        return section
    if section.get("points"):
        raise InputError(f"{name}.file and {name}.points are both given: allowed is one of them")
    points = read_curve(file, layer, divided=divided).tolist()
    kept = {key: value for key, value in section.items() if key not in ("file", "layer")}
    return {**kept, "points": points}


def _paired(one: list[Corner], other: list[Corner]) -> list[tuple[Corner, Corner]]:
    """Corners of two lines that belong together: in their order where they are as many, else at the
    same place, where a line without a corner gets a point."""
    lines = [one, other]
    if len(one) != len(other):
        places = sorted(corner.x for line in lines for corner in line)
        places = [x for k, x in enumerate(places) if k == 0 or x - places[k - 1] > AT_TEETH]
        lines = [[_corner_at(line, x) for x in places] for line in lines]
    return list(zip(*lines, strict=True))


def _corner_at(line: list[Corner], x: float) -> Corner:
    """The corner of a surface at a distance, mm, or a point on its straight side there."""
    near = min(line, key=lambda one: abs(one.x - x))
    if abs(near.x - x) <= AT_TEETH:
        return near
    distance, radius, _ = np.array(line).T
    return Corner(x, float(np.interp(x, distance, radius)), 0.0)
