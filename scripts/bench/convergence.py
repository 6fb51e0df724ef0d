"""The largest stresses of every region of the loaded drives on meshes of one family, with observed
orders.

Runs under mpirun. The meshes of a family have elements smaller by one ratio in every direction, but
for rounding to whole numbers. A stress is a nodal average, the largest one of its region.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
from mpi4py import MPI
from page import markdown, write_results
from scipy.optimize import brentq

from swgpar import load_design
from swgpar.analysis.coarse_start import solve_to_load
from swgpar.design.sections import GEARS
from swgpar.meshing import load_recipe
from swgpar.meshing.recipe_counts import RATIO, resized
from swgpar.model.drive_model import DriveModel

FAMILIES = {
    "plane": ("drivers/plane_half_turn.toml", "plane_coarse", (1.0, RATIO, RATIO**2, RATIO**3)),
    "cup": ("drivers/cup_45deg.toml", "forces", (1.0 / RATIO, 1.0, RATIO)),
}
"""Design, recipe, and elements in every direction over those of the recipe, coarse to fine."""

LOADED = ["steps.rotation=0", "steps.bent_start=true", "solver.rtol=1e-6"]

QUANTITIES = ("s1", "s3", "vm")

ORDERS = 0.1, 8.0
"""Smallest and largest order that is looked for."""

Row = dict[str, Any]


def by_region(model: DriveModel) -> dict[tuple[str, str, str], float]:
    """Largest s1, |s3| and von Mises stress (MPa) by body, region and quantity; collective."""
    found: dict[tuple[str, str, str], float] = {}
    _, fields = model.stresses()
    for k, (name, field) in enumerate(zip(GEARS, fields, strict=True)):
        regions = model.regions[k][False]
        for quantity in QUANTITIES:
            values = -field["s3"] if quantity == "s3" else field[quantity]
            for region in np.unique(regions):
                here = float(values[:, regions == region].max(initial=-np.inf))
                found[name, str(region), quantity] = model.comm.allreduce(here, op=MPI.MAX)
    return found


def order(values: list[float], sizes: list[float]) -> float | None:
    """Order observed on the last three meshes; None where their differences do not fall with one
    sign.

    values : of a stress that converges as size**order;  sizes : of the elements, by their number
    """
    (a, b, c), (r, s, t) = values[-3:], sizes[-3:]
    if (b - a) * (c - b) <= 0.0:
        return None

    def mismatch(p: float) -> float:
        return (b - a) / (c - b) - (r**p - s**p) / (s**p - t**p)

    low, high = ORDERS
    return float(brentq(mismatch, low, high)) if mismatch(low) * mismatch(high) < 0.0 else None


def measure(family: str) -> list[Row]:
    """Rows of one family; collective."""
    path, name, ratios = FAMILIES[family]
    design = load_design(path, LOADED)
    model = None
    levels = []
    elements = []
    for ratio in ratios:
        recipe = resized(load_recipe(name), ratio)
        model = solve_to_load(design, recipe, MPI.COMM_WORLD, model)
        levels.append(by_region(model))
        elements.append(model.n_elements())
        if MPI.COMM_WORLD.rank == 0:
            print(f"{family}: {elements[-1]:,} elements", flush=True)
    model.destroy()
    rows = []
    sizes = [count ** (-1.0 / (2 if name.startswith("plane") else 3)) for count in elements]
    for body, region, quantity in levels[0]:
        values = [level[body, region, quantity] for level in levels]
        row = {
            "model": family,
            "body": body,
            "region": region,
            "quantity": quantity,
            "elements": elements,
        }
        rows.append(
            {**row, "values": [round(value, 2) for value in values], "order": order(values, sizes)}
        )
    return rows


def table(rows: list[Row]) -> str:
    """The page's table."""
    found = [
        [
            "drive",
            "body",
            "region",
            "stress",
            "MPa, coarse to fine",
            "last change, %",
            "observed order",
        ]
    ]
    for row in rows:
        values, seen = row["values"], row["order"]
        change = 100.0 * (values[-1] / values[-2] - 1.0)
        cells = [row["model"], row["body"].replace("_", " "), row["region"], row["quantity"]]
        cells += [
            ", ".join(f"{value:.1f}" for value in values),
            f"{change:.1f}",
            "" if seen is None else f"{seen:.1f}",
        ]
        found.append(cells)
    return markdown(found)


def main() -> None:
    """Measure the families, and write the page."""
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.parse_args()
    rows = [row for family in FAMILIES for row in measure(family)]
    if MPI.COMM_WORLD.rank == 0:
        write_results("convergence", tuple(rows[0]), rows, table(rows))


if __name__ == "__main__":
    main()
