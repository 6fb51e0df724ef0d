"""From a design file to a checked design."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from swgpar.design.drive_design import DriveDesign
from swgpar.design.fit_checks import check_fit
from swgpar.input.toml_file import apply_overrides, read_toml, validate


def load_design(path: str | Path, overrides: Sequence[str] = ()) -> DriveDesign:
    """Read and check a design file.

    Parameters
    ----------
    path : str or Path
    overrides : sequence of str
        Values that replace those of the file, each written as ``section.key=value``.

    Raises InputError of one sentence for every problem.
    """
    return make_design(apply_overrides(read_toml(path), overrides))


def make_design(table: dict[str, Any]) -> DriveDesign:
    """Check the content of a design file, given as nested tables. Raises InputError of one sentence."""
    design = validate(DriveDesign, table)
    check_fit(design)
    return design
