"""Drives that a designer might draw up, at random: they can be built, their teeth clear each other,
and their torque is one that they can carry.

They serve `scripts/bench/effectivity`. Of every kind of profile, cam and shape some are drawn. A
seed and a number give the same drive whatever else is drawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from support.drawn_drive import CAMS, Case, draw
from support.paths import DRIVERS
from swgpar.checks.clearance import clearances
from swgpar.checks.design_file import make_drive
from swgpar.checks.starter_teeth import ADDENDUM, DEDENDUM, RIM_OF_HEIGHT
from swgpar.errors import InputError
from swgpar.input.toml_file import read_toml, with_value
from swgpar.meshing import build_sector_meshes, load_recipe

BASE = DRIVERS / "plane_half_turn.toml"
"""Design whose values a drawn drive replaces."""

MESHES = {"plane": "plane_coarse", "cup": "forces", "pancake": "forces"}

TEETH = (40, 240)
MODULES = (0.15, 1.5)
"""mm"""

TORQUE = (0.2, 1.0)
"""Torque over the one that the design allows."""

RIM_TENSION = {"plane": 20.0, "cup": 60.0, "pancake": 20.0}
"""MPa: mean tension in the rim by the torque that a design allows. The plane reference drive then
has 24 N·m, the cup reference drive 72 N·m."""

KINDS = (*CAMS, "harmonic", "arcs")
"""Cams that are drawn."""

SMOOTH = ("elliptical", "simplified", "harmonic", "arcs")
"""Cams of S-shaped and other teeth: on the path that parabolas and rollers give, most of them would
be too high."""

BACKLASH = (0.0, 0.01, 0.02, 0.03, 0.05, 0.08, 0.12, 0.2)
"""Thinner teeth of the ring gear that are tried, of the tooth's thickness; for involutes their
profile shift, for conjugate teeth the backlash over half of the pitch."""

CONJUGATE, THREE_LOBES = 0.1, 0.1
"""Shares of drives with conjugate teeth of the ring gear, and with three lobes."""

OTHER_TEETH = {"s_shaped": 0.7, "trapezoid": 0.12, "cycloid": 0.12, "common_tangent": 0.06}
"""Shares of the teeth that arcs and involutes have not."""

OF_THEIR_OWN, RELIEVED = 0.3, 0.5
"""Shares of S-shaped teeth whose ring gear has S-shaped teeth too, where that of the others is
conjugate, and of those with tip relief."""

SHAPES = ("cup", "cup", "short", "hat")
"""Shapes of the flexible spline of a cup drive."""

CUP_WIDTH, CUP_LENGTH = (0.15, 0.4), (1.0, 2.0)
"""Face width and length of a cup over its pitch radius; short ones have half of the length. The
reference cup has 0.17 and 0.67."""

YOUNG = 210e3
"""MPa, as the base design has."""

MOST_BENDING = 300.0
"""MPa: largest bending stress of the rim of a cup drive by the wave generator, of a ring of the
rim's thickness without teeth."""


@dataclass(frozen=True)
class SensibleDrive:
    """A drive that has been drawn.

    name : "p" (plane) or "c" (cup) and a number, with an "o" where the teeth are others than arcs
        and involutes;  model : "plane" or "cup"
    table : content of the design file;  kind : profile, cam, lobes, layout and shape in words
    """

    name: str
    model: str
    table: dict[str, Any]
    kind: str


def sensible_drives(
    count: int,
    seed: int,
    model: str = "plane",
    most_modelled: int | None = None,
    *,
    other_teeth: bool = False,
) -> list[SensibleDrive]:
    """The first `count` drives of a seed.

    most_modelled : drives of which more teeth of the flexible spline are modelled are left out
    other_teeth : whether teeth are those of `OTHER_TEETH`, not arcs and involutes
    """
    found: list[SensibleDrive] = []
    number = 0
    while len(found) < count:
        drive = _drive(seed, number, model, most_modelled, other_teeth)
        number += 1
        if drive is not None:
            found.append(drive)
    return found


