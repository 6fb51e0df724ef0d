"""Error against wall time and memory, over mesh levels: elements on problems with known answers, and whole drives.

A drive has no exact answer: its error is the distance to the value extrapolated from its two finest meshes, and says
nothing for the finest one alone. Rates that theory gives are asserted.
"""

from __future__ import annotations

import argparse
import csv
import json
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from element_problems import PROBLEMS

from swgpar.error_estimate import estimate

RATE_SLACK = 0.15
"""Of an asserted rate between the two finest levels."""

DRIVES = {
    "plane drive": (
        "drivers/plane_half_turn.toml",
        ["mesh/plane_coarse.toml", "mesh/plane.toml", "mesh/plane_fine.toml"],
    ),
    "cup drive": ("drivers/cup_45deg.toml", ["mesh/coarse.toml", "mesh/medium.toml", "mesh/full.toml"]),
}
QUANTITIES = ("fs_s1", "fs_vm")

Row = dict[str, Any]


def element_rows(finest: int | None) -> list[Row]:
    """Rows of all problems of single elements; AssertionError when a rate of theory is missed."""
    rows: list[Row] = []
    for name, (solve, levels, rate) in PROBLEMS.items():
        previous = None
        for level in range(min(levels, finest or levels)):
            begin = time.perf_counter()
            solved = solve(level)
            seconds = time.perf_counter() - begin
            row: Row = {"problem": name, "level": level, "unknowns": solved.unknowns, "ranks": 1}
            row |= {"quantity": "displacement", "value": solved.value, "reference": solved.exact, "error": solved.error}
            row["rate"] = None if previous is None else round(float(np.log2(previous / solved.error)), 2)
            row |= {"seconds": round(seconds, 4), "memory_MB": None}
            rows.append(row)
            previous = solved.error
            show(row)
        if rate is not None and levels > 2 and finest is None:
            assert rows[-1]["rate"] > rate - RATE_SLACK, f"{name}: rate {rows[-1]['rate']}, theory {rate}"
    return rows


def drive_rows(name: str, ranks: int, out: Path, further: list[str]) -> list[Row]:
    """Rows of one drive on all its meshes."""
    design, meshes = DRIVES[name]
    summaries = []
    for mesh in meshes:
        folder = out / f"{name.replace(' ', '_')}_{Path(mesh).stem}"
        if not (folder / "summary.json").exists():  # what is finished is kept
            shutil.rmtree(folder, ignore_errors=True)
            command = ["mpirun", "-n", str(ranks), sys.executable, "-m", "swgpar.cli", "run", design, "--mesh", mesh]
            command += ["--out", str(folder), "--set", "output.figures=false", "output.fields=false", *further]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        summaries.append(json.loads((folder / "summary.json").read_text(encoding="utf-8")))
    rows: list[Row] = []
    for quantity in QUANTITIES:
        dimensions = 2 if summaries[0]["design"]["drive"]["model"] == "plane" else 3
        pair = [(s["means"][quantity], s["elements"]) for s in summaries[-2:]]
        found = estimate(pair[0][0], pair[1][0], pair[0][1], pair[1][1], dimensions)
        if found is None:
            raise ValueError(f"{name}: the meshes do not get finer")
        limit = found.converged
        for level, summary in enumerate(summaries):
            value = summary["means"][quantity]
            error = abs(value / limit - 1.0)
            row: Row = {"problem": name, "level": level, "unknowns": summary["dofs"], "ranks": summary["ranks"]}
            row |= {"quantity": quantity, "value": value, "reference": limit, "error": error}
            row["rate"] = None  # the meshes are no halvings
            row |= {"seconds": round(summary["wall_s"], 1), "memory_MB": round(sum(summary["peak_memory_MB_per_rank"]))}
            rows.append(row)
            show(row)
    return rows


def show(row: Row) -> None:
    print("  ".join(f"{k} {v:.4g}" if isinstance(v, float) else f"{k} {v}" for k, v in row.items()), flush=True)


def plot(rows: list[Row], path: Path) -> None:
    """Error against unknowns and against seconds, log-log."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 5.0), layout="constrained")
    for place, key in enumerate(("unknowns", "seconds"), start=1):
        axes = figure.add_subplot(1, 2, place)
        for name in dict.fromkeys((r["problem"], r["quantity"]) for r in rows):
            mine = [r for r in rows if (r["problem"], r["quantity"]) == name]
            label = name[0] if name[1] == "displacement" else " ".join(name)
            axes.loglog([r[key] for r in mine], [r["error"] for r in mine], "o-", ms=4, label=label)
        axes.set(xlabel=key, ylabel="relative error")
        axes.grid(alpha=0.3, which="both")
    axes.legend(fontsize="small")
    figure.savefig(path, dpi=130)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--out", default="results/bench/accuracy", help="runs of the drives; finished ones are kept")
    options.add_argument("--tables", default="docs/benchmarks")
    options.add_argument("--ranks", type=int, default=2)
    options.add_argument("--drives", nargs="*", default=list(DRIVES), choices=list(DRIVES))
    options.add_argument("--finest", type=int, default=None, help="levels of the element problems, for a quick look")
    options.add_argument("--set", nargs="+", default=[], help="overrides for the drives")
    arguments = options.parse_args()
    tables = Path(arguments.tables)
    tables.mkdir(parents=True, exist_ok=True)
    rows = element_rows(arguments.finest)
    for name in arguments.drives:
        rows += drive_rows(name, arguments.ranks, Path(arguments.out), arguments.set)
    with (tables / "accuracy.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    plot(rows, tables / "accuracy.png")
    print(f"written {tables}/accuracy.csv, accuracy.png")


if __name__ == "__main__":
    main()
