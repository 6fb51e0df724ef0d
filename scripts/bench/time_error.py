"""Run time against the true error of the largest tension at the teeth under load, for the reference
drives.

Two ways are compared: windows, as `swgpar run` resolves that stress, and nodal averages on finer
and finer meshes of the whole drive, in one period with a start on coarser meshes. `--nodal
CHECKOUT` runs the second one by another installation. The true stress is that of the references of
the effectivity benchmark. All runs take place in one sitting.
"""

from __future__ import annotations

import argparse
import csv
import json
import shutil
import subprocess
import time
from pathlib import Path
from typing import Any

from effectivity import OUT as EFFECTIVITY
from effectivity import REFERENCE_DRIVES, Store
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from page import markdown, write_results

import swgpar
from support.commands import environment

OUT, PICTURE = Path("results/bench/time_error"), Path("docs/verification/data/time_error.png")

DESIGNS = {"cup": "drivers/cup_45deg.toml", "plane": "drivers/plane_half_turn.toml"}

FAST = ["steps.samples=8", "steps.pins=false", "solver.rtol=1e-5"]
"""Shortcuts of a run by nodal averages."""

WAYS = ("windows", "nodal averages")

Run = tuple[str, str, str, list[str]]
"""Model, way, label, and arguments of `swgpar run DESIGN`."""

RUNS: list[Run] = [
    ("cup", WAYS[0], "default", []),
    ("cup", WAYS[0], "accuracy 0.05", ["--accuracy", "0.05"]),
    ("cup", WAYS[0], "accuracy 0.02", ["--accuracy", "0.02"]),
    ("cup", WAYS[0], "accuracy 0.01", ["--accuracy", "0.01"]),
    ("cup", WAYS[0], "full", ["--mesh", "full"]),
    ("cup", WAYS[1], "coarse", ["--mesh", "coarse", "--set", *FAST]),
    ("cup", WAYS[1], "medium", ["--mesh", "medium", "--set", *FAST]),
    ("cup", WAYS[1], "full", ["--mesh", "full", "--set", *FAST, "steps.start_levels=2"]),
    ("plane", WAYS[0], "default", []),
    ("plane", WAYS[0], "accuracy 0.02", ["--accuracy", "0.02"]),
    ("plane", WAYS[0], "accuracy 0.005", ["--accuracy", "0.005"]),
    ("plane", WAYS[1], "plane_coarse", ["--mesh", "plane_coarse", "--set", *FAST]),
    ("plane", WAYS[1], "plane", ["--mesh", "plane", "--set", *FAST, "steps.start_levels=2"]),
    (
        "plane",
        WAYS[1],
        "plane_fine",
        ["--mesh", "plane_fine", "--set", *FAST, "steps.start_levels=3"],
    ),
    ("plane", WAYS[1], "accuracy 0.02", ["--mesh", "plane_coarse", "--accuracy", "0.02"]),
]

COLUMNS = ("model", "way", "run", "wall_s", "s1", "stated", "error")

HEAD = ["drive", "way", "run", "s", "s1 under load", "stated error", "true error, %"]


def references() -> dict[str, float]:
    """True s1 (MPa) by model, of `scripts/bench/effectivity --references plane cup`."""
    runs = Store(EFFECTIVITY / "loaded_reference.jsonl").found()
    return {
        model: runs[name]["answers"]["root.s1"]["value"] for model, name in REFERENCE_DRIVES.items()
    }


def measure(run: Run, ranks: int, other: Path | None, true: float) -> dict[str, Any]:
    """Run it; ends the benchmark where it fails. true : s1, MPa"""
    model, way, label, options = run
    here = other if way == WAYS[1] and other else Path.cwd()
    meshes = {"--mesh": lambda name: name if here == Path.cwd() else f"mesh/{name}.toml"}
    options = [meshes.get(before, str)(option) for before, option in zip(["", *options], options)]
    options += [] if "--set" in options else ["--set"]
    folder = (OUT / f"{model}_{way}_{label}".replace(" ", "_")).absolute()
    shutil.rmtree(folder, ignore_errors=True)
    folder.parent.mkdir(parents=True, exist_ok=True)
    command = ["mpirun", "-n", str(ranks), str(here / ".venv/bin/swgpar"), "run", DESIGNS[model]]
    command += [*options, "output.figures=false", "--out", str(folder)]
    begin = time.perf_counter()
    # not the packages of this checkout in another one
    variables = {
        name: value
        for name, value in environment().items()
        if here == Path.cwd() or name != "PYTHONPATH"
    }
    done = subprocess.run(command, cwd=here, capture_output=True, text=True, env=variables)
    seconds = time.perf_counter() - begin
    if done.returncode:
        raise SystemExit(f"{' '.join(command)}: {done.stderr or done.stdout}")
    with (folder / "history.csv").open(encoding="utf-8") as file:
        loaded = next(row for row in csv.DictReader(file) if int(row["step"]) >= 3)
    s1, stated = float(loaded["fs_s1"]), None
    if way == WAYS[0]:
        root = swgpar.open_result(folder).summary.root_stress
        s1, stated = root.s1, root.total_error
    row = {
        "model": model,
        "way": way,
        "run": label,
        "wall_s": round(seconds, 1),
        "s1": round(s1, 2),
    }
    return {
        **row,
        "stated": stated and round(stated, 2),
        "error": abs(s1 - true) / true,
    }


def draw(rows: list[dict[str, Any]]) -> None:
    """Error over seconds, log-log."""
    figure = Figure(figsize=(9.0, 4.5), layout="constrained")
    for axes, model in zip(figure.subplots(1, 2), DESIGNS):
        for way, style in zip(WAYS, ("o", "s")):
            mine = [row for row in rows if (row["model"], row["way"]) == (model, way)]
            axes.loglog(
                [r["wall_s"] for r in mine], [100.0 * r["error"] for r in mine], style, label=way
            )
            for row in mine:
                place = row["wall_s"], 100.0 * row["error"]
                axes.annotate(
                    row["run"], place, (2, 4), textcoords="offset points", fontsize=7, rotation=50
                )
        axes.set(
            title=f"{model} drive", xlabel="wall seconds on 2 ranks", ylabel="true error of s1 (%)"
        )
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(NullFormatter())
        axes.grid(alpha=0.3, which="both")
        axes.margins(0.25)
        axes.legend(fontsize=8)
    figure.savefig(PICTURE, dpi=120)


def write(rows: list[dict[str, Any]]) -> None:
    """Picture, data and table of the page."""
    draw(rows)
    cells = [HEAD]
    for row in rows:
        stated = "" if row["stated"] is None else f"{row['stated']:.1f}"
        numbers = [
            f"{row['wall_s']:.0f}",
            f"{row['s1']:.1f}",
            stated,
            f"{100.0 * row['error']:.2f}",
        ]
        cells.append([row["model"], row["way"], row["run"], *numbers])
    write_results("time_error", COLUMNS, rows, markdown(cells))


def main() -> None:
    """Measure, and write table and picture."""
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("--ranks", type=int, default=2)
    options.add_argument(
        "--nodal", type=Path, metavar="CHECKOUT", help="built checkout for the nodal averages"
    )
    arguments = options.parse_args()
    true = references()
    rows = []
    for run in RUNS:
        rows.append(
            measure(
                run, arguments.ranks, arguments.nodal and arguments.nodal.absolute(), true[run[0]]
            )
        )
        print(json.dumps(rows[-1]), flush=True)
    write(rows)


if __name__ == "__main__":
    main()
