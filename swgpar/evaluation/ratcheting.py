"""Ratcheting: the peak of the torque under a prescribed rotation of the output, and what gives way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.program_results import PointRow
from swgpar.fem.body_layout import FLEXIBLE_SPLINE
from swgpar.load.load_program import pitch_angle, torque_direction
from swgpar.model.drive_model import DriveModel

AT_TEETH, IN_SPLINE, NOTHING = "teeth jump over", "flexible spline buckles", "nothing"
"""What gives way: the teeth move on with the output; they stay, and the spline yields between them and the output;
nothing up to the end of the run."""


def tooth_rotation(model: DriveModel) -> float:
    """Mean rotation (deg) of the flexible spline's teeth, the rigid one that fits their flanks best; collective."""
    body = model.elements.bodies[FLEXIBLE_SPLINE]
    nodes = np.unique(np.concatenate([grid.nodes.ravel() for grid in body.layout.mesh.flanks]))
    at = body.positions()[body.owned][:, nodes, :2]
    moved = at + body.displacement(model.problem.displacement())[body.owned][:, nodes, :2]
    sine = float((at[..., 0] * moved[..., 1] - at[..., 1] * moved[..., 0]).sum())
    cosine = float((at * moved).sum())
    sine, cosine = model.comm.allreduce(np.array([sine, cosine]), op=MPI.SUM)
    return float(np.degrees(np.arctan2(sine, cosine)))


def peak(rows: Sequence[PointRow]) -> int:
    """Index of the row with the largest torque."""
    return int(np.argmax([row["torque_Nm"] for row in rows]))


def has_fallen(design: DriveDesign, rows: Sequence[PointRow]) -> bool:
    """Whether the torque of the last row has fallen clearly below its peak."""
    if design.ratcheting is None or not rows:
        return False
    top = rows[peak(rows)]["torque_Nm"]
    return top > 0.0 and rows[-1]["torque_Nm"] < (1.0 - design.ratcheting.drop) * top


def what_gave_way(design: DriveDesign, rows: Sequence[PointRow], teeth: Sequence[float]) -> str:
    """What the output's rotation since the peak went into: `AT_TEETH`, `IN_SPLINE`, or `NOTHING` without a peak.

    teeth : (n,) deg, rotation of the flexible spline's teeth at every row
    """
    top = peak(rows)
    if top == len(rows) - 1:
        return NOTHING
    output = (rows[-1]["rotation_arcmin"] - rows[top]["rotation_arcmin"]) / 60.0
    turned = torque_direction(design.ratio) * (teeth[-1] - teeth[top])
    between_teeth = output - turned if design.output_gear == "ring_gear" else turned
    return AT_TEETH if between_teeth > 0.5 * output else IN_SPLINE


def summarise_ratcheting(
    design: DriveDesign, rows: Sequence[PointRow], teeth: Sequence[float], *, ended_early: bool
) -> dict[str, Any] | None:
    """Entry of the summary; None where the design asks for none.

    teeth : (n,) deg, rotation of the flexible spline's teeth at every row
    ended_early : whether no equilibrium was found behind the last row
    """
    if design.ratcheting is None:
        return None
    top, fallen = peak(rows), has_fallen(design, rows)
    beside = [rows[k]["torque_Nm"] for k in (top - 1, top + 1) if 0 <= k < len(rows)]
    return {
        "peak_torque_Nm": rows[top]["torque_Nm"],
        "peak_error_Nm": max((rows[top]["torque_Nm"] - torque for torque in beside), default=0.0),
        "peak_rotation_deg": rows[top]["rotation_arcmin"] / 60.0,
        "peak_rotation_pitches": rows[top]["rotation_arcmin"] / 60.0 / pitch_angle(design),
        "peak_step": rows[top]["step"],
        "last_torque_Nm": rows[-1]["torque_Nm"],
        "last_step": rows[-1]["step"],
        "is_peak": top < len(rows) - 1,
        "gave_way": what_gave_way(design, rows, teeth),
        "ended": "no equilibrium found" if ended_early else "torque fell" if fallen else "limit reached",
    }
