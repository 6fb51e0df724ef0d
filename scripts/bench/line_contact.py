"""Pressure of the flanks by line contact, beside elements that resolve the contact, in the plane reference drive.

The resolving mesh has 200 elements along every flank, about a fifth of the half width of the contact long, in layers
that get thinner towards it. The cam and the flanks have twenty times the usual penalty there.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from page import markdown, put
from program import run

import swgpar
from swgpar.meshing.recipe import make_recipe, to_toml

DESIGN, OUT = "drivers/plane_half_turn.toml", Path("results/bench/line_contact")

TORQUES = (0.5, 2.0, 8.0)
"""N·m."""

FINE = {"flank": 200, "layers": 8, "layer_ratio": 1.6}
"""Counts of both gears that resolve the contact; the others are those of the recipe plane."""

MESHES = ("plane_coarse", "resolved")

HEAD = ["torque N·m", "tooth", "mesh", "line load N/mm", "half width mm", "by line contact", "on the mesh"]


def recipe(mesh: str) -> str:
    """The mesh as an option of the run."""
    if mesh != "resolved":
        return mesh
    content = swgpar.load_mesh("plane").model_dump(exclude_none=True)
    for gear in ("flexible_spline", "ring_gear"):
        content[gear] |= FINE
    path = OUT / "resolved.toml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(to_toml(make_recipe(content)), encoding="utf-8")
    return str(path)


def rows(torque: float, mesh: str, ranks: int) -> list[list[str]]:
    """Both pressures of the loaded pairs under a torque."""
    folder = OUT / f"{mesh}_{torque:g}"
    stiff = ["contact.penalty_coef=1000"] if mesh == "resolved" else []
    overrides = [f"load.torque={torque:g}", "steps.rotation=0", "steps.bent_start=true", *stiff]
    run(folder, DESIGN, overrides, ranks, recipe(mesh))
    result = swgpar.open_result(folder)
    peak = result.flank_pressure().pressure.max(axis=(2, 3))
    found = []
    for k, tooth in enumerate(result.pairs["tooth"].astype(int)):
        side = int(result.pairs["flank"][k] != "clockwise")
        found.append(
            [
                f"{torque:g}",
                f"{tooth}",
                mesh,
                f"{result.pairs['line_load_Nmm'][k]:.2f}",
                f"{result.pairs['half_width_mm'][k]:.4f}",
                f"{result.pairs['pressure_MPa'][k]:.0f}",
                f"{np.max(peak[tooth, side]):.0f}",
            ]
        )
    return found


def main() -> None:
    """Measure, and put the table into the page."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--ranks", type=int, default=2)
    options.add_argument("--page", type=Path, help="page that gets the table")
    arguments = options.parse_args()
    found = [row for torque in TORQUES for mesh in MESHES for row in rows(torque, mesh, arguments.ranks)]
    text = markdown([HEAD, *found])
    print(text)
    if arguments.page:
        put(arguments.page, "line_contact", text)


if __name__ == "__main__":
    main()
