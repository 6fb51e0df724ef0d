"""Drives and elements under numerical stress: what converges, what is refused, and how far the
invariants drift.

Every group of `tests/support/drive_groups.py` is a study on a small mesh. A rank computes one case
at a time. A case converges, is refused by one sentence before anything is computed, or fails to
converge.

stability.csv has a row for every case: Newton iterations (largest number in one increment, and
all), cut-backs, the unbalanced torque over the output's torque, and the drift: the relative change
of stresses and input torque after one period (without friction, which needs a period to settle).
For other systems of units and for more ranks the drift is the difference from the first ones.
Sensible designs turn so far that their mean input torque is compared with the energy balance; a
drive that says itself that it may jam is flagged. Silence is the longest time without a line of
output. --page gets the table by group.
"""

from __future__ import annotations

import argparse
import csv
import subprocess
import sys
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from page import markdown, put

import swgpar
from support.commands import environment, on_ranks, run_command
from support.drive_groups import (
    MESH,
    REPEATED,
    SENSIBLE,
    SENSIBLE_CUP,
    UNITS,
    UNITS_GROUP,
    Group,
    drift,
    groups,
)
from support.element_limits import element_rows
from support.paths import ROOT
from support.small_drive import PLANE
from swgpar.input.toml_file import toml_value
from swgpar.load.load_states import Stage
from swgpar.results import history
from swgpar.results.folder import SUMMARY

Row = dict[str, Any]
COLUMNS = (
    "group",
    "case",
    "status",
    "newton_max",
    "newton_all",
    "cutbacks",
    "cycles",
    "unbalanced",
    "drift",
    "wall_s",
)
COLUMNS += ("flagged", "energy", "silence_s", "reason")


def study_text(name: str, group: Group) -> str:
    """The group as a study file."""
    text = [
        f"[study]\ntitle = {toml_value(name)}\ndesign = {toml_value(str(group.design))}\n"
        f"meshes = [{toml_value(str(MESH))}]"
    ]
    for case, values in group.cases().items():
        lines = [f"[[study.case]]\nname = {toml_value(case)}"]
        lines += [
            f"section.{key} = {toml_value(value)}"
            for key, value in values.items()
            if "." not in key
        ]
        overrides = [f"{key}={toml_value(value)}" for key, value in values.items() if "." in key]
        text.append("\n".join([*lines, f"set = {toml_value(overrides)}"]))
    return "\n\n".join(text) + "\n"


def run_group(name: str, group: Group, out: Path, ranks: int, restart: bool) -> list[Row]:
    """Run one group as a study, or continue it; a row for every case."""
    folder = out / "".join(c if c.isalnum() else "_" for c in name)
    folder.mkdir(parents=True, exist_ok=True)
    study, result = folder / "study.toml", folder / "results"
    study.write_text(study_text(name, group), encoding="utf-8")
    command = [sys.executable, "-P", "-m", "swgpar.cli", "study", str(study), "--out", str(result)]
    command.append("--restart" if restart else "--overwrite")
    silence = run_logged([*on_ranks(ranks), *command], folder / "log.txt")
    with (result / "study.csv").open(encoding="utf-8") as file:
        outcomes = list(csv.DictReader(file))
    cases = group.cases()
    rows = [
        {
            "group": name,
            "case": o["case"],
            **verdict(o),
            **measured(result / "cases" / o["case"], cases[o["case"]]),
        }
        | {"silence_s": round(silence, 1)}
        for o in outcomes
    ]
    if name == UNITS_GROUP:
        compare_units(result / "cases", rows)
    return rows


def run_logged(command: list[str], log: Path) -> float:
    """Run a command with its output in a file; returns the longest time (s) without a line."""
    longest, last = 0.0, time.monotonic()
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment(), text=True
    )
    with log.open("w", buffering=1) as file:
        for text in process.stdout:
            file.write(text)
            longest, last = max(longest, time.monotonic() - last), time.monotonic()
    process.wait()
    return max(longest, time.monotonic() - last)


def compare_units(folder: Path, rows: list[Row]) -> None:
    """Replace the drift by the difference from the first system of units, of the last increment."""
    scaled = {}
    for name, length, force in UNITS:
        last = history.read_history(next((folder / name).rglob(history.NAME)))[-1]
        scaled[name] = {
            k: last[k] / (force * length if "torque" in k else force / length**2) for k in REPEATED
        }
    for row in rows:
        row["drift"] = drift(scaled[UNITS[0][0]], scaled[row["case"]])


