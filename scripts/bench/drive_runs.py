"""Runs of `swgpar run` for the accuracy benchmark, stored by folder."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import program

import swgpar


def run(
    folder: Path, design: str, mesh: str | Path, overrides: list[str], ranks: int
) -> dict[str, Any]:
    """Unknowns, values, seconds and memory (MB, all ranks) of a run, in the form of
    accuracy_case.py.

    values : means over the rotation by their names in summary.json, and columns of the last row of
    history.csv, with `last.` before their names
    """
    if (folder / "summary.json").exists():
        summary = swgpar.open_result(folder).summary
    else:  # a run that ended before is begun anew
        summary = program.run(folder, design, ["output.fields=false", *overrides], ranks, mesh)
    with (folder / "history.csv").open(encoding="utf-8") as file:
        last = list(csv.DictReader(file))[-1]
    return {
        "unknowns": summary.dofs,
        "elements": summary.elements,
        "values": dict(summary.rotation.means)
        | {f"last.{key}": float(value) for key, value in last.items()},
        "exact": {},
        "seconds": summary.wall_s,
        "memory_MB": sum(summary.peak_memory_MB_per_rank),
    }
