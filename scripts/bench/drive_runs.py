"""Runs of `swgpar run` for the accuracy benchmark, kept by their folders."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import program

from swgpar.meshing import MeshRecipe, load_recipe
from swgpar.meshing.recipe import to_toml
from swgpar.meshing.recipe_counts import with_counts


def run(folder: Path, design: str, mesh: str | Path, overrides: list[str], ranks: int) -> dict[str, Any]:
    """Unknowns, values, seconds and memory (MB, all ranks) of a run, in the form of accuracy_case.py.

    values : means over the rotation by their names in summary.json, and columns of the last row of history.csv, with
    `last.` before their names
    """
    if (folder / "summary.json").exists():
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    else:  # a run that ended before is begun anew
        summary = program.run(folder, design, ["output.fields=false", *overrides], ranks, mesh)
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


def refined(mesh: str, path: Path, factor: float, keys: Sequence[str] = ()) -> Path:
    """Write a recipe with `factor` times as many elements: by the given keys (section.key), or in every direction."""
    recipe = load_recipe(mesh)
    finer = with_counts(recipe, lambda *count: -int(-factor * count[-1] // 1))
    if keys:
        content = recipe.model_dump(exclude_none=True)
        for section, name in (key.split(".") for key in keys):
            content[section][name] = getattr(getattr(finer, section), name)
        finer = MeshRecipe.model_validate(content)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(to_toml(finer), encoding="utf-8")
    return path
