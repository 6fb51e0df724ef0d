"""history.csv: one row per increment, numbers that read back to the last bit.

`COLUMNS` declares every column once. Tables, figures, quantities and the reference take names,
units and meanings from there. A file has those columns that its drive has, and is read by their
names: one more or less is no obstacle.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import scipy

from swgpar.load.load_states import Stage
from swgpar.results.atomic import to_json
from swgpar.results.table import as_rows, format_csv, read_columns
from swgpar.version import __version__

NAME = "history.csv"

DESCRIPTION = "history.json"
"""Beside it: the version of the columns, and what each of them is."""

VERSION = 2
"""Of the meanings of the columns. Files of version 1 have no description beside them."""

Row = dict[str, Any]
"""One increment: values by column."""

Angles = TypeVar("Angles", float, np.ndarray)


@dataclass(frozen=True)
class Column:
    """A column of the history.

    unit : empty for a pure number;  meaning : a phrase for the reference
    label : short, for tables and figures; where it is empty, the name says it
    whole : whether the values are integers
    periodic : whether it is the same after one period, and smooth between
    averaged : whether its mean and its maximum over the rotation are answers
    drives : which ones have it: "all", "pancake", those with the "wave generator fixed", or those
    with an "output bearing"
    """

    name: str
    unit: str
    meaning: str
    label: str = ""
    whole: bool = False
    periodic: bool = False
    averaged: bool = False
    drives: str = "all"


def _stresses(
    prefix: str, body: str, *, periodic: bool = True, drives: str = "all"
) -> tuple[Column, ...]:
    """Columns of the largest stresses of a body."""
    return tuple(
        Column(
            f"{prefix}_{name}",
            "MPa",
            meaning,
            f"{body}, {label}",
            periodic=periodic,
            averaged=True,
            drives=drives,
        )
        for name, label, meaning in (
            ("s1", "tensile s1", f"largest tensile stress in the {body} (first principal stress)"),
            (
                "s3",
                "compressive |s3|",
                f"largest compressive stress in the {body}, as a positive number",
            ),
            ("vm", "von Mises", f"largest von Mises stress in the {body}"),
        )
    )


DECLARED = (
    Column(
        "step",
        "",
        "load step: 1 deflection, 2 engagement, 3 load, 4 and on rotation; with a load program 3 "
        "and on its points",
        whole=True,
    ),
    Column(
        "wg_angle_deg",
        "deg",
        "angle of the wave generator; where it is fixed, against the ring gear",
    ),
    Column("output_angle_deg", "deg", "angle of the output, within half a turn: -180 to 180"),
    *_stresses("fs", "flexible spline"),
    *_stresses("rg", "ring gear"),
    Column(
        "wg_torque_Nmm",
        "N·mm",
        "torque of wave generator and pins on the flexible spline",
        "torque of the wave generator",
        periodic=True,
        averaged=True,
    ),
    Column("tooth_torque_Nmm", "N·mm", "torque of the ring gear's teeth on the flexible spline"),
    Column("output_torque_Nmm", "N·mm", "load on the output"),
    Column("torque_balance_Nmm", "N·mm", "what is left of the sum of torques that must vanish"),
    Column("pairs_in_contact", "", "pairs of flanks in contact, in the whole drive", whole=True),
    Column("max_penetration_mm", "mm", "largest penetration of cam and pins"),
    Column("newton_iterations", "", "Newton iterations of the increment", whole=True),
    Column("wall_s", "s", "wall time of the increment"),
    Column(
        "input_angle_deg",
        "deg",
        "angle of the ring gear, which is driven",
        drives="wave generator fixed",
    ),
    Column(
        "input_torque_Nmm",
        "N·mm",
        "torque that drives the ring gear",
        periodic=True,
        drives="wave generator fixed",
    ),
    *_stresses("ds", "dynamic spline", periodic=False, drives="pancake"),
    Column(
        "ds_tooth_torque_Nmm",
        "N·mm",
        "torque of the dynamic spline's teeth on the flexible spline",
        drives="pancake",
    ),
    *(
        Column(
            f"output_{axis}_mm",
            "mm",
            f"displacement of the output along {axis}, in the middle of its bearing",
            f"displacement of the output along {axis}",
            drives="output bearing",
        )
        for axis in "xyz"
    ),
    *(
        Column(
            f"output_tilt_{axis}_rad",
            "rad",
            f"tilt of the output about {axis}",
            f"tilt of the output about {axis}",
            drives="output bearing",
        )
        for axis in "xy"
    ),
)
"""In the order of the file. Stresses are maxima of nodal averages over a body."""

COLUMNS = {column.name: column for column in DECLARED}
"""By name."""

OUTPUT_COLUMNS = tuple(column.name for column in DECLARED if column.drives == "output bearing")
"""Displacements along x, y and z and tilts about x and y of an output on its bearing."""

IN_SPACE = (OUTPUT_COLUMNS[:2], OUTPUT_COLUMNS[3:])
"""Columns of the x and y components of vectors in space."""

REQUIRED = ("step", "wg_angle_deg")
"""Columns that a history cannot be read without."""

TRANSMISSION_ERROR = "transmission_error"
"""Name of the curve that follows from two columns; it is periodic."""

FINE = 201
"""Points of a curve over a period."""


def columns_of(drives: str) -> tuple[Column, ...]:
    """The columns that these drives have beside those of "all", or those of "all"."""
    return tuple(column for column in DECLARED if column.drives == drives)


def plain_row(row: Mapping[str, Any]) -> Row:
    """A row with Python's own types in the order of the columns; others are a ValueError."""
    if unknown := ", ".join(sorted(row.keys() - COLUMNS.keys())):
        raise ValueError(f"history row: {unknown} is not declared in swgpar.results.history")
    return {
        name: (int if column.whole else float)(row[name])
        for name, column in COLUMNS.items()
        if name in row
    }


