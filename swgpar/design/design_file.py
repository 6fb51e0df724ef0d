"""From a design file to a checked design."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from swgpar.design.drive_design import DriveDesign
from swgpar.input.toml_file import apply_overrides, read_toml


def load_design(path: str | Path, overrides: Sequence[str] = ()) -> DriveDesign:
    """Read and check a design file.

    Parameters
    ----------
    path : str or Path
    overrides : sequence of str
        Values that replace those of the file, each written as ``section.key=value``.

    Raises InputError of one sentence for every problem.
    """
    return DriveDesign.from_table(apply_overrides(read_toml(path), overrides))
