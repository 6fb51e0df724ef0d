"""From a design file to a checked design."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from swgpar.checks.fit_checks import check_fit
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.input.curve_file import read_curve
from swgpar.input.toml_file import apply_overrides, read_toml, validate


def make_drive(table: dict[str, Any]) -> DriveDesign:
    """A checked design from the content of its file; every problem is an InputError of one
    sentence."""
    design = validate(DriveDesign, with_cam_points(table)).made_by(make_drive)
    check_fit(design)
    return design


def with_cam_points(table: dict[str, Any]) -> dict[str, Any]:
    """The content of a design file with the points of the cam's file in place of its name."""
    cam = table.get("wave_generator")
    if not isinstance(cam, dict) or cam.get("type") != "points":
        return table
    file, layer = cam.get("file"), cam.get("layer")
    if not isinstance(file, str) or not isinstance(layer, str | None):
        return table
    if cam.get("points"):
        raise InputError(
            "wave_generator.file and wave_generator.points are both given: allowed is one of them"
        )
    points = read_curve(file, layer).tolist()
    kept = {key: value for key, value in cam.items() if key not in ("file", "layer")}
    return {**table, "wave_generator": {**kept, "points": points}}


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
