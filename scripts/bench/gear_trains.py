"""Gear trains with as many samples as the sources have: seconds on some ranks beside the targets
and published times.

Takes about ten minutes on 2 ranks, most of it for 100,000 planetary simulations. Writes
docs/verification/gear_train_seconds.md and gear_trains.csv, .json in its folder data. Rows of other
runs are kept.

Seconds: "run" is the wall time of a whole run inside the program, from the design file to the last
table (without start of Python and without figures); "simulation" is the time of the simulating
tasks over the ranks; "linearisation" is that of the slowest such task, which runs on one rank, with
all its matrices.
"""

from __future__ import annotations

import argparse
import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import program

from swgpar.gear_trains.result import TrainSummary
from swgpar.results.table import format_csv, read_columns

ROOT = Path(__file__).resolve().parents[2]
PAGES = ROOT / "docs" / "verification"
DATA = PAGES / "data"
HOUR = 3600.0
ONE_RIM = ["ring.rims=[87.0]"]
RUNS: dict[str, tuple[str, list[str]]] = {
    "cascade": ("cascade", []),
    "gear_pair": ("gear_pair", []),
    "planetary_linearised": ("planetary", [*ONE_RIM, "monte_carlo.samples=2", "time.steps=500"]),
    "planetary": ("planetary", [*ONE_RIM, "monte_carlo.samples=100000"]),
}
"""Driver and overrides by run."""

ROWS = [
    # run, part, what, published seconds, target
    (
        "cascade",
        "run",
        "1000 gearboxes at rest and in motion, and all else of the driver",
        36 * HOUR,
        180.0,
    ),
    ("gear_pair", "simulation", "20,000 gear pairs, mean of three torques", 8 * HOUR, 20.0),
    ("gear_pair", "linearisation", "gear pair, slowest torque and criterion", 35.0, None),
    ("gear_pair", "run", "all three torques: 60,000 gear pairs, six linearisations", None, None),
    ("planetary_linearised", "linearisation", "planetary train", 48.0, 5.0),
    ("planetary", "simulation", "100,000 planetary trains", 223 * HOUR, 900.0),
    ("planetary", "run", "100,000 planetary trains and the linearisation", None, 900.0),
]
STEPS = (625, 1250, 2500, 5000, 10_000)
"""Of the linearised planetary revolution."""

INTRODUCTION = """# Gear trains: seconds

```bash
scripts/bench/gear_trains                  # all rows; --only RUN ... for some of them
```

| part | what is measured |
|---|---|
| run | wall time of a whole run inside the program, without the start of Python and without figures |
| simulation | the simulating tasks over the ranks |
| linearisation | the slowest such task, on one rank, with its matrices |

Published times are those of the [sources](../references.md) on their computers, of one case each.

| what | part | ranks | published | target | seconds | met |
|---|---|---|---|---|---|---|
"""
STEPS_OF_A_REVOLUTION = """
## Steps of the linearised planetary train

One carrier revolution takes 27 s. The change is the one against half as many steps: the largest over all
monitored quantities and times, over the largest value of the quantity.

| steps | step (ms) | seconds, 1 rank | change of means | change of deviations |
|---|---|---|---|---|
"""


def run(driver: str, overrides: list[str], folder: Path, ranks: int) -> TrainSummary[Any]:
    """Run a driver and return its summary."""
    return program.run(folder, ROOT / "drivers" / f"{driver}.toml", overrides, ranks)


def seconds(summary: TrainSummary[Any], name: str, part: str) -> float:
    """Seconds of a part of a run."""
    if part == "run":
        return summary.wall_s
    tasks = summary.task_s
    if part == "linearisation":
        return tasks["linearised"].largest
    cases = len(summary.design.load.input) if name == "gear_pair" else 1
    return tasks["monte_carlo"].total / summary.ranks / cases