def names_of(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """The columns that any of the rows has, in the order of the file; those that are not declared
    come last. The rows before a restart may lack some."""
    found = dict.fromkeys(name for row in rows for name in row)
    return [*(name for name in COLUMNS if name in found), *(n for n in found if n not in COLUMNS)]


def format_rows(rows: Iterable[Mapping[str, Any]]) -> bytes:
    """The text of the whole file as of `format_csv`, empty where a row has no value."""
    plain = [plain_row(row) for row in rows]
    names = names_of(plain)
    return format_csv([{name: row.get(name) for name in names} for row in plain])


def format_description() -> bytes:
    """The text of the file beside it."""
    return to_json({"version": VERSION, "columns": [asdict(column) for column in DECLARED]})


def columns(rows: Sequence[Mapping[str, Any]]) -> dict[str, np.ndarray]:
    """The history by columns, each (n,): int64 for `step` and for counts, else float64; float64 too
    for counts that a row lacks. NaN where a row has no value."""
    names = names_of(rows) if rows else [column.name for column in columns_of("all")]
    kinds = {
        name: np.int64 if column.whole and all(name in row for row in rows) else float
        for name, column in COLUMNS.items()
    }
    return {
        name: np.array([row.get(name, np.nan) for row in rows], dtype=kinds.get(name))
        for name in names
    }


def read_history(path: Path) -> list[Row]:
    """Rows of a history.csv. Columns that are not declared, of other versions, come last. A row
    lacks the columns whose cells are empty.

    Raises ValueError for columns of a newer version, or without those of `REQUIRED`.
    """
    description, version = path.with_name(DESCRIPTION), 1
    if description.exists():
        version = json.loads(description.read_text(encoding="utf-8"))["version"]
    if version > VERSION:
        raise ValueError(
            f"its columns are of version {version}, and swgpar {__version__} reads up to {VERSION}"
        )
    found = read_columns(path)
    if missing := [name for name in REQUIRED if name not in found]:
        raise ValueError(f"{NAME} has no column {missing[0]}")
    known = {name for name in found if name in COLUMNS}
    return [
        plain_row({name: float(row[name]) for name in known if row[name] != ""})
        | {n: v for n, v in row.items() if n not in known}
        for row in as_rows(found)
    ]


def column(rows: Iterable[Mapping[str, Any]], name: str) -> np.ndarray:
    """One column as (n,) float64."""
    return np.array([row[name] for row in rows], dtype=float)


def transmission_error(wg_angle: np.ndarray, output_angle: np.ndarray, ratio: float) -> np.ndarray:
    """Angle of the output less its kinematic value, (n,) arc seconds.

    Parameters
    ----------
    wg_angle, output_angle : (n,) degrees; the output's angle may be given between -180 and 180
    ratio : speed of the wave generator over that of the output
    """
    return 3600.0 * wrapped(output_angle - wg_angle / ratio)


def wrapped(angle: Angles) -> Angles:
    """Angle or angles (degrees) within half a turn."""
    return angle - 360.0 * np.round(angle / 360.0)


def loaded_increments(history: Mapping[str, np.ndarray]) -> np.ndarray:
    """Indices of the increments under load: the last of the loading, the rotation; else all.

    history : columns, as `columns` gives them
    """
    step = history["step"]
    rotation = np.flatnonzero(step >= Stage.ROTATE)
    last_of_loading = np.flatnonzero(step == Stage.LOAD)[-1:]
    loaded = np.concatenate([last_of_loading, rotation])
    return loaded if len(loaded) else np.arange(len(step))


@dataclass(frozen=True)
class Curves:
    """The history under load, ready to be drawn.

    angle, values : (n,) degrees of the wave generator, and computed columns by name
    fine_angle, fine : (m,) and the periodic columns between them, NaN for one that lacks values;
        the points where the rotation was not sampled
    """

    angle: np.ndarray
    values: Mapping[str, np.ndarray]
    fine_angle: np.ndarray
    fine: Mapping[str, np.ndarray]


def curves(
    history: Mapping[str, np.ndarray], samples: int, increments: int, period: float, ratio: float
) -> Curves:
    """Columns of the increments under load; of a sampled period, joined by periodic splines.

    samples : angles in a period, 0 where every increment was computed
    increments : that were computed;  period : degrees
    ratio : change of `wg_angle_deg` over that of `output_angle_deg`, on average
    """
    shown = dict(history)
    if "output_angle_deg" in history:
        angles = history["wg_angle_deg"], history["output_angle_deg"]
        shown[TRANSMISSION_ERROR] = transmission_error(*angles, ratio)
    if not samples or increments < samples:
        loaded = loaded_increments(history)
        values = {name: column[loaded] for name, column in shown.items()}
        return Curves(values["wg_angle_deg"], values, values["wg_angle_deg"], values)
    values = {name: column[increments - samples : increments] for name, column in shown.items()}
    angle = values["wg_angle_deg"]
    knots = np.append(angle, angle[0] + period)
    fine_angle = np.linspace(knots[0], knots[-1], FINE)
    periodic = {TRANSMISSION_ERROR, *(name for name, column in COLUMNS.items() if column.periodic)}
    closed = {
        name: np.append(column, column[0]) for name, column in values.items() if name in periodic
    }
    fine = {
        name: scipy.interpolate.CubicSpline(knots, column, bc_type="periodic")(fine_angle)
        if np.isfinite(column).all()
        else np.full(FINE, np.nan)
        for name, column in closed.items()
    }
    return Curves(angle, values, fine_angle, fine)
