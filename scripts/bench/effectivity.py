"""Estimated over true errors of the answers of a run, of drives that are drawn at random.

The true error is the distance from a reference: the same run on a mesh two levels finer, with 2.25
times the elements in every direction, one window more and twice the angles of a period. That of a
cup drive is one level finer, or two with --cup-levels 2, in a table of its own. The drives are
those of `support/sensible_drives.py`; nothing of the estimate was chosen with those of this seed.
With --other-teeth they have teeth that are neither arcs nor involutes, in tables of their own.
The true mean input torque is that of the energy balance.

Finished runs are stored and not computed again: remove PART_usual.jsonl or PART_reference.jsonl to
compute them anew. Tables of the page are written where all of its drives are finished; those of
fewer and of another seed are printed.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from effectivity_case import PARTS
from page import markdown, put, write_results

from support.commands import environment, on_ranks
from support.paths import DRIVERS
from support.sensible_drives import MESHES, SensibleDrive, sensible_drives
from swgpar.answers.answer import NO_LIMIT
from swgpar.input.toml_file import read_toml, with_value
from swgpar.meshing.recipe_counts import RATIO

OUT = Path("results/bench/effectivity")

SEED = 46
"""Of the drives of the page."""

DRIVES = {"plane": 60, "cup": 20}
"""Of the page, of each model."""

OTHER_DRIVES = {"plane": 16, "cup": 6}
"""The same with other teeth."""

STAGES = ("usual", "reference")

LEVELS = {"plane": 2, "cup": 1}
"""Meshes of the reference above the usual one, each of `RATIO` times the elements in every
direction of the one before it."""

LONGEST = 3000.0
"""Seconds that a run may take; a drive that takes longer is left out."""

MOST_MODELLED = {"plane": None, "cup": 60}
"""Most teeth of the flexible spline that are modelled, by symmetry a half or a third of all. The
references of other cup drives would cost too much."""

ROUND_OFF = 1e-9
"""Relative difference below which two values are the same."""

WORDS = {"plane": "Plane drives", "cup": "Cup drives"}

REFERENCE_DRIVES = {"plane": "plane_half_turn", "cup": "cup_45deg"}
"""Drives whose references scripts/bench/time_error takes; they are in no table here, because the
estimate was made with them too."""

EXACT = {"mean.wg_torque_Nmm": "rotation.expected_wg_torque"}
"""Answers of a run whose true value is another answer of it, by the energy balance. The true values
of all others are those of the reference."""

COLUMNS = (
    "drive",
    "kind",
    "teeth",
    "module",
    "quantity",
    "value",
    "estimate",
    "reference",
    "true",
    "true_percent",
    "ratio",
    "place",
    "reference_place",
    "edge",
    "remark",
)

Row = dict[str, Any]


@dataclass(frozen=True)
class Store:
    """Finished runs of a stage and part in a file of JSON lines."""

    path: Path

    def found(self) -> dict[str, dict[str, Any]]:
        """The runs by drive."""
        lines = self.path.read_text(encoding="utf-8").splitlines() if self.path.exists() else []
        return {one["drive"]: one for one in map(json.loads, lines)}

    def keep(self, one: dict[str, Any]) -> None:
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(one) + "\n")


def reference_drive(model: str) -> SensibleDrive:
    """The reference drive of a model."""
    name = REFERENCE_DRIVES[model]
    table = with_value(read_toml(DRIVERS / f"{name}.toml"), "drive.model", model)
    return SensibleDrive(name, model, table, "reference drive")


def solve(
    drive: SensibleDrive, part: str, levels: int, ranks: int, log: Path
) -> dict[str, dict[str, Any]]:
    """Run one drive on its usual mesh (`levels` 0) or on that of the reference; the runs by stage,
    since a reference may need the usual run. log : file of the run's log"""
    case = {
        "part": part,
        "table": drive.table,
        "mesh": MESHES[drive.model],
        "times": RATIO**levels,
        "counts": {},
        "samples": 2 if levels else 1,
    }
    script = str(Path(__file__).with_name("effectivity_case.py"))
    command = [*on_ranks(ranks), sys.executable, script, json.dumps(case)]
    with log.open("w", encoding="utf-8") as file:
        try:
            done = subprocess.run(
                command,
                stdout=subprocess.PIPE,
                stderr=file,
                text=True,
                env=environment(),
                timeout=LONGEST,
            )
        except subprocess.TimeoutExpired:
            return {STAGES[levels > 0]: {"failed": f"takes more than {LONGEST:.0f} s"}}
    if done.returncode:
        return {STAGES[levels > 0]: {"failed": log.read_text(encoding="utf-8")[-500:]}}
    return json.loads(done.stdout.splitlines()[-1])


