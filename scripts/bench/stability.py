"""Drives under numerical stress: every group is a study of designs on a small mesh; out comes what converged.

A case ends in one of three ways: it converges, it is refused by one sentence before anything is computed, or it fails
(does not converge). The table has, by group, their numbers, the largest mean of Newton's iterations per increment, and
the largest torque that is left unbalanced over the output's torque; cases.csv has every case, failures with their
sentence. Random designs are drawn by seed, until as many as asked for can be built.
"""

from __future__ import annotations

import argparse
import csv
import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from swgpar.design import make_design
from swgpar.design_file import apply_overrides, read_toml
from swgpar.errors import InputError
from swgpar.meshing import build_sector_meshes, load_recipe

ROOT = Path(__file__).resolve().parents[2]
PLANE, CUP = ROOT / "drivers/plane_half_turn.toml", ROOT / "tests/data/small.toml"
MESH = ROOT / "tests/data/tiny.toml"
SHORT = ("steps.rotation=2.0", "steps.increment=1.0")

Cases = dict[str, list[str]]


def each(key: str, values: list[float]) -> Cases:
    return {f"{key.rpartition('.')[2]}={value:g}": [f"{key}={value}"] for value in values}


def units() -> Cases:
    """The same drive in mm and N, m and N, inch and pound; torques are a thousandth of the unit of the stresses."""
    table, cases = read_toml(CUP), {}
    lengths = [
        *(f"{s}.{k}" for s, k in (("drive", "module"), ("drive", "face_width"), ("wave_generator", "face_width"))),
        *(f"cup.{k}" for k in ("length", "fillet_radius", "inner_radius")),
        *(f"micro_geometry.{k}" for k in ("wg_crowning", "wg_slope", "fs_crowning")),
        *(f"{g}.profile.{k}" for g in ("flexible_spline", "ring_gear") for k in table[g]["profile"] if k != "type"),
        "flexible_spline.rim",
        "ring_gear.rim",
    ]
    for name, length, force in (
        ("mm_N", 1.0, 1.0),
        ("m_N", 1e-3, 1.0),
        ("inch_lbf", 1 / 25.4, 1 / 4.448222),
        ("km_MN", 1e-6, 1e-6),
    ):
        overrides = []
        for key in lengths:
            value: Any = table
            for part in key.split("."):
                value = value[part]
            overrides.append(f"{key}={value * length!r}")
        overrides.append(f"material.E={table['material']['E'] * force / length**2!r}")
        overrides.append(f"load.torque={table['load']['torque'] * force * length!r}")
        cases[name] = overrides
    return cases


def random_designs(count: int, seed: int) -> Cases:
    """Plane drives with any profile and cam, some with friction, backlash or the other layout."""
    rng, cases = np.random.default_rng(seed), {}
    recipe, base = load_recipe(MESH), read_toml(PLANE)
    drawn = 0
    while len(cases) < count:
        drawn += 1
        overrides = _draw(rng)
        try:
            design = make_design(apply_overrides(base, overrides))
            build_sector_meshes(design, recipe)
        except InputError:
            continue
        cases[f"r{drawn:04d}"] = overrides
    print(f"{drawn} designs drawn for {count} that can be built", flush=True)
    return cases


