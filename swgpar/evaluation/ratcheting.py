"""Ratcheting: the peak of the torque under a prescribed rotation of the output, and what gives
way."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from mpi4py import MPI

from swgpar.design.kinematics import Kinematics
from swgpar.evaluation.answers import AnswerGroup, answer, evaluation
from swgpar.evaluation.program_results import PointRow
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.model.drive_model import DriveModel

AT_TEETH, IN_SPLINE, NOTHING = "teeth jump over", "flexible spline buckles", "nothing"
"""What gives way: the teeth move on with the output; they stay, and the spline yields between them
and the output; nothing up to the end of the run."""


@evaluation
class RatchetingTorque(AnswerGroup):
    """The largest torque of the output under a prescribed rotation, and what gave way.

    peak_error_Nm : difference from the points beside it;  peak_step : its point of the program
    last_torque_Nm, last_step : of the last point
    is_peak : whether the torque fell after it;  gave_way : `AT_TEETH`, `IN_SPLINE` or `NOTHING`;
    ended : why
    """

    peak_torque_Nm: float = answer(
        "ratcheting.peak_torque_Nm",
        "largest torque of the output",
        "N·m",
        remark="peak_remark",
    )
    peak_error_Nm: float
    peak_rotation_deg: float = answer(
        "ratcheting.peak_rotation_deg", "rotation of the output there", "deg"
    )
    peak_rotation_pitches: float = answer(
        "ratcheting.peak_rotation_pitches", "rotation of the output there, in pitches"
    )
    peak_step: int
    last_torque_Nm: float
    last_step: int
    is_peak: bool
    gave_way: str
    ended: str

    TITLE = "ratcheting torque"
    ASKED_BY = "[ratcheting]"
    SECTION = "ratcheting"

    @property
    def peak_remark(self) -> str:
        """What to know of the largest torque."""
        beside = f"the points beside it are {self.peak_error_Nm:.3g} N·m lower"
        return beside if self.is_peak else "no peak: it still grows"

    def remarks(self) -> Iterator[str]:
        yield f"what gives way: {self.gave_way}; end of the run: {self.ended}"


def tooth_rotation(model: DriveModel) -> float:
    """Mean rotation (deg) of the flexible spline's teeth, the rigid one that fits their flanks
    best; collective."""
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


def has_fallen(drop: float, rows: Sequence[PointRow]) -> bool:
    """Whether the torque of the last row has fallen clearly below its peak. drop : share of the
    peak"""
    if not rows:
        return False
    top = rows[peak(rows)]["torque_Nm"]
    return top > 0.0 and rows[-1]["torque_Nm"] < (1.0 - drop) * top


def what_gave_way(kinematics: Kinematics, rows: Sequence[PointRow], teeth: Sequence[float]) -> str:
    """What the output's rotation since the peak went into: `AT_TEETH`, `IN_SPLINE`, or `NOTHING`
    without a peak.

    teeth : (n,) deg, rotation of the flexible spline's teeth at every row
    """
    top = peak(rows)
    if top == len(rows) - 1:
        return NOTHING
    output = (rows[-1]["rotation_arcmin"] - rows[top]["rotation_arcmin"]) / 60.0
    turned = kinematics.torque_direction * (teeth[-1] - teeth[top])
    between_teeth = output - turned if kinematics.output_gear == "ring_gear" else turned
    return AT_TEETH if between_teeth > 0.5 * output else IN_SPLINE


def evaluate_ratcheting(
    kinematics: Kinematics,
    drop: float,
    rows: Sequence[PointRow],
    teeth: Sequence[float],
    *,
    ended_early: bool,
) -> RatchetingTorque:
    """The largest torque from the rows of program.csv of a design with [ratcheting].

    drop : share of the peak by which the torque has to fall
    teeth : (n,) deg, rotation of the flexible spline's teeth at every row
    ended_early : whether no equilibrium was found behind the last row
    """
    top, fallen = peak(rows), has_fallen(drop, rows)
    beside = [rows[k]["torque_Nm"] for k in (top - 1, top + 1) if 0 <= k < len(rows)]
    return RatchetingTorque(
        peak_torque_Nm=rows[top]["torque_Nm"],
        peak_error_Nm=max((rows[top]["torque_Nm"] - torque for torque in beside), default=0.0),
        peak_rotation_deg=rows[top]["rotation_arcmin"] / 60.0,
        peak_rotation_pitches=rows[top]["rotation_arcmin"] / 60.0 / kinematics.output_pitch,
        peak_step=rows[top]["step"],
        last_torque_Nm=rows[-1]["torque_Nm"],
        last_step=rows[-1]["step"],
        is_peak=top < len(rows) - 1,
        gave_way=what_gave_way(kinematics, rows, teeth),
        ended="no equilibrium found"
        if ended_early
        else "torque fell"
        if fallen
        else "limit reached",
    )
