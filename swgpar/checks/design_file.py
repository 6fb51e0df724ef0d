"""From a design file to a checked design."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from swgpar.checks.fit_checks import check_fit
from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GEARS, GearName
from swgpar.errors import InputError
from swgpar.input.curve_file import read_curve
from swgpar.input.toml_file import apply_overrides, read_toml, validate

GEAR_SECTIONS: tuple[GearName, ...] = (*GEARS, "dynamic_spline")
"""Sections that have a tooth profile."""


def make_drive(table: dict[str, Any]) -> DriveDesign:
    """A checked design from the content of its file; every problem is an InputError of one
    sentence."""
    design = validate(DriveDesign, with_points(table)).made_by(make_drive)
    check_fit(design)
    return design


def with_points(table: dict[str, Any]) -> dict[str, Any]:
    """The content of a design file with the points of files in place of their names: of the cam
    and of tooth profiles."""
    table = dict(table)
    if "wave_generator" in table:
        table["wave_generator"] = _read_points(table["wave_generator"], "wave_generator", True)
    for gear in GEAR_SECTIONS:
        section = table.get(gear)
        if isinstance(section, dict) and "profile" in section:
            profile = _read_points(section["profile"], f"{gear}.profile", False)
            table[gear] = {**section, "profile": profile}
    return table


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


def load_design(path: str | Path, overrides: Sequence[str] = ()) -> DriveDesign:
    """Read and check a design file.

    Parameters
    ----------
    path : str or Path
    overrides : sequence of str
        Values that replace those of the file, each written as ``section.key=value``.

    Raises InputError of one sentence for every problem.
    """
    return make_drive(apply_overrides(read_toml(path), overrides))
