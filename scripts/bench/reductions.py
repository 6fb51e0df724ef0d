"""Time with and without each reduction, and the change of the results: one run of `swgpar run` for
every row.

The plain run has every reduction switched off. Each following row switches one on; the last row has
all that apply.
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

import program
from page import markdown, put

from swgpar import load_design

OFF = {
    "solver.symmetry": "false",
    "solver.far_teeth": "modelled",
    "solver.keep_factor": "false",
    "solver.condensed_sectors": "false",
    "steps.start_levels": "0",
    "steps.samples": "0",
    "steps.pins": "true",
}
ON = {
    "twofold symmetry": {"solver.symmetry": "true"},
    "teeth out of reach": {"solver.far_teeth": "left_out"},
    "factorisation reused": {"solver.keep_factor": "true"},
    "start on a coarser mesh": {"steps.start_levels": "1"},
    "no pins": {"steps.pins": "false"},
    "one period": {"steps.samples": "{samples}"},
}
PLANE_ON = {"condensed sectors": {"solver.condensed_sectors": "true"}}
MEANS = ("fs_s1", "fs_s3", "fs_vm", "rg_vm", "wg_torque_Nmm")


def run(arguments: argparse.Namespace, name: str, keys: dict[str, str]) -> dict[str, float | str]:
    """One run; its row of the table."""
    out = Path(arguments.out) / name.replace(" ", "_")
    overrides = [f"{k}={v.format(samples=arguments.samples)}" for k, v in {**OFF, **keys}.items()]
    summary = program.run(
        out, arguments.design, [*overrides, *arguments.set], arguments.ranks, arguments.mesh
    )
    row: dict[str, float | str] = {"reduction": name, "seconds": round(summary.wall_s, 1)}
    row["increments"] = summary.increments
    row["newton_mean"] = round(summary.rotation.newton_iterations_mean, 2)
    row["memory_MB"] = max(summary.peak_memory_MB_per_rank)
    return {**row, **{k: summary.rotation.means[k] for k in MEANS}}


HEAD = (
    "reduction",
    "s",
    "times faster",
    "increments",
    "Newton",
    "MB a rank",
    "s1",
    "s3",
    "vm",
    "ring vm",
    "torque",
)


def cells(row: dict[str, float | str]) -> list[str]:
    """The row of the page's table; from `s1` on the changes of the means."""
    numbers = [
        f"{row[k]}"
        for k in ("reduction", "seconds", "speedup", "increments", "newton_mean", "memory_MB")
    ]
    return [*numbers, *(f"{row[f'change_{mean}']}" for mean in MEANS)]


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--design", default="drivers/cup_45deg.toml")
    options.add_argument("--mesh", default="coarse")
    options.add_argument("--out", default="results/bench/reductions")
    options.add_argument("--table", default="docs/verification/data/reductions_cup.csv")
    options.add_argument("--page", default="docs/verification/reductions.md")
    options.add_argument("--ranks", type=int, default=2)
    options.add_argument("--samples", type=int, default=4, help="angles in a period")
    options.add_argument("--set", nargs="+", default=[], help="further overrides, for all runs")
    options.add_argument(
        "--only",
        nargs="+",
        default=None,
        choices=[*ON, *PLANE_ON, "all"],
        help="rows besides the plain one",
    )
    arguments = options.parse_args()
    plane = load_design(arguments.design, arguments.set).drive.model == "plane"
    apply = {**ON, **PLANE_ON} if plane else ON
    if not set(arguments.only or []) <= {*apply, "all"}:
        options.error("--only: condensed sectors are for the plane model")
    variants = {
        "none": {},
        **apply,
        "all": {k: v for keys in apply.values() for k, v in keys.items()},
    }
    rows: list[dict[str, float | str]] = []
    for name, keys in variants.items():
        if arguments.only is not None and name not in ("none", *arguments.only):
            continue
        rows.append(run(arguments, name, keys))
        plain, row = rows[0], rows[-1]
        row["speedup"] = round(plain["seconds"] / row["seconds"], 2)
        for mean in MEANS:
            row[f"change_{mean}"] = f"{row[mean] / plain[mean] - 1.0:+.1e}"
        print({k: v for k, v in row.items() if k not in MEANS}, flush=True)
        table = Path(arguments.table)
        table.parent.mkdir(parents=True, exist_ok=True)
        with table.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
        put(Path(arguments.page), table.stem, markdown([HEAD, *map(cells, rows)]))


if __name__ == "__main__":
    main()