def _drive(
    seed: int, number: int, model: str, most_modelled: int | None, other_teeth: bool
) -> SensibleDrive | None:
    """The drive of a number; None where its teeth overlap whatever their backlash, where it cannot
    be built, or where too much of it is modelled."""
    rng = np.random.default_rng((seed, number, len(model)))
    case = _case(rng, model, SMOOTH if other_teeth else KINDS)
    if other_teeth:
        case |= _other_teeth(rng, case, case["drive.module"])
    if most_modelled is not None and _modelled(case) > most_modelled:
        return None
    if model == "cup" and _bending(case) > MOST_BENDING:
        return None
    table = read_toml(BASE)
    for key, value in case.items():
        table = with_value(table, key, value)
    for backlash in BACKLASH:
        try:
            thinner = _with_backlash(table, backlash)
            design = make_drive(thinner)
            if any(one.overlaps for one in clearances(design.rigid_pairs)):
                continue
            build_sector_meshes(design.geometry, load_recipe(MESHES[model]))
        except InputError:
            continue
        name = f"{model[0]}{number:03d}{'o' * other_teeth}"
        return SensibleDrive(name, model, thinner, _words(thinner))
    return None


def _modelled(case: Case) -> float:
    """Teeth of the flexible spline that are modelled, as of `DriveDesign.copies`."""
    lobes = case["wave_generator"].get("lobes", 2)
    teeth = case["drive.teeth_fs"], case["drive.teeth_rg"]
    return teeth[0] / lobes if all(number % lobes == 0 for number in teeth) else teeth[0]


def _bending(case: Case) -> float:
    """MPa, by the curvature that a radial displacement of the deflection brings to a ring."""
    lobes = case["wave_generator"].get("lobes", 2)
    module = case["drive.module"]
    deflection = 0.5 * module * (case["drive.teeth_rg"] - case["drive.teeth_fs"])
    radius = 0.5 * case["drive.teeth_fs"] * module
    return 0.5 * YOUNG * case["flexible_spline.rim"] * (lobes**2 - 1) * deflection / radius**2


def _words(table: dict[str, Any]) -> str:
    """Kinds of profile, cam, lobes, layout and shape."""
    drive, wave = table["drive"], table["wave_generator"]
    profile = table["flexible_spline"]["profile"]["type"]
    if table["ring_gear"]["profile"]["type"] != profile:
        profile += " and " + table["ring_gear"]["profile"]["type"]
    words = [profile, wave["type"], f"{wave.get('lobes', 2)} lobes", drive["layout"]]
    if "cup" in table:
        words.append(table["cup"].get("shape", "cup"))
    return ", ".join(words).replace("_", " ")


def _case(rng: np.random.Generator, model: str, cams: Sequence[str]) -> Case:
    """Values of the design file. cams : kinds that are drawn"""
    teeth = int(rng.integers(TEETH[0], TEETH[1] + 1))
    module = round(float(np.exp(rng.uniform(*np.log(MODULES)))), 3)
    three = rng.uniform() < THREE_LOBES
    case = draw(rng, model, teeth, module, ("harmonic",) if three else cams)
    case["contact.friction"] = 0.0
    radius = 0.5 * teeth * module
    if model == "cup":
        width = round(radius * float(rng.uniform(*CUP_WIDTH)), 4)
        case["drive.face_width"] = case["wave_generator"]["face_width"] = width
    rim, width = case["flexible_spline.rim"], case["drive.face_width"]
    if three:
        case["drive.teeth_rg"] = teeth + 3
        case["wave_generator"]["lobes"] = 3
        case |= {"drive.pressure_angle": 14.0, "flexible_spline.rim": 0.5 * rim}
        # a taut band of three lobes: it is longer than the circle by 4 times as much
        case["wave_generator"]["C"] = 1.0 - (1.0 - case["wave_generator"]["C"]) * 0.3
    if rng.uniform() < CONJUGATE:
        case["ring_gear.profile"] = {"type": "conjugate", "r_root": 0.2 * module}
        case |= {"ring_gear.c_P": 1.0, "ring_gear.c_l": 0.5}
    allowed = 2.0 * RIM_TENSION[model] * width * case["flexible_spline.rim"] * radius
    allowed *= 1.5 if three else 1.0
    case["load.torque"] = round(1e-3 * allowed * float(rng.uniform(*TORQUE)), 6)
    if model == "cup":
        case["cup"]["length"] = round(radius * float(rng.uniform(*CUP_LENGTH)), 4)
        case["cup"] |= _shape(rng, str(rng.choice(SHAPES)), case, radius)
    return case


