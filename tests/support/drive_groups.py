"""Drives under numerical stress, by group: designs whose one key, or few, go to where the numbers
get hard.

Groups serve `tests/stability` and `scripts/bench/stability`. All run on the smallest mesh.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from support.drawn_drive import CAMS, Case, draw
from support.paths import DATA, DESIGN, DRIVERS, RECIPE, REFERENCE
from support.small_drive import PLANE as SMALL_PLANE
from swgpar.checks.design_file import make_drive
from swgpar.errors import InputError
from swgpar.input.toml_file import parse_value, read_toml, with_value
from swgpar.meshing import build_sector_meshes, load_recipe

PLANE, SMALL, CUP = DRIVERS / "plane_half_turn.toml", DESIGN, REFERENCE
"""The plane reference drive, the small cup drive of 40 teeth, and the cup reference drive."""

MESH = RECIPE

Cases = dict[str, Case]
"""Cases by name."""


def table_of(design: Path, case: Case) -> dict[str, Any]:
    """Content of the design file with the values of the case."""
    table = read_toml(design)
    for key, value in case.items():
        table = with_value(table, key, value)
    return table


@dataclass(frozen=True)
class Group:
    """design : file that the cases override;  make : draws them up;  steps : whether the cases set
    their own"""

    design: Path
    make: Callable[[], Cases]
    steps: bool = False

    def cases(self) -> Cases:
        """All cases; the wave generator turns through one and a half pitches in three
        increments."""
        return {name: {**self.period(case), **case} for name, case in self.make().items()}

    def period(self, case: Case) -> Case:
        """Increments of half a pitch, of which the first and the last then end in the same
        state."""
        if self.steps:
            return {}
        try:
            pitch = float(
                np.degrees(make_drive(table_of(self.design, case)).kinematics.period_angle)
            )
        except InputError:  # it is the run that is to refuse the design
            return {}
        return {"steps.increment": 0.5 * pitch, "steps.rotation": 1.5 * pitch}


def each(key: str, values: Iterable[float], more: Case | None = None) -> Cases:
    """A case for every value of a key; `more` goes into all of them."""
    return {f"{key.rpartition('.')[2]}={value:g}": {key: value, **(more or {})} for value in values}


def crossed(cases: Cases, others: Cases) -> Cases:
    """Every case with every other."""
    return {f"{a}_{b}": {**one, **other} for a, one in cases.items() for b, other in others.items()}


def units(design: Path = SMALL) -> Cases:
    """A cup drive in mm and N, m and N, inch and pound; torques are a thousandth of the unit of the
    stresses."""
    table, cases = read_toml(design), {}
    lengths = [
        *(
            f"{s}.{k}"
            for s, k in (
                ("drive", "module"),
                ("drive", "face_width"),
                ("wave_generator", "face_width"),
            )
        ),
        *(f"cup.{k}" for k in ("length", "fillet_radius", "inner_radius")),
        *(f"micro_geometry.{k}" for k in ("wg_crowning", "wg_slope", "fs_crowning")),
        *(
            f"{g}.profile.{k}"
            for g in ("flexible_spline", "ring_gear")
            for k in table[g]["profile"]
            if k != "type"
        ),
        "flexible_spline.rim",
        "ring_gear.rim",
    ]
    for name, length, force in UNITS:
        case: Case = {}
        for key in lengths:
            value: Any = table
            for part in key.split("."):
                value = value[part]
            case[key] = value * length
        case["material.E"] = table["material"]["E"] * force / length**2
        case["load.torque"] = table["load"]["torque"] * force * length
        cases[name] = case
    return cases


UNITS_GROUP = "units, cup"
UNITS = (
    ("mm_N", 1.0, 1.0),
    ("m_N", 1e-3, 1.0),
    ("inch_lbf", 1 / 25.4, 1 / 4.4482216152605),
    ("km_MN", 1e-6, 1e-6),
)
"""Systems of units: name, unit of length over mm, unit of force over N."""


def teeth(numbers: Iterable[int]) -> Cases:
    """The plane drive with other numbers of teeth, its rim in proportion."""
    return {
        f"teeth={n}": {"drive.teeth_fs": n, "drive.teeth_rg": n + 2, "flexible_spline.rim": n / 120}
        for n in numbers
    }


def widths(values: Iterable[float]) -> Cases:
    """The small cup drive with another face width on the same number of elements: aspect ratios to
    a thousand.

    Below its own width micro-geometry and torque shrink in proportion: the full ones crush a narrow
    drive.
    """
    table = read_toml(SMALL)
    own, scaled = table["drive"]["face_width"], {"load.torque": table["load"]["torque"]}
    scaled |= {
        f"micro_geometry.{k}": table["micro_geometry"][k]
        for k in ("wg_crowning", "wg_slope", "fs_crowning")
    }
    return {
        f"width={w:g}": {
            "drive.face_width": w,
            "wave_generator.face_width": w,
            **({key: value * w / own for key, value in scaled.items()} if w < own else {}),
        }
        for w in values
    }


def cams() -> Cases:
    """Every kind of cam, some beside the published ones."""
    improved = {"a_p": 0.0097, "C_p": 0.51, "r_c": 10.0}
    wave = {
        "simplified,C=0.8": {"type": "simplified", "C": 0.8},
        "simplified,C=0.95": {"type": "simplified", "C": 0.95},
        "elliptical,C=0.9": {"type": "elliptical", "C": 0.9},
        "harmonic,C=0.9": {"type": "harmonic", "C": 0.9},
        "arcs,beta=45": {"type": "arcs", "C": 1.0, "beta": 45.0},
        "parabolic": {"type": "parabolic", "C": 1.0, **improved},
        "four_roller": {"type": "four_roller", "beta": 25.0, "r_4": 15.0},
        "two_roller": {"type": "two_roller", "r_2": 20.0},
        "deflection=0.9": {"type": "elliptical", "deflection": 0.9},
    }
    for angle in (-0.5, 0.5):
        wave[f"turned_parabolas={angle}"] = {
            "type": "asymmetric_parabolic",
            "rotational_angle": angle,
        }
    sides: dict[str, dict[str, float]] = {}
    for side in ("right", "left"):
        for key, values in (("a_p", (0.0095, 0.0099)), ("C_p", (0.45, 0.55)), ("r_c", (8.0, 12.0))):
            for value in values:
                name = f"{side}_{key}={value:g}"
                wave[name], sides[name] = (
                    {"type": "asymmetric_parabolic"},
                    {side: {**improved, key: value}},
                )
    for name, table in wave.items():
        if table["type"] == "asymmetric_parabolic":
            table |= {"C": 1.0, "right": improved, "left": improved, **sides.get(name, {})}
    return {name: {"wave_generator": {**table, "face_width": 10.0}} for name, table in wave.items()}


def random_designs(count: int, seed: int, model: str = "plane") -> Cases:
    """Drives with any profile and cam, some with friction, backlash or the other layout, that can
    be built."""
    rng, cases = np.random.default_rng(seed), {}
    recipe, drawn = load_recipe(MESH), 0
    while len(cases) < count:
        drawn += 1
        case = draw(rng, model)
        try:
            build_sector_meshes(make_drive(table_of(PLANE, case)).geometry, recipe)
        except InputError:
            continue
        cases[f"r{drawn:04d}"] = case
    return cases


SENSIBLE, SENSIBLE_CUP = "sensible designs, plane", "sensible designs, cup"


def sensible_designs(count: int, seed: int, model: str = "plane") -> Cases:
    """Drives of 60 to 240 teeth and 8 to 100 mm of radius, with any cam and profile; some of them
    cannot be built.

    They turn through a pitch and a quarter in increments of a quarter, so that the first and the
    last end in the same state, and the last four have the mean of a period. Without friction they
    start from the bent shape, as `swgpar run` does.
    """
    rng, cases = np.random.default_rng(seed), {}
    for k in range(count):
        teeth = int(rng.integers(60, 241))
        radius = float(np.exp(rng.uniform(np.log(8.0), np.log(100.0))))
        case = draw(rng, model, teeth, round(2.0 * radius / teeth, 4), CAMS)
        pitch = 360.0 / (teeth + 2 if case["drive.layout"] == "ring_fixed" else teeth)
        case |= {"steps.increment": 0.25 * pitch, "steps.rotation": 1.25 * pitch}
        cases[f"s{k:04d}"] = {**case, "steps.bent_start": case["contact.friction"] == 0.0}
    return cases


def from_number(first: int, cases: Cases) -> Cases:
    """The cases behind the first ones."""
    return dict(list(cases.items())[first:])


REPEATED = {"fs_s1": 1e-300, "fs_s3": 1e-300, "fs_vm": 1e-300, "wg_torque_Nmm": 1.0}
"""Columns of the history that repeat after one period, and the least value that a difference is
divided by.