def rows_of(
    drive: SensibleDrive, part: str, usual: dict[str, Any], reference: dict[str, Any]
) -> list[Row]:
    """Estimate and true error of every quantity; estimate None where the run states none."""
    rows = []
    sizes = drive.table["drive"]
    for name in PARTS[part]:
        own = usual["answers"].get(name)
        known = usual if name in EXACT else reference
        true = known["answers"].get(EXACT.get(name, name))
        if own is None or true is None:
            continue
        error = abs(own["value"] - true["value"])
        error = error if error > ROUND_OFF * abs(true["value"]) else 0.0
        rows.append(
            {
                "drive": drive.name,
                "kind": drive.kind,
                "teeth": sizes["teeth_fs"],
                "module": sizes["module"],
                "quantity": name,
                "value": own["value"],
                "estimate": own["error"],
                "reference": true["value"],
                "true": error,
                "true_percent": 100.0 * error / abs(true["value"]) if true["value"] else None,
                "ratio": own["error"] / error if own["error"] is not None and error else None,
                "place": own["place"],
                "reference_place": true["place"],
                "edge": int(usual["edge"]),
                "remark": true["no_error"] if true["no_error"] == NO_LIMIT else own["no_error"],
            }
        )
    return rows


HEAD = [
    "quantity",
    "drives",
    "of them no limit",
    "true error, %: median",
    "largest",
    "with an estimate",
    "estimate over true error: least",
    "share at least 1",
    "median",
]


def table(rows: Sequence[Row]) -> str:
    """The page's table of quantities."""
    cells = [HEAD]
    for name in dict.fromkeys(row["quantity"] for row in rows):
        every = [row for row in rows if row["quantity"] == name]
        own = [row for row in every if row["remark"] != NO_LIMIT]
        errors = [row["true_percent"] for row in own if row["true_percent"] is not None]
        ratios = [row["ratio"] for row in own if row["ratio"] is not None]
        line = [name, str(len(every)), str(len(every) - len(own))]
        line += [f"{median(errors):.2g}", f"{max(errors):.2g}"] if errors else ["", ""]
        line.append(str(len(ratios)) if ratios else "no estimate")
        if ratios:
            share = sum(ratio >= 1.0 for ratio in ratios) / len(ratios)
            line += [f"{min(ratios):.2f}", f"{100 * share:.0f} %", f"{median(ratios):.2f}"]
        cells.append(line + [""] * (len(HEAD) - len(line)))
    return markdown(cells)


def drive_table(rows: Sequence[Row]) -> str:
    """The page's table of the tension at the teeth, by drive."""
    cells = [["drive", "teeth", "module", "kind", "s1", "stated error", "true error", "ratio"]]
    for row in rows:
        if row["quantity"] != "root.s1":
            continue
        estimate = "no estimate" if row["estimate"] is None else f"{row['estimate']:.2f}"
        ratio = "" if row["ratio"] is None else f"{row['ratio']:.2f}"
        name = row["drive"] + (" *" if row["edge"] else "")
        cells.append([name, str(row["teeth"]), f"{row['module']:g}", row["kind"]])
        cells[-1] += [f"{row['value']:.1f}", estimate, f"{row['true']:.2f}", ratio]
    return markdown(cells)


def why_left_out(runs: Sequence[dict[str, Any]]) -> str:
    """Why the runs of a drive are left out: one failed, or says itself that it jams; else empty."""
    for stage, one in zip(STAGES, runs, strict=True):
        if "failed" in one:
            return f"{stage}: {one['failed']}"
        if one["remarks"]:
            return f"{stage}: {one['remarks'][0]}"
    return ""