def _other_teeth(rng: np.random.Generator, case: Case, module: float) -> Case:
    """Values of teeth in place of those of a case."""
    modules = partial(_length, rng, module)
    kind = str(rng.choice(list(OTHER_TEETH), p=list(OTHER_TEETH.values())))
    # double arcs, which may be the teeth of the case, have none
    lines = {"flexible_spline.c_l": 0.5, "ring_gear.c_l": 0.5}
    if kind == "s_shaped":
        return lines | _s_shaped(rng, case, module)
    profile = {
        "trapezoid": lambda: {
            "flank_angle": round(float(rng.uniform(15.0, 30.0)), 4),
            "r_tip": modules(0.05, 0.2),
            "r_root": modules(0.15, 0.3),
        },
        "cycloid": lambda: {
            "r_epicycloid": modules(0.6, 1.5),
            "r_hypocycloid": modules(0.6, 1.5),
            "r_tip": modules(0.1, 0.2),
            "r_root": modules(0.2, 0.35),
        },
        "common_tangent": lambda: {
            "r_addendum": modules(0.9, 1.5),
            "c_addendum": modules(-0.2, 0.2),
            "e_addendum": modules(0.0, 0.2),
            "r_dedendum": modules(0.9, 1.5),
            "c_dedendum": modules(-0.2, 0.2),
            "e_dedendum": modules(0.0, 0.2),
            "r_root": modules(0.2, 0.35),
        },
    }[kind]()
    teeth = {"type": kind, **profile}
    return lines | {
        "flexible_spline.profile": teeth,
        "ring_gear.profile": teeth,
        "ring_gear.c_P": round(float(rng.uniform(0.85, 1.0)), 4),
    }


def _length(rng: np.random.Generator, unit: float, low: float, high: float) -> float:
    """A length (mm) between two, of this unit, mm."""
    return round(unit * float(rng.uniform(low, high)), 4)


def _s_shaped(rng: np.random.Generator, case: Case, module: float) -> Case:
    """S-shaped teeth, lower on a thin rim as `swgpar new` has them."""
    rim = case["flexible_spline.rim"] / module
    low = min(1.0, rim / (RIM_OF_HEIGHT * (ADDENDUM + DEDENDUM))) * float(rng.uniform(0.8, 1.0))
    modules = partial(_length, rng, low * module)
    teeth = {"type": "s_shaped", "r_tip": modules(0.1, 0.2), "r_root": modules(0.25, 0.4)}
    own = rng.uniform() < OF_THEIR_OWN
    ring = {"type": "conjugate", "r_tip": modules(0.1, 0.2), "r_root": modules(0.15, 0.25)}
    relief = {}
    if rng.uniform() < RELIEVED:
        relief = {"tip_relief": modules(0.01, 0.03), "tip_relief_height": round(0.5 * low, 4)}
    gears = ("flexible_spline", "ring_gear")
    return {
        **{f"{gear}.{key}": value for gear in gears for key, value in relief.items()},
        "drive.addendum_coef": round(low * ADDENDUM, 4),
        "drive.dedendum_coef": round(low * DEDENDUM, 4),
        "flexible_spline.profile": teeth,
        "ring_gear.profile": teeth if own else ring,
        "ring_gear.c_P": 1.0,
    }


def _shape(rng: np.random.Generator, shape: str, case: Case, radius: float) -> Case:
    """Keys of the cup's shape. radius : mm, of the pitch circle"""
    cup = case["cup"]
    if shape == "short":
        return {"length": 0.5 * cup["length"]}
    if shape == "hat":
        del cup["inner_radius"]
        thickness = round(float(rng.uniform(0.025, 0.04)) * radius, 4)
        return {"shape": "hat", "flange_radius": 1.36 * radius, "end_thickness": thickness}
    return {}


def _with_backlash(table: dict[str, Any], backlash: float) -> dict[str, Any]:
    """The design with a backlash of the ring gear."""
    ring = table["ring_gear"]
    kind = ring["profile"]["type"]
    if kind == "involute":
        return with_value(table, "ring_gear.profile", {**ring["profile"], "shift": backlash})
    if kind == "conjugate":
        half = 0.5 * np.pi * table["drive"]["module"]
        content = {**ring["profile"], "backlash": round(float(backlash * half), 6)}
        return with_value(table, "ring_gear.profile", content)
    return with_value(table, "ring_gear.c_P", round(ring["c_P"] - backlash, 6))
