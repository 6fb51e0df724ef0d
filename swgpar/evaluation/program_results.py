"""Results of load programs: torque and rotation of the output at every point."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.load.load_program import program_points, torque_direction
from swgpar.load.load_states import Stage
from swgpar.results.history import Row, wrapped

PointRow = dict[str, Any]
"""Row of program.csv: a value for every column."""

COLUMNS = {
    "step": "",
    "stage": "",
    "wg_angle_deg": "deg",
    "torque_Nm": "N·m",
    "rotation_arcmin": "arc minutes",
    "wg_torque_Nmm": "N·mm",
    "pairs_in_contact": "",
}
"""Columns of program.csv with their units: the torque on the output, positive against its motion, and the rotation of
the output by it, beyond what the ratio makes of the wave generator's angle."""


def point_rows(design: DriveDesign, rows: Sequence[Row]) -> list[PointRow]:
    """Rows of program.csv from those of the history; none without a load program."""
    points, direction = program_points(design), torque_direction(design.ratio)
    found = []
    for row in rows:
        index = int(row["step"]) - Stage.LOAD
        if not 0 <= index < len(points):
            continue
        rotation = wrapped(row["output_angle_deg"] - row["wg_angle_deg"] / design.ratio)
        found.append(
            {
                "step": int(row["step"]),
                "stage": points[index].stage,
                "wg_angle_deg": row["wg_angle_deg"],
                "torque_Nm": direction * row["output_torque_Nmm"] / 1000.0,
                "rotation_arcmin": direction * 60.0 * float(rotation),
                "wg_torque_Nmm": row["wg_torque_Nmm"],
                "pairs_in_contact": row["pairs_in_contact"],
            }
        )
    return found


def work_by_torque(rows: Sequence[PointRow]) -> float:
    """Work (N mm) of the output's torque along the rows, by the trapezoidal rule."""
    torque = 1000.0 * np.array([row["torque_Nm"] for row in rows])
    rotation = np.radians(np.array([row["rotation_arcmin"] for row in rows]) / 60.0)
    return float((0.5 * (torque[1:] + torque[:-1]) * np.diff(rotation)).sum())


def summarise_program(rows: Sequence[PointRow]) -> dict[str, Any] | None:
    """Entry of the summary: the last point of every stage by its name; None without a load program."""
    return {row["stage"]: {name: row[name] for name in COLUMNS if name != "stage"} for row in rows} or None
