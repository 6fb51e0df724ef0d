"""Run time against the true error of the largest tension at the teeth under load, for the reference
drives and drawn ones, before and now.

`--before CHECKOUT` runs the same by another installation. The true stress is that of the references
of the effectivity benchmark. Seconds are those of the processor, of one process: on a machine that
others use they change less than wall seconds. A run that has finished is not computed again: remove
the folder to compute it anew.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from effectivity import MOST_MODELLED, SEED, Store, reference_drive
from effectivity import OUT as EFFECTIVITY
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from page import markdown, write_results

import swgpar
from support.commands import environment
from support.paths import ROOT
from support.sensible_drives import SensibleDrive, sensible_drives
from swgpar.input.toml_file import to_toml

OUT, PICTURE = Path("results/bench/time_error"), Path("docs/verification/data/time_error.png")

DRAWN = {"plane": ("p012", "p017", "p063"), "cup": ("c064",)}
"""Drives of scripts/bench/effectivity that are run as well."""

RUNS: dict[str, list[str]] = {
    "default": [],
    "accuracy 0.01": ["--accuracy", "0.01"],
}
"""Arguments of `swgpar run DESIGN`."""

OF_MODEL = {"plane": tuple(RUNS), "cup": ("default",)}
"""Runs of the drives of a model. With an accuracy of 1 % a cup drive takes minutes."""

MAIN = "import sys; from swgpar.cli import main; sys.exit(main())"

NOW = "now"

MARGIN = 2.0
"""Factor by which axes of the picture reach beyond the values."""

SMALLEST = 1e-4
"""Least error that is drawn: the references are known no better."""

COLUMNS = ("drive", "commit", "run", "cpu_s", "s1", "stated", "error")

HEAD = ["drive", "commit", "run", "processor s", "s1 under load, MPa", "stated error, %"]
HEAD += ["true error, %"]

Row = dict[str, Any]


@dataclass(frozen=True)
class Installation:
    """A built checkout. name : of its commit"""

    name: str
    folder: Path

    def variables(self) -> dict[str, str]:
        """Environment of a run; that of another checkout has not the packages of this one."""
        own = environment() | {"OMP_NUM_THREADS": "1"}
        return own if self.name == NOW else own | {"PYTHONPATH": str(self.folder)}


def drives() -> list[SensibleDrive]:
    """Reference drives and drawn ones."""
    found = []
    for model, names in DRAWN.items():
        found.append(reference_drive(model))
        count = 1 + max(int(name[1:]) for name in names)
        drawn = sensible_drives(count, SEED, model, MOST_MODELLED[model])
        found += [drive for drive in drawn if drive.name in names]
    return found


def measure(drive: SensibleDrive, run: str, by: Installation, out: Path) -> Row:
    """Run it; ends the benchmark where it fails."""
    folder = (out / f"{drive.name}_{by.name}_{run}".replace(" ", "_")).absolute()
    stored, design = (folder.with_name(folder.name + end) for end in (".json", ".toml"))
    if stored.exists():
        row: Row = json.loads(stored.read_text(encoding="utf-8"))
        return row
    design.parent.mkdir(parents=True, exist_ok=True)
    design.write_text(to_toml(drive.table), encoding="utf-8")
    command = [str(ROOT / ".venv/bin/python"), "-c", MAIN, "run", str(design), *RUNS[run]]
    command += ["--out", str(folder), "--overwrite"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run(
        command, cwd=by.folder, capture_output=True, text=True, env=by.variables()
    )
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    if done.returncode:
        raise SystemExit(f"{' '.join(command)}: {done.stderr or done.stdout}")
    root = swgpar.open_result(folder).summary.root_stress
    s1, stated = root.s1, root.total_error
    row = {"drive": drive.name, "commit": by.name, "run": run, "cpu_s": round(seconds, 1)}
    row |= {"s1": round(s1, 2), "stated": stated and round(stated, 2)}
    stored.write_text(json.dumps(row), encoding="utf-8")
    return row


def draw(rows: list[Row], names: list[str]) -> None:
    """Error over seconds, log-log, a panel for each drive."""
    figure = Figure(figsize=(9.0, 3.2 * (len(names) + 1) // 2), layout="constrained")
    panels = figure.subplots((len(names) + 1) // 2, 2).ravel()
    commits = list(dict.fromkeys(row["commit"] for row in rows))
    for axes, name in zip(panels, names, strict=False):
        for commit, style in zip(commits, ("o", "s"), strict=False):
            mine = [row for row in rows if (row["drive"], row["commit"]) == (name, commit)]
            axes.loglog(
                [r["cpu_s"] for r in mine],
                [100.0 * max(r["error"], SMALLEST) for r in mine],
                style,
                label=commit,
            )
            for row in mine:
                place = row["cpu_s"], 100.0 * max(row["error"], SMALLEST)
                axes.annotate(row["run"], place, (3, 4), textcoords="offset points", fontsize=7)
        axes.set(title=name, xlabel="processor seconds", ylabel="true error of s1 (%)")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(NullFormatter())
        axes.grid(alpha=0.3, which="both")
        for limits, kept in ((axes.get_xlim, axes.set_xlim), (axes.get_ylim, axes.set_ylim)):
            low, high = limits()
            kept(low / MARGIN, high * MARGIN)  # so that small differences look small
        axes.legend(fontsize=8)
    for axes in panels[len(names) :]:
        axes.remove()
    figure.savefig(PICTURE, dpi=120)


def write(rows: list[Row], names: list[str]) -> None:
    """Picture, data and table of the page."""
    draw(rows, names)
    cells = [HEAD]
    for row in rows:
        stated = row["stated"]
        cells.append([row["drive"], row["commit"], row["run"], f"{row['cpu_s']:.1f}"])
        cells[-1] += [f"{row['s1']:.1f}"]
        cells[-1] += ["no estimate" if stated is None else f"{100.0 * stated / row['s1']:.2f}"]
        cells[-1] += [f"{100.0 * row['error']:.2f}"]
    write_results("time_error", COLUMNS, rows, markdown(cells))


def main() -> None:
    """Measure, and write table and picture."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--out", type=Path, default=OUT, help="folder of finished runs")
    options.add_argument(
        "--references", type=Path, default=EFFECTIVITY, help="finished runs of the effectivity"
    )
    options.add_argument("--before", type=Path, metavar="CHECKOUT", help="another built checkout")
    options.add_argument("--name", default="a902ee9", help="commit of the other checkout")
    arguments = options.parse_args()
    installations = [Installation(NOW, Path.cwd())]
    if arguments.before:
        installations.insert(0, Installation(arguments.name, arguments.before.absolute()))
    references = Store(arguments.references / "loaded_reference.jsonl").found()
    rows = []
    every = drives()
    for drive in every:
        true = references[drive.name]["answers"]["root.s1"]["value"]
        for run in OF_MODEL[drive.model]:
            for by in installations:
                row = measure(drive, run, by, arguments.out)
                rows.append(row | {"error": abs(row["s1"] - true) / true})
                print(json.dumps(rows[-1]), flush=True)
    write(rows, [drive.name for drive in every])


if __name__ == "__main__":
    main()
