"""Estimated over true error of the largest tension at the teeth, of many drives in their loaded
state.

The true error is the distance from a reference: a mesh of the drive with four times the elements in
every direction (cup drive: 1.5 times), and one window more, with smaller elements than the last
usual one. A second reference between the two tells how well the first one is known. Finished drives
are stored and not computed again.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
from pathlib import Path
from statistics import median
from typing import Any

from page import markdown, put, write_results

from support.commands import environment, on_ranks
from support.drive_groups import CUP, PLANE, Case, cams

OUT = Path("results/bench/effectivity.jsonl")

TIMES = {"plane": (4.0, 2.25), "cup": (1.5, 1.25)}
"""Elements of the references' drive meshes in every direction, over those of the usual one."""

LEAST, MOST = 0.5, 3.0
"""Ratios of estimated and true error that are good."""

MESHES = {"plane": "plane_coarse", "cup": "forces"}

HEAD = [
    "drive",
    "s1",
    "by windows",
    "by the drive's mesh",
    "estimate",
    "true error",
    "±",
    "ratio",
    "true error, %",
]

COLUMNS = (
    "drive",
    "s1",
    "error",
    "drive_error",
    "estimate",
    "reference",
    "uncertain",
    "true",
    "ratio",
    "edge",
    "pressure",
)
COLUMNS += ("reference_pressure", "wall_s", "reference_wall_s")


def scaled(module: float, teeth: int, torque: float = 2.0, **more: Any) -> Case:
    """The plane reference drive with another module and number of teeth, in proportion. torque :
    N·m of that one"""
    size = teeth / 120
    arcs = {
        "type": "quadruple_arc",
        "r_tip": 0.3,
        "r_addendum": 1.0,
        "straight_l": 0.2,
        "r_dedendum": 2.0,
    }
    profile = {
        **{key: v if key == "type" else v * module for key, v in arcs.items()},
        "r_root": 0.3 * module,
    }
    case = {
        "drive.module": module,
        "drive.teeth_fs": teeth,
        "drive.teeth_rg": teeth + 2,
        "drive.face_width": 10.0 * module,
        "wave_generator.face_width": 10.0 * module,
        "flexible_spline.rim": round(size * module, 4),
        "ring_gear.rim": 2.0 * module,
        "flexible_spline.profile": profile,
        "ring_gear.profile": profile,
        "load.torque": round(torque * module**3 * size, 6),
    }
    return {**case, **more}


def profile(**values: Any) -> Case:
    """A profile for both gears."""
    return {"flexible_spline.profile": values, "ring_gear.profile": dict(values)}


def involutes(pressure_angle: float, cutter_radius: float) -> Case:
    """Involutes of both gears."""
    involute = {
        "type": "involute",
        "pressure_angle": pressure_angle,
        "cutter_radius": cutter_radius,
    }
    return {
        "flexible_spline.profile": involute,
        "ring_gear.profile": {**involute, "cutter_teeth": 80},
    }


def drives() -> dict[str, tuple[str, Case]]:
    """Model and values of the design file by name."""
    arcs = {
        "type": "quadruple_arc",
        "r_tip": 0.5,
        "r_addendum": 1.0,
        "straight_l": 0.0,
        "r_dedendum": 20.0,
        "r_root": 0.6,
    }
    double = {"flexible_spline.c_l": 0.0, "ring_gear.c_l": 0.0}
    plane: dict[str, Case] = {
        "elliptical cam": {},
        "10 N·m": {"load.torque": 10.0},
        "20 N·m": {"load.torque": 20.0},
        "no torque": {"load.torque": 0.0},
        "spline fixed": {"drive.layout": "spline_fixed"},
        "rim 0.6 mm": {"flexible_spline.rim": 0.6},
        "rim 1.4 mm": {"flexible_spline.rim": 1.4},
        "improved quadruple arc": profile(**arcs),
        "double arc": {**profile(type="double_arc", r_addendum=1.0, r_dedendum=0.5), **double},
        "improved double arc": {
            **profile(type="double_arc", r_addendum=1.0, r_dedendum=0.6),
            **double,
        },
        "involute": involutes(20.0, 0.2),
        "involute, 20 N·m": involutes(20.0, 0.2) | {"load.torque": 20.0},
        "involute, 25 degrees": involutes(25.0, 0.2),
        "60 teeth": scaled(1.0, 60),
        "80 teeth, module 0.5": scaled(0.5, 80),
        "100 teeth, module 0.2": scaled(0.2, 100, 5.0),
        "160 teeth": scaled(1.0, 160, 4.0),
        "200 teeth, module 0.3": scaled(0.3, 200, 4.0),
        "100 teeth, module 1.5": scaled(1.5, 100),
        "200 teeth, thick rim": scaled(1.0, 200, 4.0, **{"flexible_spline.rim": 2.2}),
    }
    wanted = (
        "simplified,C=0.8",
        "simplified,C=0.95",
        "elliptical,C=0.9",
        "parabolic",
        "four_roller",
    )
    plane |= {
        name: case for name, case in cams().items() if name in (*wanted, "turned_parabolas=0.5")
    }
    cup: dict[str, Case] = {
        "cup": {},
        "cup, 10 N·m": {"load.torque": 10.0},
        "cup, parabolic cam": {"wave_generator": {**cams()["parabolic"]["wave_generator"]}},
    }
    return {name: ("plane", case) for name, case in plane.items()} | {
        name: ("cup", case) for name, case in cup.items()
    }


def case_of(model: str, values: Case, times: float | None = None) -> dict[str, Any]:
    """A case of `effectivity_case.py`. times : of a reference; None for the usual run"""
    return {
        "design": str(PLANE if model == "plane" else CUP),
        "overrides": values,
        "mesh": MESHES[model],
        "times": times or 1.0,
        "further": 1 if times else None,
    }


