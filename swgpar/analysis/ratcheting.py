"""Ratcheting: the peak of the torque under a prescribed rotation of the output, and what gives way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from swgpar.analysis.program_results import PointRow
from swgpar.design.drive_design import DriveDesign
from swgpar.design.load_program import pitch_angle
from swgpar.results.history import Row

Failure = Literal["teeth jumped over", "teeth still paired", "none"]
"""What gave way: the teeth changed their partners; they did not, so that cup or rim buckled; nothing up to the limit."""


def peak(rows: Sequence[PointRow]) -> int:
    """Index of the row with the largest torque."""
    return int(np.argmax([row["torque_Nm"] for row in rows]))


def has_fallen(design: DriveDesign, rows: Sequence[PointRow]) -> bool:
    """Whether the torque of the last row has fallen clearly below its peak."""
    if design.ratcheting is None or not rows:
        return False
    top = rows[peak(rows)]["torque_Nm"]
    return top > 0.0 and rows[-1]["torque_Nm"] < (1.0 - design.ratcheting.drop) * top


def slots(design: DriveDesign, pairs: Sequence[Row], steps: Sequence[int]) -> dict[int, int]:
    """Slot of the ring gear that every tooth of the flexible spline with a loaded flank lies in, at the last of `steps`.

    pairs : rows of pairs.csv. The clockwise flank of a tooth in slot J faces tooth J - 1, the other one tooth J.
    """
    found, last = {}, {}
    for pair in pairs:
        step, tooth = int(pair["step"]), int(pair["tooth"])
        if step in steps and step >= last.get(tooth, step):
            last[tooth] = step
            found[tooth] = (int(pair["ring_tooth"]) + (pair["flank"] == "clockwise")) % design.drive.teeth_rg
    return found


def jumped_teeth(design: DriveDesign, rows: Sequence[PointRow], pairs: Sequence[Row]) -> list[int]:
    """Teeth that lie in another slot at the end than up to the peak of the torque."""
    top = peak(rows)
    before = slots(design, pairs, [row["step"] for row in rows[: top + 1]])
    after = slots(design, pairs, [rows[-1]["step"]])
    return sorted(tooth for tooth in after if before.get(tooth, after[tooth]) != after[tooth])


def summarise_ratcheting(
    design: DriveDesign, rows: Sequence[PointRow], pairs: Sequence[Row], *, ended_early: bool
) -> dict[str, Any] | None:
    """Entry of the summary; None where the design asks for none.

    pairs : rows of pairs.csv;  ended_early : whether no equilibrium was found behind the last row
    """
    if design.ratcheting is None:
        return None
    top, fallen = peak(rows), has_fallen(design, rows)
    jumped = jumped_teeth(design, rows, pairs)
    beside = [rows[k]["torque_Nm"] for k in (top - 1, top + 1) if 0 <= k < len(rows)]
    gave_way: Failure = "teeth jumped over" if jumped else "teeth still paired" if fallen else "none"
    return {
        "peak_torque_Nm": rows[top]["torque_Nm"],
        "peak_error_Nm": max((rows[top]["torque_Nm"] - torque for torque in beside), default=0.0),
        "peak_rotation_deg": rows[top]["rotation_arcmin"] / 60.0,
        "peak_rotation_pitches": rows[top]["rotation_arcmin"] / 60.0 / pitch_angle(design),
        "peak_step": rows[top]["step"],
        "last_torque_Nm": rows[-1]["torque_Nm"],
        "last_step": rows[-1]["step"],
        "is_peak": fallen,
        "gave_way": gave_way,
        "jumped_teeth": jumped,
        "ended": "no equilibrium found" if ended_early else "torque fell" if fallen else "limit reached",
    }