def _draw(rng: np.random.Generator) -> list[str]:
    def number(low: float, high: float) -> float:
        return round(float(rng.uniform(low, high)), 4)

    teeth = 2 * int(rng.integers(20, 120))
    module = float(rng.choice([0.3, 0.5, 1.0, 2.0]))
    kind = rng.choice(["quadruple_arc", "double_arc", "involute"], p=[0.6, 0.2, 0.2])
    profile = {
        "quadruple_arc": lambda: {
            "type": "quadruple_arc",
            "r_tip": number(0.2, 0.5) * module,
            "r_addendum": number(0.9, 2.0) * module,
            "straight_l": number(0.0, 0.3) * module,
            "r_dedendum": number(0.8, 20.0) * module,
            "r_root": number(0.2, 0.6) * module,
        },
        "double_arc": lambda: {
            "type": "double_arc",
            "r_addendum": number(0.9, 2.0) * module,
            "r_dedendum": number(0.3, 0.7) * module,
        },
        "involute": lambda: {"type": "involute", "cutter_radius": number(0.1, 0.25) * module},
    }[kind]()
    ring = {**profile, "cutter_teeth": teeth // 2} if kind == "involute" else profile
    width = 10.0 * module
    a = 0.5 * teeth * module
    cam = {
        "elliptical": lambda: {"C": number(0.9, 1.0)},
        "simplified": lambda: {"C": number(0.85, 0.98)},
        "parabolic": lambda: {"C": 1.0, "a_p": number(0.4, 0.6) / a, "C_p": number(0.3, 0.55), "r_c": 0.17 * a},
        "four_roller": lambda: {"beta": number(10.0, 25.0), "r_4": number(0.1, 0.16) * a},
    }
    cam_kind = str(rng.choice(list(cam)))
    wave = {"type": cam_kind, **cam[cam_kind](), "face_width": width}
    return [
        f"drive.teeth_fs={teeth}",
        f"drive.teeth_rg={teeth + 2}",
        f"drive.module={module}",
        f"drive.face_width={width}",
        f"drive.layout={rng.choice(['ring_fixed', 'spline_fixed'])}",
        f"flexible_spline.rim={number(0.5, 1.6) * module * teeth / 120}",
        f"ring_gear.rim={2.0 * module}",
        f"ring_gear.c_P={1.0 if kind == 'involute' else number(0.85, 1.0)}",
        f"flexible_spline.profile={_inline(profile)}",
        f"ring_gear.profile={_inline(ring)}",
        f"flexible_spline.c_l={0.0 if kind == 'double_arc' else 0.5}",
        f"ring_gear.c_l={0.0 if kind == 'double_arc' else 0.5}",
        *(f"wave_generator.{k}={json.dumps(v)}" for k, v in wave.items()),
        f"load.torque={number(0.0, 4.0) * module**3 * teeth / 120}",
        f"contact.friction={float(rng.choice([0.0, 0.0, 0.1, 0.3]))}",
    ]


def _inline(table: dict[str, Any]) -> str:
    return "{ " + ", ".join(f"{key} = {json.dumps(value)}" for key, value in table.items()) + " }"


def groups(count: int, seed: int) -> dict[str, tuple[Path, Callable[[], Cases]]]:
    """Design and cases of every group."""
    decades = [0.5, 5.0, 50.0, 500.0, 5000.0]
    rotations = [0.1, 0.3, 1.0, 3.0, 10.0]
    return {
        "Poisson's ratio, cup": (CUP, lambda: each("material.nu", [0.0, 0.3, 0.45, 0.49, 0.499])),
        "units, cup": (CUP, units),
        "penalty of the flanks, cup": (CUP, lambda: each("contact.penalty_coef", decades)),
        "penalty of the cam, cup": (CUP, lambda: each("contact.wg_penalty_coef", [c / 10.0 for c in decades])),
        "penalty without augmentation, plane": (
            PLANE,
            lambda: {k: [*v, "contact.max_augmentations=0"] for k, v in each("contact.penalty_coef", decades).items()},
        ),
        "increments, plane": (
            PLANE,
            lambda: {f"increment={a:g}": [f"steps.increment={a}", f"steps.rotation={2 * a}"] for a in rotations},
        ),
        "backlash, plane": (PLANE, lambda: each("ring_gear.c_P", [0.8, 0.85, 0.9, 0.95, 0.98, 1.0, 1.01])),
        "friction, plane": (PLANE, lambda: each("contact.friction", [0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5])),
        "friction, cup": (CUP, lambda: each("contact.friction", [0.0, 0.1, 0.3, 0.5])),
        "rim, plane": (PLANE, lambda: each("flexible_spline.rim", [0.18, 0.3, 0.5, 1.0, 1.5, 2.0, 3.0])),
        "torque, plane": (PLANE, lambda: each("load.torque", [0.0, 0.01, 1.0, 10.0, 50.0, 100.0, 200.0, 500.0])),
        "teeth, plane": (
            PLANE,
            lambda: {
                f"teeth={n}": [f"drive.teeth_fs={n}", f"drive.teeth_rg={n + 2}", f"flexible_spline.rim={n / 120}"]
                for n in (20, 30, 40, 60, 80, 120, 160, 200, 320)
            },
        ),
        "face width (aspect ratio), cup": (
            CUP,
            lambda: {
                f"width={w:g}": [f"drive.face_width={w}", f"wave_generator.face_width={w}"]
                for w in (0.2, 1.0, 4.0, 20.0, 60.0, 200.0)
            },
        ),
        "random designs, plane": (PLANE, lambda: random_designs(count, seed)),
    }


def run_group(name: str, design: Path, cases: Cases, out: Path, ranks: int) -> list[dict[str, Any]]:
    """Run one group as a study; a row for every case."""
    folder = out / name.replace(" ", "_").replace(",", "").replace("'", "")
    folder.mkdir(parents=True, exist_ok=True)
    extra = ["output.fields=false"]
    text = [
        f"[study]\ntitle = {json.dumps(name)}\ndesign = {json.dumps(str(design))}\nmeshes = {json.dumps([str(MESH)])}"
    ]
    for case, overrides in cases.items():
        steps = [] if any(o.startswith("steps.") for o in overrides) else SHORT
        text.append(f"[[study.case]]\nname = {json.dumps(case)}\nset = {json.dumps([*overrides, *steps, *extra])}")
    study = folder / "study.toml"
    study.write_text("\n\n".join(text) + "\n", encoding="utf-8")
    command = ["mpirun", "-n", str(ranks), sys.executable, "-m", "swgpar.cli", "study", str(study)]
    result = folder / "results"
    with (folder / "log.txt").open("w") as log:
        subprocess.run([*command, "--out", str(result), "--overwrite"], stdout=log, stderr=log)
    rows = []
    with (result / "study.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            found = {"group": name, "case": row["case"], "status": row["status"], "newton_mean": row["newton_mean"]}
            found |= {"fs_s1": row["mean.fs_s1"], "wall_s": row["wall_s"], "balance": "", "reason": row["reason"]}
            if row["status"] == "failed":
                found["status"] = "refused" if "allowed" in row["reason"] else "failed"
            else:
                summary = json.loads(next((result / "cases" / row["case"]).rglob("summary.json")).read_text())
                torque = max(1000.0 * summary["design"]["load"]["torque"], 1e-300)
                found["balance"] = summary["balance_error_Nmm"] / torque if torque > 1e-200 else ""
            rows.append(found)
    return rows


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--out", default="results/bench/stability")
    options.add_argument("--tables", default="docs/benchmarks")
    options.add_argument("--ranks", type=int, default=2)
    options.add_argument("--random", type=int, default=200, help="number of random designs")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--only", nargs="+", default=None, help="words of the names of the groups to run")
    arguments = options.parse_args()
    rows: list[dict[str, Any]] = []
    tables = Path(arguments.tables)
    tables.mkdir(parents=True, exist_ok=True)
    header = "".join(f"{word:>9s}" for word in ("converged", "refused", "failed"))
    print(f"{'group':40s}{header} {'Newton':>7s} {'unbalanced':>11s}")
    for name, (design, make) in groups(arguments.random, arguments.seed).items():
        if arguments.only and not any(word in name for word in arguments.only):
            continue
        found = run_group(name, design, make(), Path(arguments.out).resolve(), arguments.ranks)
        rows += found
        count = {s: sum(r["status"] == s for r in found) for s in ("finished", "refused", "failed")}
        newton = max((float(r["newton_mean"]) for r in found if r["newton_mean"]), default=0.0)
        balance = max((float(r["balance"]) for r in found if r["balance"] != ""), default=0.0)
        counted = "".join(f"{count[s]:9d}" for s in count)
        print(f"{name:40s}{counted} {newton:7.1f} {balance:11.1e}", flush=True)
        with (tables / "stability.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main()