def verdict(outcome: dict[str, str]) -> Row:
    """How a case of a study ended."""
    status, reason = outcome["status"], outcome["reason"]
    if status == "failed" and "allowed" in reason:
        status = "refused"
    reason = reason.partition("; ")[0]  # what follows says where the results are
    return {
        "status": "converged" if status == "finished" else status,
        "wall_s": outcome["wall_s"],
        "reason": reason,
    }


def measured(folder: Path, case: dict[str, Any]) -> Row:
    """Iterations and drift from the files of a run."""
    found = sorted(folder.rglob(history.NAME))
    if not found:
        return {}
    rows = history.read_history(found[0])
    newton = [int(r["newton_iterations"]) for r in rows]
    log = (found[0].parent / "run.log").read_text(encoding="utf-8")
    out: Row = {
        "newton_max": max(newton, default=""),
        "newton_all": sum(newton),
        "cutbacks": log.count("cut back to"),
        "cycles": log.count("contacts do not settle"),
    }
    loaded = [r for r in rows if int(r["step"]) >= Stage.LOAD]
    torque = max((abs(r["output_torque_Nmm"]) for r in loaded), default=0.0)
    if torque and case.get("load.torque") != 0.0:  # without a load both are round-off
        out["unbalanced"] = max(r["torque_balance_Nmm"] for r in loaded) / torque
    out |= energy(found[0].parent)
    turned = [r for r in rows if int(r["step"]) >= 4]
    if len(turned) == WHOLE_PERIOD:
        turned = [turned[0], turned[2], turned[-1]]
    if not case.get("contact.friction") and len(turned) == 3:
        out["drift"] = drift(turned[0], turned[-1])
    return out


def energy(folder: Path) -> Row:
    """From the summary of a run through a whole period: relative difference of its mean input
    torque, and the flag."""
    if not (folder / SUMMARY).exists():
        return {}
    summary = swgpar.open_result(folder).summary
    rotation, design = summary.rotation, summary.design
    out: Row = {"flagged": 1} if rotation.jammed else {}
    expected = rotation.wg_torque_expected_Nmm
    if (
        expected
        and design.steps.rotation > 4.9 * design.steps.increment
        and not design.contact.friction
    ):
        rows = history.read_history(folder / history.NAME)[-4:]
        out["energy"] = abs(sum(row["wg_torque_Nmm"] for row in rows) / len(rows) / expected - 1.0)
    return out


def run_on_ranks(out: Path, numbers: Iterable[int]) -> list[Row]:
    """The small drives on several numbers of ranks, more than the machine has cores included."""
    rows: list[Row] = []
    for model, overrides in (
        ("cup", ()),
        ("plane", PLANE),
        ("plane, friction", (*PLANE, "contact.friction=0.1")),
    ):
        alone: Row = {}
        for ranks in numbers:
            folder = out / "ranks" / f"{model.replace(', ', '_')}_{ranks}"
            command = run_command(
                folder, "--overwrite", ranks=ranks, overrides=(*SHORT, *overrides)
            )
            done = subprocess.run(
                command, capture_output=True, text=True, env=environment(), cwd=ROOT
            )
            row = {
                "group": "ranks",
                "case": f"{model}, {ranks} ranks",
                "status": "converged",
                "reason": "",
            }
            if done.returncode:
                row |= {
                    "status": "failed",
                    "reason": (done.stdout + done.stderr).strip().splitlines()[-1],
                }
            else:
                last = history.read_history(folder / history.NAME)[-1]
                alone = alone or last
                row |= measured(folder, {}) | {"drift": drift(alone, last)}
            rows.append(row)
    return rows


SHORT = ("steps.rotation=2.0", "steps.increment=2.0")


def counted(name: str, rows: list[Row]) -> list[str]:
    """The group's row of the table of groups."""

    def values(key: str) -> list[float]:
        return [float(r[key]) for r in rows if r.get(key, "") != ""]

    def largest(key: str) -> str:
        return f"{max(values(key)):.1e}" if values(key) else ""

    numbers = [
        sum(r["status"] == status for r in rows) for status in ("converged", "refused", "failed")
    ]
    numbers += [
        max(values("newton_max"), default=0),
        sum(values("cutbacks")),
        sum(values("cycles")),
    ]
    silence = f"{max(values('silence_s')):.0f}" if values("silence_s") else ""
    flagged = f"{sum(values('flagged')):.0f}" if values("energy") else ""
    balance = f"{np.median(values('energy')):.1e}" if values("energy") else ""
    return [
        name,
        *(f"{n:.0f}" for n in numbers),
        largest("unbalanced"),
        largest("drift"),
        flagged,
        balance,
        silence,
    ]


