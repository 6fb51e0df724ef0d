"""Stiffness and pressure of the flanks by their law, on meshes that do not resolve their
contact."""

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
    Path("results/bench/contact_pressure"),
)

TORQUES = (2.0, 8.0)
"""N·m, of the plane drive."""

WIDTHS = (6, 9, 12)
"""Elements over the face width of the cup drive."""

FLANKS, REDUCTIONS = (9, 18, 36), (0.97, 1.0)
"""Elements along a flank of the plane drive, and `ring_gear.c_P`: few and many pairs touch."""

LAYERS = {"flexible_spline": 2, "ring_gear": 1}
BODIES = {"root": 12, "under": 6, "rim": 6}
"""Other counts of the plane drive: layers of each gear, and those of both."""

STIFFNESS = ["c_P", "elements along a flank", "K1", "K2", "K3"]

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
    "elements along a flank",
    "line load N/mm",
    "half width mm",
    "pressure by the law",
    "nodal mean on the mesh",
]


def recipe(count: int) -> Path:
    """Mesh of the plane drive with so many elements along a flank."""
    content = swgpar.load_mesh("plane_coarse").model_dump(exclude_none=True)
    for gear, layers in LAYERS.items():
        content[gear] |= BODIES | {"layers": layers, "flank": count}
    return written(f"flank_{count}", content)


def written(name: str, content: dict[str, Any]) -> Path:
    """File of a recipe with this content."""
    path = OUT / f"{name}.toml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(to_toml(make_recipe(content).model_dump()), encoding="utf-8")
    return path


def stiffness_rows(reduction: float, count: int, ranks: int) -> list[str]:
    """Torsional stiffness of the plane drive, 10³ N·m/rad, mean over positions."""
    folder = OUT / f"stiffness_{reduction:g}_{count}"
    overrides = ["stiffness.torque=2", "stiffness.mesh_error=false"]
    summary = run(
        folder,
        DESIGN,
        [f"ring_gear.c_P={reduction:g}", *overrides],
        ranks,
        recipe(count),
        plain=False,
    )
    found = [getattr(summary.stiffness, name) for name in STIFFNESS[2:]]
    return [f"{reduction:g}", f"{count}", *(f"{value / 1e3:.1f}" for value in found)]


def rows(torque: float, count: int, ranks: int) -> list[list[str]]:
    """Pressures of the loaded pairs of the plane drive under a torque."""
    folder = OUT / f"plane_{count}_{torque:g}"
    overrides = [f"load.torque={torque:g}", "steps.rotation=0", "steps.bent_start=true"]
    run(folder, DESIGN, overrides, ranks, recipe(count))
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
                f"{count}",
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
        row
        for torque in TORQUES
        for count in FLANKS
        for row in rows(torque, count, arguments.ranks)
    ]
    stiffness = [
        stiffness_rows(reduction, count, arguments.ranks)
        for reduction in REDUCTIONS
        for count in FLANKS
    ]
    tables = {
        "stiffness": markdown([STIFFNESS, *stiffness]),
        "plane_pressure": markdown([HEAD, *found]),
        "cup_pressure": markdown(
            [CUP_HEAD, *(row for width in WIDTHS for row in cup_rows(width, arguments.ranks))]
        ),
    }
    for name, text in tables.items():
        print(text)
        if arguments.page:
            put(arguments.page, name, text)


if __name__ == "__main__":
    main()