def solve(case: dict[str, Any], ranks: int) -> dict[str, Any]:
    """Run one case; ends the benchmark where it fails."""
    command = [
        *on_ranks(ranks),
        sys.executable,
        str(Path(__file__).with_name("effectivity_case.py")),
        json.dumps(case),
    ]
    done = subprocess.run(command, capture_output=True, text=True, env=environment())
    if done.returncode:
        raise SystemExit(f"{case}: {done.stderr or done.stdout}")
    return json.loads(done.stdout.splitlines()[-1])


def stored() -> dict[str, dict[str, Any]]:
    """Finished drives by name."""
    lines = OUT.read_text(encoding="utf-8").splitlines() if OUT.exists() else []
    return {found["drive"]: found for found in map(json.loads, lines)}


def row(found: dict[str, Any]) -> dict[str, Any]:
    """Estimate and true error of one drive."""
    usual, (reference, other) = found["usual"], found["references"]
    estimate, true = (
        math.hypot(usual["error"], usual["drive_error"]),
        abs(usual["s1"] - reference["s1"]),
    )
    values = {
        key: usual[key] for key in ("s1", "error", "drive_error", "edge", "pressure", "wall_s")
    }
    values |= {"reference": reference["s1"], "reference_pressure": reference["pressure"]}
    values |= {"uncertain": abs(reference["s1"] - other["s1"])}
    values |= {
        "estimate": estimate,
        "true": true,
        "ratio": estimate / true,
        "reference_wall_s": reference["wall_s"],
    }
    return {"drive": found["drive"], **values}


def table(rows: list[dict[str, Any]]) -> str:
    """The page's table, and how many ratios are within the promise."""
    cells = [HEAD]
    for one in rows:
        numbers = (one["s1"], one["error"], one["drive_error"], one["estimate"], one["true"])
        numbers = (*numbers, one["uncertain"], one["ratio"])
        name = one["drive"] + (" *" if one["edge"] else "")
        cells.append(
            [name, *(f"{value:.2f}" for value in numbers), f"{100 * one['true'] / one['s1']:.2f}"]
        )
    within = sum(LEAST <= one["ratio"] <= MOST for one in rows)
    ranges = [ratio_range(one) for one in rows]
    below = sum(high < LEAST for _, high in ranges)
    above = sum(low > MOST for low, _ in ranges)
    words = f"Ratios between {LEAST:g} and {MOST:g}: {within} of {len(rows)}.\n"
    words += (
        f"As far as the references tell: {len(rows) - below - above}, below {below}, above "
        f"{above}.\n"
    )
    return markdown(cells) + "\n" + words


def ratio_range(one: dict[str, Any]) -> tuple[float, float]:
    """Least and largest ratio that the uncertainty of the true error allows."""
    least, most = one["true"] - one["uncertain"], one["true"] + one["uncertain"]
    return one["estimate"] / most, one["estimate"] / least if least > 0.0 else math.inf


def nodal_table(done: dict[str, dict[str, Any]]) -> str:
    """The page's table of nodal averages: estimated over true errors of all drives, by column of
    the history."""
    head = ["stress", "drives", "true error, %: middle", "largest", "ratio: middle"]
    cells = [[*head, "0.5 to 3", "below", "above", "0.5 to 3 as far as the references tell"]]
    names = dict.fromkeys(name for one in done.values() for name in one["usual"]["nodal_errors"])
    for name in names:
        ratios, errors, told = [], [], 0
        for one in done.values():
            usual, reference = one["usual"], one["references"][0]["nodal"]
            if name not in usual["nodal_errors"] or name not in reference:
                continue
            true = abs(usual["nodal"][name] - reference[name])
            ratios.append(usual["nodal_errors"][name] / true)
            other = one["references"][1]["nodal"].get(name, reference[name])
            low, high = ratio_range(
                {
                    "estimate": usual["nodal_errors"][name],
                    "true": true,
                    "uncertain": abs(reference[name] - other),
                }
            )
            told += high >= LEAST and low <= MOST
            errors.append(100.0 * true / reference[name])
        if ratios:
            counts = [
                sum(0.5 <= r <= 3.0 for r in ratios),
                sum(r < 0.5 for r in ratios),
                sum(r > 3.0 for r in ratios),
            ]
            numbers = [f"{median(errors):.1f}", f"{max(errors):.1f}", f"{median(ratios):.2f}"]
            cells.append(
                [name.replace("_", " "), str(len(ratios)), *numbers, *map(str, (*counts, told))]
            )
    return markdown(cells)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument(
        "--only", nargs="+", choices=list(drives()), default=list(drives()), metavar="DRIVE"
    )
    options.add_argument("--ranks", type=int, default=2)
    arguments = options.parse_args()
    OUT.parent.mkdir(parents=True, exist_ok=True)
    for name in arguments.only:
        if name in stored():
            continue
        model, values = drives()[name]
        usual, *references = (
            solve(case_of(model, values, times), arguments.ranks) for times in (None, *TIMES[model])
        )
        line = json.dumps({"drive": name, "usual": usual, "references": references})
        with OUT.open("a", encoding="utf-8") as file:
            file.write(line + "\n")
        print(json.dumps(row(json.loads(line))), flush=True)
    done = stored()
    rows = [row(done[name]) for name in drives() if name in done]
    if len(rows) < len(drives()):
        return
    write_results("effectivity", COLUMNS, rows, table(rows))
    put(Path("docs/verification/effectivity.md"), "nodal", nodal_table(done))


if __name__ == "__main__":
    main()
