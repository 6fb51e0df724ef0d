"""Runs of `swgpar run` for the accuracy benchmark, kept by their folders."""

from __future__ import annotations

import csv
import json
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from swgpar.meshing import load_recipe

QUIET = ("output.figures=false", "output.fields=false")


def run(folder: Path, design: str, mesh: str | Path, overrides: list[str], ranks: int) -> dict[str, Any]:
    """Unknowns, values, seconds and memory (MB, all ranks) of a run, in the form of accuracy_case.py.

    values : means over the rotation by their names in summary.json, and columns of the last row of history.csv, with
    `last.` before their names
    """
    if not (folder / "summary.json").exists():  # a run that ended before is begun anew
        shutil.rmtree(folder, ignore_errors=True)
        command = [
            "mpirun",
            "-n",
            str(ranks),
            sys.executable,
            "-P",
            "-m",
            "swgpar.cli",
            "run",
            design,
            "--mesh",
            str(mesh),
        ]
        subprocess.run(
            [*command, "--out", str(folder), "--set", *QUIET, *overrides], check=True, stdout=subprocess.DEVNULL
        )
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    with (folder / "history.csv").open(encoding="utf-8") as file:
        last = list(csv.DictReader(file))[-1]
    return {
        "unknowns": summary["dofs"],
        "elements": summary["elements"],
        "values": summary["means"] | {f"last.{key}": float(value) for key, value in last.items()},
        "exact": {},
        "seconds": summary["wall_s"],
        "memory_MB": sum(summary["peak_memory_MB_per_rank"]),
    }


def refined(mesh: str, path: Path, factor: int, keys: Sequence[str] = ()) -> Path:
    """Write a recipe with `factor` times as many elements: by the given keys (section.key), or in every direction."""
    recipe = load_recipe(mesh).model_dump(exclude_none=True)
    lines = []
    for section, content in recipe.items():
        lines.append(f"[{section}]")
        for key, value in content.items():
            more = isinstance(value, int) and (not keys or f"{section}.{key}" in keys)
            lines.append(f"{key} = {factor * value if more else value}")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path
