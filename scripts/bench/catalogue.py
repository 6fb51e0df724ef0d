"""Drives of catalogue sizes by prediction: proportions that no catalogue prints are found on size
17, ratio 50, and all others follow.

Rows that are there already are not computed again, but with --again.
"""

from __future__ import annotations

import argparse
import csv
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import catalogue_tables as tables
import tomli_w
from catalogue_curves import (
    FITTED_RATIO,
    FITTED_SIZE,
    ROUNDED,
    SIZES,
    TOP,
    Curve,
    break_points,
    largest_torque,
)
from catalogue_designs import NAMES as PROPORTIONS
from catalogue_designs import Proportions, catalogue_design
from catalogue_fit import CASES, FITTED, WITH_PLAY, bent_alike
from page import DATA, put, read_results, write_results
from program import run

FOLDER = Path("results/bench/catalogue")
MESH = Path("scripts/bench/catalogue_mesh.toml")
DRIVES = Path("drivers/catalogue")
PAGE = DATA.parent / "catalogue.md"

RATIOS = (30, 50, 100)
FIT = ("case", *PROPORTIONS, "K1", "K2", "K3", "lost_motion", "wall_s")
CURVE = ("ratio", "torque_Nm", "rotation_arcmin", "pairs_in_contact")
HELD = ("ratio", "K1", "K2", "K3", "lost_motion", "wall_s")


def design_file(name: str, size: int, ratio: int, torque: float, proportions: Proportions) -> Path:
    """Write a design under the results, and return its path."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{name}.toml"
    path.write_text(tomli_w.dumps(catalogue_design(size, ratio, torque, proportions)), "utf-8")
    return path


def stiffness_keys(top: float, points: int) -> list[str]:
    """Overrides of a run of [stiffness] for size 17.

    top : N·m, largest torque;  points : even ones, beside those that K1 to K3 need
    """
    T1, T2 = break_points(FITTED_SIZE)
    return [
        f"stiffness.torque={top:.4g}",
        f"stiffness.rated_torque={T2}",
        f"stiffness.break_points=[{T1 / top:.6f}, {T2 / top:.6f}]",
        "stiffness.positions=1",
        f"stiffness.points={points}",
        "stiffness.mesh_error=false",
    ]


def program_rows(folder: Path, columns: Sequence[str]) -> list[dict[str, Any]]:
    """These columns of the points of a load program; all but stages are numbers."""
    with (folder / "program.csv").open(newline="", encoding="utf-8") as file:
        return [
            {key: row[key] if key == "stage" else float(row[key]) for key in columns}
            for row in csv.DictReader(file)
        ]


def curve(
    name: str, ratio: int, proportions: Proportions, keys: list[str], options: argparse.Namespace
) -> tuple[list[dict[str, Any]], float]:
    """Rows of the curve of size 17, and the seconds of the run."""
    design = design_file(name, FITTED_SIZE, ratio, break_points(FITTED_SIZE)[1], proportions)
    summary = run(FOLDER / name, design, keys, options.ranks, MESH, plain=False)
    rows = [{"ratio": ratio} | row for row in program_rows(FOLDER / name, CURVE[1:])]
    return rows, summary.wall_s


def fit(options: argparse.Namespace) -> None:
    """Runs of the fit."""
    for case, proportions in CASES.items():
        rows = read_results("catalogue_fit")
        if any(row["case"] == case for row in rows) and not options.again:
            continue
        keys = stiffness_keys(TOP * break_points(FITTED_SIZE)[1], 1)
        name = "fit_" + re.sub("[^a-z0-9]+", "_", case)
        points, seconds = curve(name, FITTED_RATIO, proportions, keys, options)
        row = {"case": case, "wall_s": round(seconds, 1)}
        row |= {name: getattr(proportions, name) for name in PROPORTIONS}
        row |= Curve.of(points).stiffness(FITTED_SIZE)
        rows = [other for other in rows if other["case"] != case] + [row]
        write_fit(rows)


def write_fit(rows: list[dict[str, Any]]) -> None:
    """Write the runs of the fit, and how well it is determined."""
    write_results("catalogue_fit", FIT, rows, tables.fit(rows), page="catalogue")
    put(PAGE, "catalogue_determined", tables.determined(rows))


def bent(options: argparse.Namespace) -> None:
    """Curves at all ratios, with rims that are bent alike."""
    write_curves("catalogue_bent", "bent", bent_alike, options)
    put(PAGE, "catalogue_rotations", tables.rotations(read_results("catalogue_bent")))


def curves(options: argparse.Namespace) -> None:
    """Curves at all ratios, with rims in proportion to the diameter."""
    write_curves("catalogue_curves", "ratio", lambda _: FITTED, options)


def write_curves(
    table: str, name: str, proportions: Callable[[int], Proportions], options: argparse.Namespace
) -> None:
    """Curves of size 17 at all ratios.

    table : name of the results;  name : of the runs, before the ratio
    proportions : of a ratio
    """
    for ratio in options.ratios:
        rows = read_results(table)
        top = largest_torque()
        reached = max((row["torque_Nm"] for row in rows if row["ratio"] == ratio), default=0.0)
        if reached > (1.0 - ROUNDED) * top and not options.again:
            continue
        keys = stiffness_keys(top, 3)
        found, _ = curve(f"{name}_{ratio}", ratio, proportions(ratio), keys, options)
        rows = [row for row in rows if row["ratio"] != ratio] + found
        rows.sort(key=lambda row: (row["ratio"], row["torque_Nm"]))
        write_results(table, CURVE, rows, tables.stiffness(rows), page="catalogue")


def held(options: argparse.Namespace) -> None:
    """The starter's structure with play, at several ratios: what the input would have to yield."""
    for ratio in options.ratios:
        rows = read_results("catalogue_input")
        if any(row["ratio"] == ratio for row in rows) and not options.again:
            continue
        keys = stiffness_keys(TOP * break_points(FITTED_SIZE)[1], 1)
        points, seconds = curve(f"input_{ratio}", ratio, WITH_PLAY, keys, options)
        row = {"ratio": ratio, "wall_s": round(seconds, 1)}
        row |= Curve.of(points).stiffness(FITTED_SIZE)
        rows = sorted([*(r for r in rows if r["ratio"] != ratio), row], key=lambda r: r["ratio"])
        write_results("catalogue_input", HELD, rows, tables.held(rows), page="catalogue")


