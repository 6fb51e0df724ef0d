"""Pressure of the flanks by contact of half planes and half spaces, on meshes that do and do not
resolve it.

In the plane reference drive the resolving mesh has 200 elements along every flank, about a fifth of
the half width of the contact long, in layers that get thinner towards it. The cam and the flanks
have twenty times the usual penalty there.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from page import markdown, put
from program import run

import swgpar
from swgpar.input.toml_file import to_toml
from swgpar.meshing.recipe import make_recipe

DESIGN, CUP, OUT = (
    "drivers/plane_half_turn.toml",
    "drivers/cup_45deg.toml",
    Path("results/bench/line_contact"),
)

TORQUES = (0.5, 2.0, 8.0)
"""N·m."""

FINE = {"flank": 200, "layers": 8, "layer_ratio": 1.6}
"""Counts of both gears that resolve the contact; the others are those of the recipe plane."""

MESHES = ("plane_coarse", "resolved")

WIDTHS = (6, 10, 16, 24)
"""Elements over the face width of the cup drive."""

CUP_HEAD = [
    "elements over the width",
    "tooth",
    "force N",
    "line load N/mm",
    "length mm",
    "half width mm",
    "pressure MPa",
]

HEAD = [
    "torque N·m",
    "tooth",
    "mesh",
    "line load N/mm",
    "half width mm",
    "by line contact",
    "on the mesh",
]


def recipe(mesh: str) -> str:
    """The mesh as an option of the run."""
    if mesh != "resolved":
        return mesh
    content = swgpar.load_mesh("plane").model_dump(exclude_none=True)
    for gear in ("flexible_spline", "ring_gear"):
        content[gear] |= FINE
    return str(written("resolved", content))


def written(name: str, content: dict[str, Any]) -> Path:
    """File of a recipe with this content."""
    path = OUT / f"{name}.toml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(to_toml(make_recipe(content).model_dump()), encoding="utf-8")
    return path


def rows(torque: float, mesh: str, ranks: int) -> list[list[str]]:
    """Both pressures of the loaded pairs under a torque."""
    folder = OUT / f"{mesh}_{torque:g}"
    stiff = ["contact.penalty_coef=1000"] if mesh == "resolved" else []
    overrides = [f"load.torque={torque:g}", "steps.rotation=0", "steps.bent_start=true", *stiff]
    run(folder, DESIGN, overrides, ranks, recipe(mesh))
    result = swgpar.open_result(folder)
    peak = result.flank_pressure().pressure.max(axis=(2, 3))
    found = []
    for k in np.flatnonzero(np.isfinite(result.pairs["pressure_MPa"])):
        tooth = int(result.pairs["tooth"][k])
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


def cup_rows(width: int, ranks: int) -> list[list[str]]:
    """The loaded pairs of the reference cup drive on a mesh with so many elements over the face
    width."""
    content = swgpar.load_mesh("forces").model_dump(exclude_none=True)
    content["face_width"]["elements"] = width
    folder, path = OUT / f"width_{width}", written(f"width_{width}", content)
    run(folder, CUP, ["steps.rotation=0", "steps.bent_start=true", "solver.rtol=1e-6"], ranks, path)
    pairs = swgpar.open_result(folder).pairs
    names = {
        "force_N": ".1f",
        "line_load_Nmm": ".1f",
        "width_mm": ".2f",
        "half_width_mm": ".4f",
        "pressure_MPa": ".0f",
    }
    return [
        [f"{width}", f"{tooth:.0f}", *(f"{pairs[name][k]:{form}}" for name, form in names.items())]
        for k, tooth in enumerate(pairs["tooth"])
        if np.isfinite(pairs["pressure_MPa"][k])
    ]


def main() -> None:
    """Measure, and put the table into the page."""
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("--ranks", type=int, default=2)
    options.add_argument("--page", type=Path, help="page that gets the table")
    arguments = options.parse_args()
    found = [
        row for torque in TORQUES for mesh in MESHES for row in rows(torque, mesh, arguments.ranks)
    ]
    tables = {
        "line_contact": markdown([HEAD, *found]),
        "patch_contact": markdown(
            [CUP_HEAD, *(row for width in WIDTHS for row in cup_rows(width, arguments.ranks))]
        ),
    }
    for name, text in tables.items():
        print(text)
        if arguments.page:
            put(arguments.page, name, text)


if __name__ == "__main__":
    main()