A torque is what is left of moments of the cam's contact forces, some 1e4 N mm, which are known to
the solver's 1e-9: a difference of 1e-6 N mm in it says nothing.
"""


def drift(first: Mapping[str, Any], last: Mapping[str, Any]) -> float:
    """Largest relative difference of two rows of histories that should agree."""
    return max(abs(last[k] - first[k]) / max(abs(first[k]), least) for k, least in REPEATED.items())


DECADES = (0.05, 0.5, 5.0, 50.0, 500.0)
ONCE_FAILED = "designs that once failed"
FACE_WIDTHS = (0.2, 0.3, 0.5, 1.0, 4.0, 20.0, 60.0, 200.0, 1000.0)
FRICTION = (0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5)


def groups(
    count: int, seed: int, sensible: tuple[int, int] = (0, 0), first: int = 0
) -> dict[str, Group]:
    """All groups.

    count, seed : number of random plane designs, and what they are drawn from
    sensible : numbers of plane and of cup drives of sensible sizes;  first : number of the first of
    them in the group
    """
    flat = dict(override.split("=") for override in SMALL_PLANE)
    flat = {key: parse_value(value) for key, value in flat.items()}

    def small_plane(cases: Cases, steps: bool = False) -> Group:
        return Group(SMALL, lambda: {name: {**flat, **case} for name, case in cases.items()}, steps)

    soft = {"contact.wg_penalty_coef": 0.5, "contact.max_augmentations": 50}
    wide = {"cup.fillet_radius": 3.0}  # for the thickest rim
    rims, torques = (
        (0.18, 0.3, 0.5, 1.0, 1.5, 2.0, 3.0),
        (0.0, 0.01, 1.0, 10.0, 50.0, 100.0, 200.0, 500.0),
    )
    turns = {
        f"increment={a:g}": {"steps.increment": a, "steps.rotation": 2 * a}
        for a in (0.1, 0.3, 1.0, 3.0, 10.0)
    }
    return {
        "Poisson's ratio, cup": Group(
            SMALL, lambda: each("material.nu", (0.0, 0.3, 0.45, 0.49, 0.499))
        ),
        UNITS_GROUP: Group(SMALL, units),
        "penalty of the cam, cup": Group(SMALL, lambda: each("contact.wg_penalty_coef", DECADES)),
        "penalty without augmentation, plane": small_plane(
            each("contact.wg_penalty_coef", DECADES, {"contact.max_augmentations": 0})
        ),
        "augmentation, plane": small_plane(
            each("contact.penetration_tolerance", (1e-2, 1e-3, 1e-4, 1e-5, 1e-6), soft)
        ),
        "increments, plane": small_plane(turns, steps=True),
        "gaps, plane reference": Group(
            PLANE, lambda: each("ring_gear.c_P", (0.5, 0.7, 0.8, 0.85, 0.9, 0.95, 0.98))
        ),
        "overlap, plane": small_plane(each("ring_gear.c_P", (1.0, 1.01, 1.02, 1.05, 1.1))),
        "cam's slope (gaps and overlap), cup": Group(
            SMALL, lambda: each("micro_geometry.wg_slope", (-0.2, -0.1, 0.0, 0.1, 0.2, 0.4))
        ),
        "gaps and torque, cup": Group(
            SMALL,
            lambda: crossed(
                each("ring_gear.c_P", (0.8, 0.9, 1.0)), each("load.torque", (0.01, 1.0, 20.0))
            ),
        ),
        "friction, plane": small_plane(each("contact.friction", FRICTION)),
        "friction, cup": Group(SMALL, lambda: each("contact.friction", FRICTION)),
        "friction under 50 N·m, plane reference": Group(
            PLANE, lambda: each("contact.friction", FRICTION, {"load.torque": 50.0})
        ),
        "rim, plane reference": Group(PLANE, lambda: each("flexible_spline.rim", rims)),
        "rim, cup reference": Group(
            CUP, lambda: each("flexible_spline.rim", (0.18, 0.3, 1.0, 3.0), wide)
        ),
        "torque, plane reference": Group(PLANE, lambda: each("load.torque", torques)),
        "torque, cup reference": Group(
            CUP, lambda: each("load.torque", (0.01, 20.0, 100.0, 500.0))
        ),
        "teeth, plane reference": Group(
            PLANE, lambda: teeth((20, 30, 40, 60, 80, 120, 160, 200, 320))
        ),
        "cams, plane reference": Group(PLANE, cams),
        "face width (aspect ratio), cup": Group(SMALL, lambda: widths(FACE_WIDTHS)),
        "random designs, plane": Group(PLANE, lambda: random_designs(count, seed)),
        ONCE_FAILED: Group(PLANE, lambda: read_toml(DATA / "once_failed.toml")),
        "random designs, cup": Group(PLANE, lambda: random_designs(count // 10, seed, "cup")),
        SENSIBLE: Group(
            PLANE, lambda: from_number(first, sensible_designs(sensible[0], seed)), steps=True
        ),
        SENSIBLE_CUP: Group(
            PLANE,
            lambda: from_number(first, sensible_designs(sensible[1], seed, "cup")),
            steps=True,
        ),
    }