def timings(names: list[str], out: Path, ranks: int) -> list[dict[str, Any]]:
    """Rows of the table for some runs."""
    rows = []
    for name in names:
        # one task: a second rank would only wait for it, and keep its core busy with that
        summary = run(*RUNS[name], out / name, 1 if name == "planetary_linearised" else ranks)
        for which, part, what, published, target in ROWS:
            if which == name:
                taken = seconds(summary, name, part)
                met = "" if target is None else ("yes" if taken <= target else "no")
                rows.append(
                    {
                        "run": name,
                        "part": part,
                        "what": what,
                        "ranks": summary.ranks,
                        "published_s": published,
                        "target_s": target,
                        "seconds": round(taken, 2),
                        "met": met,
                    }
                )
        print(name, [row["seconds"] for row in rows if row["run"] == name], flush=True)
        print(f"  quantities: {json.dumps(dict(summary.quantities))}", flush=True)
    return rows


def step_study(out: Path) -> list[dict[str, Any]]:
    """Linearised planetary revolution by different numbers of steps: change of means and
    deviations.

    Change against half as many: the largest over all monitored quantities and times, over the
    largest value.
    """
    found, taken = [], []
    for count in STEPS:
        overrides = [
            *RUNS["planetary_linearised"][1],
            f"time.linearised_steps={count}",
            "time.rows=125",
        ]
        summary = run("planetary", overrides, out / f"steps_{count}", 1)
        found.append(read_columns(out / f"steps_{count}" / "history.csv"))
        taken.append(summary.task_s["linearised"].largest)
        print(f"{count} steps: {taken[-1]:.2f} s", flush=True)
    rows = [
        {
            "steps": STEPS[0],
            "seconds": round(taken[0], 2),
            "change_of_means": None,
            "change_of_deviations": None,
        }
    ]
    for (coarse, fine), count, time in zip(pairwise(found), STEPS[1:], taken[1:], strict=True):
        row: dict[str, Any] = {"steps": count, "seconds": round(time, 2)}
        for kind in ("mean", "deviation"):
            names = [name for name in fine if name.startswith(f"linearised_{kind}")]
            changes = [np.abs(fine[n] - coarse[n]).max() / np.abs(fine[n]).max() for n in names]
            row[f"change_of_{kind}s"] = float(f"{max(changes):.3g}")
        rows.append(row)
    return rows


def page(rows: list[dict[str, Any]], steps: list[dict[str, Any]]) -> str:
    """The page of both tables."""
    lines = INTRODUCTION.splitlines()
    for row in rows:
        published = row["published_s"]
        old = (
            ""
            if published is None
            else f"{published / HOUR:g} h"
            if published >= HOUR
            else f"{published:g} s"
        )
        target = "" if row["target_s"] is None else f"{row['target_s']:g} s"
        cells = (
            row["what"],
            row["part"],
            row["ranks"],
            old,
            target,
            f"{row['seconds']:.1f}",
            row["met"],
        )
        lines.append("| " + " | ".join(str(cell) for cell in cells) + " |")
    lines += STEPS_OF_A_REVOLUTION.splitlines()
    for row in steps:
        step = 1e3 * 2.0 * np.pi / 0.2322 / row["steps"]
        changes = [
            "" if row[k] is None else f"{row[k]:.2g}"
            for k in ("change_of_means", "change_of_deviations")
        ]
        lines.append(
            f"| {row['steps']} | {step:.2f} | {row['seconds']:.1f} | {changes[0]} | {changes[1]} |"
        )
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=Path("results/bench_gear_trains"))
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--only", nargs="+", choices=[*RUNS, "steps"], default=[*RUNS, "steps"])
    arguments = parser.parse_args()
    out = arguments.out.resolve()
    kept = DATA / "gear_trains.json"
    old = (
        json.loads(kept.read_text(encoding="utf-8"))
        if kept.exists()
        else {"timings": [], "steps": []}
    )
    new = timings([name for name in RUNS if name in arguments.only], out, arguments.ranks)
    asked = {row["run"] for row in new}
    order = [row[:2] for row in ROWS]
    rows = sorted(
        [*new, *(row for row in old["timings"] if row["run"] not in asked)],
        key=lambda r: order.index((r["run"], r["part"])),
    )
    steps = step_study(out) if "steps" in arguments.only else old["steps"]
    kept.write_text(
        json.dumps({"timings": rows, "steps": steps}, indent=1) + "\n", encoding="utf-8"
    )
    (DATA / "gear_trains.csv").write_bytes(format_csv(rows))
    (PAGES / "gear_train_seconds.md").write_text(page(rows, steps), encoding="utf-8")
    print(page(rows, steps))


if __name__ == "__main__":
    main()
