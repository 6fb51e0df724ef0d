"""Answers of several drives on meshes of one family, with observed orders.

Runs under mpirun. The meshes of a family have elements smaller by one ratio in every direction, but
for rounding to whole numbers. Drives are those that scripts/bench/effectivity draws, and the
reference drive of the plane. Finished runs are stored and not computed again: remove the file to
compute them anew.
"""

from __future__ import annotations

import argparse
import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from effectivity import MOST_MODELLED, SEED, Store, reference_drive
from mpi4py import MPI
from page import markdown, write_results

import swgpar
from support.sensible_drives import MESHES, sensible_drives
from swgpar.meshing.recipe_counts import RATIO, resized

OUT = Path("results/bench/convergence.jsonl")

STIFFNESS = {"stiffness.positions": 1, "output.root_stress": False}
"""Values of the design for a stiffness loop at one angle of the wave generator."""

OF_A_RUN = (
    "root.s1",
    "contact.pressure_off_edges",
    "sharing.largest_force_share",
    "rotation.transmission_error",
)
OF_STIFFNESS = "stiffness.K1", "stiffness.K2", "stiffness.K3", "stiffness.lost_motion"

ORDERS = 0.1, 8.0
"""Smallest and largest order that is told of."""

Row = dict[str, Any]


@dataclass(frozen=True)
class Family:
    """A drive on the meshes of `RATIOS`.

    torque : of the stiffness loop, N·m; None: that of the load
    """

    name: str
    table: dict[str, Any]
    torque: float | None = None

    @property
    def model(self) -> str:
        return str(self.table["drive"]["model"])

    @property
    def ratios(self) -> tuple[float, ...]:
        """Elements in every direction over those of the usual mesh, rising."""
        return RATIOS[self.model]


RATIOS = {"plane": (1.0, RATIO, RATIO**2, RATIO**3), "cup": (1.0 / RATIO, 1.0, RATIO)}
"""By model. One more mesh of a cup drive would need more memory than most machines have."""

DRAWN = "p004", "p039"

DRAWN_CUPS = "c075", "c104"


def families() -> list[Family]:
    """The plane reference drive, the same with narrow teeth of the ring gear, and drawn drives."""
    plane = reference_drive("plane").table
    narrow = {**plane, "ring_gear": {**plane["ring_gear"], "c_P": 0.97}}
    drawn = [one for one in sensible_drives(60, SEED) if one.name in DRAWN]
    cups = sensible_drives(20, SEED, "cup", MOST_MODELLED["cup"])
    drawn += [one for one in cups if one.name in DRAWN_CUPS]
    return [
        Family("reference", plane, 2.0),
        Family("reference, c_P 0.97", narrow, 2.0),
        *(Family(one.name, one.table) for one in drawn),
    ]


def measure(family: Family, store: Store) -> list[Row]:
    """Rows of one family; collective."""
    levels = []
    for ratio in family.ratios:
        recipe = resized(swgpar.load_mesh(MESHES[family.model]), ratio)
        name = f"{family.name} {ratio:.4g}"
        done = MPI.COMM_WORLD.bcast(store.found().get(name))
        if done is None:
            done = {"drive": name, "answers": solve(family, recipe)}
            if MPI.COMM_WORLD.rank == 0:
                store.keep(done)
                print(name, flush=True)
        levels.append(done["answers"])
    rows: list[Row] = []
    for answer in (*OF_A_RUN, *OF_STIFFNESS):
        found = [level[answer] for level in levels if answer in level]
        if len(found) < len(family.ratios):
            continue
        values = [one["value"] for one in found]
        rows.append(
            {
                "drive": family.name,
                "answer": answer,
                "ratios": [round(ratio, 3) for ratio in family.ratios],
                "values": values,
                "errors": [one["error"] for one in found],
                "order": order(values),
            }
        )
    return rows


def solve(family: Family, recipe: swgpar.MeshRecipe) -> dict[str, dict[str, Any]]:
    """Values and errors of the answers on one mesh; collective."""
    torque = {"stiffness.torque": family.torque} if family.torque else {}
    design = swgpar.load_design(family.table)
    found: dict[str, dict[str, Any]] = {}
    for names, values in ((OF_A_RUN, {}), (OF_STIFFNESS, STIFFNESS | torque)):
        summary = swgpar.run(design.with_values(values), recipe, progress=False).summary
        for name in names:
            answer = summary.get(name)
            if answer is not None and answer.value is not None:
                found[name] = {"value": answer.value, "error": answer.error}
    return found


def order(values: list[float]) -> float | None:
    """Order observed on the last three meshes, of a value that converges as the size of elements to
    this power; None where their differences do not fall with one sign, or it is not in `ORDERS`."""
    a, b, c = values[-3:]
    if (b - a) * (c - b) <= 0.0:
        return None
    low, high = ORDERS
    seen = math.log((b - a) / (c - b)) / math.log(RATIO)
    return seen if low < seen < high else None


def five_digits(value: float) -> str:
    """Without an exponent."""
    return f"{float(f'{value:.5g}'):,.10g}"


def table(rows: list[Row]) -> str:
    """The page's table."""
    head = ["drive", "answer", "values, coarse to fine", "stated error of the usual mesh, %"]
    found = [[*head, "change of the last three, %", "observed order"]]
    for row in rows:
        values, seen = row["values"], row["order"]
        last, usual = values[-3:], row["ratios"].index(1.0)
        error, value = row["errors"][usual], values[usual]
        cells = [row["drive"], row["answer"], "; ".join(five_digits(value) for value in values)]
        cells += ["no estimate" if error is None else f"{100.0 * error / abs(value):.1f}"]
        cells += [f"{100.0 * (max(last) - min(last)) / abs(last[-1]):.2f}"]
        found.append([*cells, "" if seen is None else f"{seen:.1f}"])
    return markdown(found)


def main() -> None:
    """Measure the families, and write the page."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--out", type=Path, default=OUT, help="file of finished runs")
    options.add_argument("--only", nargs="+", default=None, help="names of the drives to run")
    arguments = options.parse_args()
    store = Store(arguments.out)
    if MPI.COMM_WORLD.rank == 0:
        arguments.out.parent.mkdir(parents=True, exist_ok=True)
    every = families()
    chosen = [one for one in every if arguments.only is None or one.name in arguments.only]
    rows = [row for family in chosen for row in measure(family, store)]
    if MPI.COMM_WORLD.rank == 0 and chosen == every:
        write_results("convergence", tuple(rows[0]), rows, table(rows))
    elif MPI.COMM_WORLD.rank == 0:
        print(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
