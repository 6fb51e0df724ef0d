"""Right files of all kinds, from which bad inputs are made."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any

from support.paths import DESIGN, DRIVERS, RECIPE, REFERENCE
from support.small_drive import PLANE
from support.small_trains import SMALL
from swgpar.input.toml_file import apply_overrides, read_toml
from swgpar.meshing.recipe import RECIPES, recipe_path

Table = dict[str, Any]


def _drives() -> list[Table]:
    cup, small, plane = (
        read_toml(path) for path in (REFERENCE, DESIGN, DRIVERS / "plane_half_turn.toml")
    )
    flat = apply_overrides(small, PLANE)
    arcs = {"type": "double_arc", "r_addendum": 0.6, "r_dedendum": 0.3}
    involute = {"type": "involute", "cutter_radius": 0.1}
    waves = [
        {"type": "simplified", "C": 0.9},
        {"type": "elliptical", "C": 0.95},
        {"type": "arcs", "beta": 45.0},
        {"type": "parabolic", "C": 1.0, "a_p": 0.0097, "C_p": 0.51, "r_c": 10.0},
        {"type": "four_roller", "beta": 25.0, "r_4": 15.0},
    ]
    changed: list[Table] = [{"wave_generator": {**wave, "face_width": 10.0}} for wave in waves]
    changed += [
        {
            "flexible_spline.profile": involute,
            "ring_gear.profile": {**involute, "cutter_teeth": 60},
        },
        {"flexible_spline.profile": arcs, "ring_gear.profile": arcs},
        {"fatigue": {}, "losses": {"bearing_diameter": 30.0}},
        {"stiffness": {"torque": 20.0}},
        {"ratcheting": {"limit": 0.5}},
        {
            "deviations": {
                "turns": 2,
                "seed": 3,
                "ring_gear": {"pitch_grade": 5, "eccentricity": 0.01},
            }
        },
        {"load.program": [{"name": "up", "torque": 5.0}, {"name": "back", "output_rotation": 0.1}]},
        {"contact": {"friction": 0.1}, "steps": {"samples": 4}},
    ]
    newer = [apply_overrides(small, change) for change in _newer_sections()]
    return [
        *(cup, small, plane, flat),
        *(apply_overrides(plane, change) for change in changed),
        *newer,
        read_toml(DRIVERS / "rating.toml"),
        read_toml(DRIVERS / "pancake.toml"),
    ]


def _newer_sections() -> list[Table]:
    """Changes of the small cup drive, each with a section or a kind of curve."""
    steel = {"E": 205e3, "nu": 0.3, "density": 7850.0, "expansion": 1.2e-5}
    bearing = {"balls": 20, "ball_diameter": 2.0, "race_thickness": 0.5, "race_interference": 0.01}
    output = {
        "radial_stiffness": 1e5,
        "axial_stiffness": 1e5,
        "tilting_stiffness": 1e4,
        "radial_force": 10.0,
        "tilting_moment": 0.1,
    }
    polar = {
        "type": "polar",
        "radius": "a - (a - b) * sin(theta)**2 * k",
        "parameters": {"k": 1.0},
        "face_width": 4.0,
    }
    cycloid = {"type": "cycloid", "r_epicycloid": 1.0, "r_hypocycloid": 1.0, "r_root": 0.3}
    return [
        {"wave_generator.bearing": bearing, "micro_geometry.wg_slope": 0.0},
        {"ring_gear.housing": {"thickness": 4.0, "outside": "held"}},
        {"output_bearing": output},
        {"material": steel, "frequencies": {"number": 4}},
        {"material": steel, "flexible_spline.temperature": 60.0, "ring_gear.temperature": 40.0},
        {"rating": {"rated_torque": 2.0, "momentary_torque": 4.0, "K1": 1.0, "efficiency": 0.7}},
        {"wave_generator": polar},
        {"flexible_spline.profile": cycloid, "ring_gear.profile": cycloid},
        {"steps": {"samples": 4}, "losses": {"bearing_diameter": 15.0, "flank_friction": 0.05}},
    ]


def _trains() -> list[Table]:
    names = (
        "cascade",
        "gear_pair",
        "planetary",
        "planetary_stage",
        "ring_modes",
        "ring_moving_load",
        "ring_supported",
    )
    found = {
        name: apply_overrides(
            {**read_toml(DRIVERS / f"{name}.toml"), "published": {}}, SMALL.get(name, ())
        )
        for name in names
    }
    stage = found["planetary_stage"]
    mesh = {
        "sun_stiffness": 4e9,
        "ring_stiffness": 6e9,
        "variation": 0.1,
        "sun_contact_ratio": 1.6,
        "ring_contact_ratio": 1.9,
        "phase": 0.1,
    }
    given = {**stage, "mesh": {**stage["mesh"], **mesh}}
    given["errors"] = {"pin_radial": [10.0, 0.0, -5.0, 0.0], "planet_eccentricity": 4 * [10.0]}
    del given["teeth"]
    return [*found.values(), given]


def _studies() -> list[Table]:
    plane, pair = str(DRIVERS / "plane_half_turn.toml"), str(DRIVERS / "gear_pair.toml")
    grid = {
        "design": plane,
        "meshes": ["plane_coarse"],
        "vary": {"load.torque": [1.0, 2.0], "material.nu": [0.3]},
    }
    case = {
        "name": "one",
        "set": ["load.torque=1"],
        "published": {"mean.fs_s1": 300.0},
        "tolerance": {"mean.fs_s1": 5},
    }
    cases = {
        "title": "cases",
        "design": plane,
        "meshes": [str(RECIPE)],
        "quantities": ["mean.fs_vm"],
        "case": [case],
    }
    trains = {
        "design": pair,
        "mode": "sweep",
        "vary": {"mesh.half_backlash": [10.0, 20.0], "load.noise": [50.0, 60.0]},
    }
    return [{"study": study} for study in (grid, cases, trains)]


def _searches() -> list[Table]:
    variables = [
        {"keys": ["mesh.stiffness"], "low": 1e9, "high": 1e11, "log": True},
        {"keys": ["gear_1.mass", "gear_2.mass"], "choices": [50.0, 100.0]},
    ]
    search = {
        "design": str(DRIVERS / "gear_pair.toml"),
        "set": ["monte_carlo.samples=20"],
        "evaluations": 12,
        "sampler": "tpe",
        "first": [{"mesh.stiffness": 2e9}],
        "variable": variables,
        "objective": [{"quantity": "natural frequency 2 (rad/s)", "goal": "maximise"}],
        "constraint": [{"quantity": "damping ratio 1", "at_most": 0.5}],
    }
    of_case = {
        "load_case": [
            {"name": "loud", "set": ["load.noise=50.0"]},
            {"name": "bare", "rate": False, "without": ["published"]},
        ],
        "objective": [{"case": "loud", **search["objective"][0]}],
        "constraint": [{"case": "bare", **search["constraint"][0]}],
    }
    return [{"optimise": search}, {"optimise": {**search, **of_case}}]


def curve_file() -> bytes:
    """Points of a cam for the small drive: an ellipse."""
    angles = [2.0 * math.pi * k / 120 for k in range(120)]
    rows = (f"{18.2 * math.cos(t):.6f}, {19.4 * math.sin(t):.6f}" for t in angles)
    return "\n".join(["x, y", *rows]).encode()


def pitch_file() -> bytes:
    return "\n".join(["tooth,pitch", *(f"{k},{math.sin(k):.3f}" for k in range(42))]).encode()


@functools.cache
def right_files() -> dict[str, list[Table]]:
    """Tables of right files by kind."""
    return {
        "drive": _drives(),
        "gear train": _trains(),
        "mesh recipe": [*(read_toml(recipe_path(name)) for name in RECIPES), read_toml(RECIPE)],
        "study": _studies(),
        "optimisation": _searches(),
    }


@dataclass(frozen=True)
class NewerSection:
    """A right file with a section of its own. kind : of the file;  keys : beginnings of the keys
    that are changed, with dots; none: all"""

    kind: str
    table: Table
    keys: tuple[str, ...] = ()


@functools.cache
def newer_sections() -> dict[str, NewerSection]:
    """Files whose newer sections alone are changed, by what they have."""
    cup = read_toml(DESIGN)
    plane = apply_overrides(cup, PLANE)
    steel = {"E": 205e3, "nu": 0.3, "density": 7850.0, "expansion": 1.2e-5}
    bearing = {"balls": 20, "ball_diameter": 2.0, "race_thickness": 0.5, "clearance": 0.002}
    program = [
        {"name": "up", "torque": 0.2, "points": 3},
        {"name": "turn", "torque": 0.2, "wave_generator": 4.0, "points": 3},
        {"name": "back", "output_rotation": 0.1},
    ]
    steps = {"samples": 4}
    small: dict[str, Table] = {
        "bearing": {"wave_generator.bearing": bearing, "micro_geometry.wg_slope": 0.0},
        "deviations": {
            "deviations": {
                "turns": 2,
                "seed": 3,
                "mesh": "same",
                "ring_gear": {"pitch_grade": 5, "eccentricity": 0.01},
                "flexible_spline": {"pitch_grade": 6},
                "wave_generator": {"eccentricity": 0.002},
            }
        },
        "fatigue": {"fatigue": {"surface_factor": 0.9}},
        "frequencies": {"material": steel, "frequencies": {"number": 4}},
        "housing": {"ring_gear.housing": {"thickness": 4.0, "outside": "held"}},
        "input_coupling": {
            "stiffness": {"torque": 0.2, "positions": 1},
            "input_coupling": {"stiffness": 40.0, "play": 0.2},
        },
        "losses": {"steps": steps, "losses": {"bearing_diameter": 15.0, "flank_friction": 0.05}},
        "output_bearing": {
            "output_bearing": {
                "radial_stiffness": 1e5,
                "axial_stiffness": 1e5,
                "tilting_stiffness": 1e4,
                "radial_force": 10.0,
                "tilting_moment": 0.1,
            }
        },
        "program": {"load.program": program},
        "ratcheting": {"ratcheting": {"limit": 0.5, "increment": 0.05}},
        "rating": {
            "rating": {"rated_torque": 2.0, "momentary_torque": 4.0, "K1": 1.0, "efficiency": 0.7}
        },
        "stiffness": {"stiffness": {"torque": 0.2, "positions": 1, "break_points": [0.2, 0.65]}},
        "temperatures": {
            "material": steel,
            "flexible_spline.temperature": 60.0,
            "ring_gear.temperature": 40.0,
            "load.reference_temperature": 20.0,
        },
    }
    of_cups = {"housing", "output_bearing", "bearing"}
    found = {
        name: NewerSection(
            "drive", apply_overrides(cup if name in of_cups else plane, change), tuple(change)
        )
        for name, change in small.items()
    }
    for table in _trains():
        train = table["gear_train"]["model"]
        number = sum(name.startswith(f"gear train, {train}") for name in found)
        name = f"gear train, {train}" + (f" {number + 1}" if number else "")
        found[name] = NewerSection("gear train", table)
    for number, table in enumerate(_searches(), 1):
        found[f"optimisation {number}"] = NewerSection("optimisation", table)
    return found