HEADER = [
    "group",
    "converged",
    "refused",
    "failed",
    "Newton",
    "cut-backs",
    "cycles",
    "unbalanced",
    "drift",
]
HEADER += ["flagged", "energy", "silence"]

WHOLE_PERIOD = 5
"""Increments of the rotation of sensible designs: the first and the last are one period apart."""


def line(cells: list[str]) -> str:
    return f"{cells[0]:40s}" + "".join(f"{cell:>11s}" for cell in cells[1:])


def write_page(page: Path, rows: list[Row]) -> None:
    """Put the table of groups, and the cases that did not converge, between the page's marks.

    Of designs that are drawn at random many are refused: their reasons are in the table of all
    cases.
    """
    names = list(dict.fromkeys(row["group"] for row in rows))
    text = markdown([HEADER, *(counted(n, [r for r in rows if r["group"] == n]) for n in names)])
    others = [
        f"- {r['group']}, {r['case']}: {r['status']}: {r['reason']}"
        for r in rows
        if r["status"] == "failed"
        or (r["status"] == "refused" and r["group"] not in (SENSIBLE, SENSIBLE_CUP))
    ]
    put(page, "table", text + ("\n" + "\n".join(others) + "\n" if others else ""))


def _is_earlier(row: Row, first: int) -> bool:
    """Whether the case is a sensible design before the first one of this call."""
    return row["group"] in (SENSIBLE, SENSIBLE_CUP) and int(row["case"].removeprefix("s")) < first


def main() -> int:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--out", default="results/bench/stability")
    options.add_argument("--tables", default="docs/verification/data")
    options.add_argument("--page", default="docs/verification/stability.md")
    options.add_argument("--at-once", type=int, default=2, help="cases that are computed at once")
    options.add_argument(
        "--most-ranks", type=int, default=8, help="largest number of ranks on one case"
    )
    options.add_argument("--random", type=int, default=200, help="number of random plane designs")
    options.add_argument(
        "--sensible", type=int, nargs=2, default=(1000, 200), help="numbers of plane and cup drives"
    )
    options.add_argument(
        "--first", type=int, default=0, help="number of the first one; earlier ones keep their rows"
    )
    options.add_argument("--seed", type=int, default=1)
    options.add_argument(
        "--restart", action="store_true", help="keep the cases that an earlier call has finished"
    )
    options.add_argument(
        "--only", nargs="+", default=None, help="words of the names of the groups to run"
    )
    arguments = options.parse_args()
    out, tables = Path(arguments.out).resolve(), Path(arguments.tables)
    tables.mkdir(parents=True, exist_ok=True)
    numbers = [n for n in (1, 2, 3, 4, 8) if n <= arguments.most_ranks]
    work = {"elements": element_rows, "ranks": lambda: run_on_ranks(out, numbers)}
    for name, group in groups(
        arguments.random, arguments.seed, tuple(arguments.sensible), arguments.first
    ).items():
        if group.cases():
            work[name] = lambda name=name, group=group: run_group(
                name, group, out, arguments.at_once, arguments.restart
            )
    table = tables / "stability.csv"
    rows: list[Row] = []
    if table.exists():  # groups that do not run now keep their rows
        with table.open(encoding="utf-8") as file:
            rows = [row for row in csv.DictReader(file) if row["group"] in work]
    print(line(HEADER), flush=True)
    for name, run in work.items():
        if arguments.only and not any(word in name for word in arguments.only):
            continue
        found = run()
        rows = [r for r in rows if r["group"] != name or _is_earlier(r, arguments.first)] + found
        rows.sort(key=lambda r: list(work).index(r["group"]))
        found = [r for r in rows if r["group"] == name]
        print(line(counted(name, found)), flush=True)
        with table.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, COLUMNS, restval="", lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
        write_page(Path(arguments.page), rows)
    failed = sum(row["status"] == "failed" for row in rows)
    print(f"{failed} of {len(rows)} cases failed; written {table} and {arguments.page}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
