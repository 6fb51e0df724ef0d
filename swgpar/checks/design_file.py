"""From a design file to a checked design."""

from __future__ import annotations

from typing import Any

import numpy as np

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

WALL_FILES = ("inner_file", "outer_file", "inner_layer", "outer_layer")
"""Keys of [cup] that `contour` takes the place of."""


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
    """A section [cup] with the contour of its files; one without them as it is."""
    if not isinstance(section, dict):
        return section
    files = [section.get(f"{side}_file") for side in ("inner", "outer")]
    layers = [section.get(f"{side}_layer") for side in ("inner", "outer")]
    texts = all(isinstance(each, str | None) for each in (*files, *layers))
    if not texts or files == [None, None]:
        return section
    if None in files or section.get("contour"):
        raise InputError(
            "cup.inner_file and cup.outer_file belong together: allowed are both without "
            "cup.contour, or neither"
        )
    lines = [read_corners(str(file), layer) for file, layer in zip(files, layers, strict=True)]
    inner, outer = _paired(*lines)
    contour = [
        {
            "distance": one.x,
            "radius": one.y,
            "outer_distance": other.x,
            "outer_radius": other.y,
            "rounding": one.rounding,
            "outer_rounding": other.rounding,
        }
        for one, other in zip(inner, outer, strict=True)
    ]
    kept = {key: value for key, value in section.items() if key not in WALL_FILES}
    return {**kept, "contour": contour}


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


def _paired(inner: list[Corner], outer: list[Corner]) -> tuple[list[Corner], list[Corner]]:
    """Corners of both surfaces behind the teeth that belong together: in their order where they are
    as many, else at the same distance, where a surface without a corner gets a point."""
    behind = [[one for one in line if one.x > AT_TEETH] for line in (inner, outer)]
    if len(behind[0]) != len(behind[1]):
        places = sorted(one.x for line in behind for one in line)
        places = [x for k, x in enumerate(places) if k == 0 or x - places[k - 1] > AT_TEETH]
        behind = [[_corner_at(line, x) for x in places] for line in (inner, outer)]
    return behind[0], behind[1]


def _corner_at(line: list[Corner], x: float) -> Corner:
    """The corner of a surface at a distance, mm, or a point on its straight side there."""
    near = min(line, key=lambda one: abs(one.x - x))
    if abs(near.x - x) <= AT_TEETH:
        return near
    distance, radius, _ = np.array(line).T
    return Corner(x, float(np.interp(x, distance, radius)), 0.0)
