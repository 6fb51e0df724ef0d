"""history.csv: one row per increment, numbers that read back to the last bit."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from swgpar.load.load_states import Stage

NAME = "history.csv"

Row = dict[str, Any]
"""One increment: a value for every column."""

UNITS = {
    "step": "",
    "wg_angle_deg": "deg",
    "output_angle_deg": "deg",
    "fs_s1": "MPa",
    "fs_s3": "MPa",
    "fs_vm": "MPa",
    "rg_s1": "MPa",
    "rg_s3": "MPa",
    "rg_vm": "MPa",
    "wg_torque_Nmm": "N·mm",
    "tooth_torque_Nmm": "N·mm",
    "output_torque_Nmm": "N·mm",
    "torque_balance_Nmm": "N·mm",
    "pairs_in_contact": "",
    "max_penetration_mm": "mm",
    "newton_iterations": "",
    "wall_s": "s",
}
"""Columns in the order of the file, with their units. Stresses are maxima of nodal averages over a body,
s3 as a positive number; torques act on the flexible spline, that of the output on the output."""

COLUMNS = tuple(UNITS)

INPUT_UNITS = {"input_angle_deg": "deg", "input_torque_Nmm": "N·mm"}
"""Further columns, with their units, of a drive whose wave generator is fixed: of the ring gear, which is driven."""

PANCAKE_UNITS = {"ds_s1": "MPa", "ds_s3": "MPa", "ds_vm": "MPa", "ds_tooth_torque_Nmm": "N·mm"}
"""Further columns of pancake drives: stresses of the dynamic spline, torque of its teeth on the flexible spline."""

PERIODIC = (
    "fs_s1",
    "fs_s3",
    "fs_vm",
    "rg_s1",
    "rg_s3",
    "rg_vm",
    "wg_torque_Nmm",
    "input_torque_Nmm",
    "transmission_error",
)
"""Columns that are the same after one period and smooth between, the transmission error among them."""

FINE = 201
"""Points of a curve over a period."""

_TEXT = {"step"}
_WHOLE = {"pairs_in_contact", "newton_iterations"}


def columns_of(row: Mapping[str, Any]) -> tuple[str, ...]:
    """Names of the columns of a history that has such rows."""
    further = (units for units in (INPUT_UNITS, PANCAKE_UNITS) if units.keys() & row.keys())
    return (*COLUMNS, *(name for units in further for name in units))


def plain_row(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row with Python's own types, in the order of the columns; ValueError when columns are wrong."""
    names = columns_of(row)
    if set(row) != set(names):
        wrong = sorted(set(row) ^ set(names))
        raise ValueError(f"history row: missing or unknown columns {', '.join(wrong)}")
    return {c: str(row[c]) if c in _TEXT else int(row[c]) if c in _WHOLE else float(row[c]) for c in names}


def format_rows(rows: Iterable[Mapping[str, Any]]) -> bytes:
    """The text of the whole file; floats as the shortest text that reads back the same."""
    text, rows = io.StringIO(), list(rows)
    names = columns_of(rows[0]) if rows else COLUMNS
    writer = csv.DictWriter(text, names, lineterminator="\n")
    writer.writeheader()
    for row in rows:
        writer.writerow({c: repr(v) if isinstance(v, float) else v for c, v in plain_row(row).items()})
    return text.getvalue().encode()


def columns(rows: Sequence[Mapping[str, Any]]) -> dict[str, np.ndarray]:
    """The history by columns, each (n,): int64 for `step` and for counts, else float64."""
    whole = _WHOLE | _TEXT
    names = columns_of(rows[0]) if rows else COLUMNS
    return {name: np.array([row[name] for row in rows], dtype=np.int64 if name in whole else float) for name in names}


def read_history(path: Path) -> list[dict[str, Any]]:
    """Rows of a history.csv."""
    with open(path, newline="", encoding="utf-8") as file:
        return [plain_row(row) for row in csv.DictReader(file)]


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


def wrapped(angle: np.ndarray) -> np.ndarray:
    """Angles (degrees) within half a turn."""
    return angle - 360.0 * np.round(angle / 360.0)


def loaded_increments(history: Mapping[str, np.ndarray]) -> np.ndarray:
    """Indices of the increments under load: the last of the loading, all of the rotation. All, if there are none.

    history : columns, as `columns` gives them
    """
    step = history["step"]
    rotation = np.flatnonzero(step >= Stage.ROTATE)
    last_of_loading = np.flatnonzero(step == Stage.LOAD)[-1:]
    found = np.concatenate([last_of_loading, rotation])
    return found if len(found) else np.arange(len(step))


@dataclass(frozen=True)
class Curves:
    """The history under load, ready to be drawn.

    angle, values : (n,) degrees of the wave generator, and columns by name, where they were computed
    fine_angle, fine : (m,) and the columns `PERIODIC` between them; the points where the rotation was not sampled
    """

    angle: np.ndarray
    values: Mapping[str, np.ndarray]
    fine_angle: np.ndarray
    fine: Mapping[str, np.ndarray]


def curves(history: Mapping[str, np.ndarray], samples: int, increments: int, period: float, ratio: float) -> Curves:
    """Columns of the increments under load; one period of it, joined by periodic splines, where it was sampled.

    Parameters
    ----------
    samples : angles in a period, 0 where every increment was computed;  increments : that were computed
    period : degrees;  ratio : change of `wg_angle_deg` over that of `output_angle_deg`, on average
    """
    shown = dict(history) | {
        "transmission_error": transmission_error(history["wg_angle_deg"], history["output_angle_deg"], ratio)
    }
    if not samples or increments < samples:
        loaded = loaded_increments(history)
        values = {name: column[loaded] for name, column in shown.items()}
        return Curves(values["wg_angle_deg"], values, values["wg_angle_deg"], values)
    from scipy.interpolate import CubicSpline  # a run needs no splines

    values = {name: column[increments - samples : increments] for name, column in shown.items()}
    angle = values["wg_angle_deg"]
    knots = np.append(angle, angle[0] + period)
    fine_angle = np.linspace(knots[0], knots[-1], FINE)
    closed = {name: np.append(column, column[0]) for name, column in values.items() if name in PERIODIC}
    fine = {name: CubicSpline(knots, column, bc_type="periodic")(fine_angle) for name, column in closed.items()}
    return Curves(angle, values, fine_angle, fine)