def losses(_: argparse.Namespace) -> None:
    """Tables of the losses, which follow from the published ones of size 17."""
    put(PAGE, "catalogue_losses", tables.losses())
    put(PAGE, "catalogue_operation", tables.operation())


def designs(options: argparse.Namespace) -> None:
    """Design files of drivers/catalogue."""
    for ratio in options.ratios:
        for size in SIZES:
            table = catalogue_design(size, ratio, break_points(size)[1], bent_alike(ratio))
            head = (
                f"# A drive of catalogue size {size} with ratio {ratio}: docs/verification/"
                "catalogue.md. Written by scripts/bench/catalogue.\n"
            )
            path = DRIVES / f"size_{size}_ratio_{ratio}.toml"
            path.write_text(head + tomli_w.dumps(table), "utf-8")


ACTIONS = {
    "fit": fit,
    "bent": bent,
    "curves": curves,
    "input": held,
    "losses": losses,
    "designs": designs,
}


def main(arguments: Sequence[str] | None = None) -> None:
    """Compute what is missing, and write the page."""
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument(
        "--what", nargs="+", choices=ACTIONS, default=["fit", "bent", "curves", "input", "losses"]
    )
    options.add_argument("--ratios", nargs="+", type=int, default=list(RATIOS))
    options.add_argument("--ranks", type=int, default=2)
    options.add_argument("--again", action="store_true", help="compute rows that are there too")
    chosen = options.parse_args(arguments)
    for name in chosen.what:
        ACTIONS[name](chosen)


if __name__ == "__main__":
    main()
