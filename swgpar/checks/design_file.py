"""From a design file to a checked design."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from swgpar.checks.fit_checks import check_fit
from swgpar.design.drive_design import DriveDesign
from swgpar.input.toml_file import apply_overrides, read_toml, validate


def make_drive(table: dict[str, Any]) -> DriveDesign:
    """A checked design from the content of its file; every problem is an InputError of one
    sentence."""
    design = validate(DriveDesign, table).made_by(make_drive)
    check_fit(design)
    return design


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