def write(
    drives: Sequence[SensibleDrive],
    model: str,
    out: Path,
    levels: int,
    *,
    page: bool,
    other_teeth: bool,
) -> None:
    """Tables of a model from what is finished.

    levels : of the references;  page : whether they are of the drives of the documentation
    other_teeth : whether the drives have teeth that are neither arcs nor involutes

    Of other drives, and of a part of them, tables are printed.
    """
    rows: list[Row] = []
    without: list[str] = []
    finished: set[str] = set()
    for part in PARTS:
        stores = [Store(out / f"{part}_{stage}.jsonl").found() for stage in STAGES]
        for drive in drives:
            if not all(drive.name in store for store in stores):
                continue
            finished.add(drive.name)
            runs = [store[drive.name] for store in stores]
            if why := why_left_out(runs):
                without.append(f"- {drive.name} ({drive.kind}), {part}: {why}\n")
            else:
                rows += rows_of(drive, part, *runs)
    if not rows:
        return
    count = (OTHER_DRIVES if other_teeth else DRIVES)[model]
    if not page or (levels == LEVELS[model] and len(finished) < count):
        print(table(rows), *without, sep="\n")
        return
    name = model + "_other_teeth" * other_teeth
    if levels != LEVELS[model]:
        write_results(f"effectivity_{name}_{levels}", COLUMNS, rows, table(rows), "effectivity")
        return
    text = f"{WORDS[model]}:\n\n{table(rows)}"
    write_results(f"effectivity_{name}", COLUMNS, rows, text, "effectivity")
    path = Path("docs/verification/effectivity.md")
    put(path, f"by drive, {name}", drive_table(rows))
    put(path, f"left out, {name}", "".join(without) or "None of the drives that were run.\n")
    if not other_teeth:
        put(path.with_name("trust.md"), f"effectivity_{model}", text)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--out", type=Path, default=OUT, help="finished runs")
    options.add_argument("--seed", type=int, default=SEED)
    options.add_argument("--plane", type=int, help="number of plane drives")
    options.add_argument("--cups", type=int, help="number of cup drives")
    options.add_argument(
        "--other-teeth", action="store_true", help="teeth that are neither arcs nor involutes"
    )
    options.add_argument("--cup-levels", type=int, default=LEVELS["cup"], help="of the references")
    options.add_argument("--stages", nargs="+", choices=STAGES, default=list(STAGES))
    options.add_argument("--parts", nargs="+", choices=list(PARTS), default=list(PARTS))
    options.add_argument(
        "--references", nargs="*", choices=list(LEVELS), default=[], help="run these drives as well"
    )
    options.add_argument(
        "--only", nargs="+", default=[], help="names of the drives to run, in this order"
    )
    options.add_argument("--ranks", type=int, default=1)
    arguments = options.parse_args()
    out = arguments.out
    (out / "logs").mkdir(parents=True, exist_ok=True)
    of_page = OTHER_DRIVES if arguments.other_teeth else DRIVES
    drives = {
        model: sensible_drives(
            of_page[model] if count is None else count,
            arguments.seed,
            model,
            MOST_MODELLED[model],
            other_teeth=arguments.other_teeth,
        )
        for model, count in (("plane", arguments.plane), ("cup", arguments.cups))
    }
    levels = {**LEVELS, "cup": arguments.cup_levels}
    own = [reference_drive(model) for model in arguments.references]
    wanted = {drive.name: drive for drive in [*own, *drives["plane"], *drives["cup"]]}
    for part in arguments.parts:
        for drive in [wanted[name] for name in arguments.only or wanted]:
            for stage in arguments.stages:
                if drive.name in Store(out / f"{part}_{stage}.jsonl").found():
                    continue
                finer = levels[drive.model] if stage == "reference" else 0
                log = out / "logs" / f"{drive.name}_{part}_{stage}.log"
                for of_stage, one in solve(drive, part, finer, arguments.ranks, log).items():
                    store = Store(out / f"{part}_{of_stage}.jsonl")
                    if drive.name not in store.found():
                        store.keep({"drive": drive.name, **one})
                print(f"{drive.name} {part} {stage}", flush=True)
    for model, of_model in drives.items():
        write(
            of_model,
            model,
            out,
            levels[model],
            page=arguments.seed == SEED,
            other_teeth=arguments.other_teeth,
        )


if __name__ == "__main__":
    main()
