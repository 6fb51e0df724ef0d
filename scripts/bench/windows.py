"""The largest tension at the teeth by windows, of drives on several meshes.

Every run is loaded and ends there. Windows on one mesh after the other show what the displacements
of the drive leave.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from page import markdown, write_results
from program import run

PLANE, CUP = "drivers/plane_half_turn.toml", "drivers/cup_45deg.toml"

PLANE_MESHES, CUP_MESHES = ("plane_coarse", "plane", "plane_fine"), ("coarse", "forces", "medium")

DRIVES: dict[str, tuple[str, tuple[str, ...], tuple[str, ...]]] = {
    "plane, elliptical cam": (PLANE, PLANE_MESHES, ()),
    "plane, simplified cam": (
        PLANE,
        PLANE_MESHES,
        ("wave_generator.type=simplified", "wave_generator.C=0.97"),
    ),
    "plane, spline fixed": (PLANE, PLANE_MESHES, ("drive.layout=spline_fixed",)),
    "plane, 10 N·m": (PLANE, PLANE_MESHES, ("load.torque=10",)),
    "plane, rim 0.6 mm": (PLANE, PLANE_MESHES, ("flexible_spline.rim=0.6",)),
    "cup": (CUP, CUP_MESHES, ("steps.bent_start=true",)),
}
"""Design, meshes from coarse to fine, and overrides, by name."""

COLUMNS = ("drive", "mesh", "elements", "on_mesh", "s1", "error", "region", "radius", "z")


def measure(name: str, mesh: str, ranks: int) -> dict[str, Any]:
    """One run up to its loaded state."""
    design, _, overrides = DRIVES[name]
    every = ["steps.rotation=0", "output.fields=false", "output.root_stress=true", *overrides]
    summary = run(Path("results/bench/windows") / f"{name} {mesh}", design, every, ranks, mesh)
    root = summary.root_stress
    row = {"drive": name, "mesh": mesh, "elements": summary.elements}
    row |= {key: getattr(root, key) for key in ("on_mesh", "s1", "error", "region", "radius", "z")}
    return row | {"levels": list(root.levels)}


def table(rows: list[dict[str, Any]]) -> str:
    """The page's table."""
    head = ["drive", "mesh", "s1 on the mesh", "windows, coarse to fine", "error", "place"]
    found = [head]
    for row in rows:
        levels = ", ".join(f"{value:.1f}" for value in row["levels"])
        place = f"{row['region']}, r {row['radius']:.2f}, z {row['z']:.1f}"
        found.append(
            [
                row["drive"],
                row["mesh"],
                f"{row['on_mesh']:.1f}",
                levels,
                f"{row['error']:.1f}",
                place,
            ]
        )
    return markdown(found)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument(
        "--only", nargs="+", choices=list(DRIVES), default=list(DRIVES), metavar="DRIVE"
    )
    options.add_argument("--ranks", type=int, default=2)
    arguments = options.parse_args()
    rows = []
    for name in arguments.only:
        for mesh in DRIVES[name][1]:
            rows.append(measure(name, mesh, arguments.ranks))
            print(json.dumps(rows[-1]), flush=True)
    if len(arguments.only) < len(DRIVES):
        return
    write_results("windows", COLUMNS, rows, table(rows))


if __name__ == "__main__":
    main()
