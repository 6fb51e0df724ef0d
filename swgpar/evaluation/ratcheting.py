"""Ratcheting: the peak of the torque under a prescribed rotation of the output, and what gives
way."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from swgpar.answers.answer import AnswerGroup, AnswerKind, answer, evaluation, part_answers
from swgpar.design.kinematics import Kinematics
from swgpar.design.program_sections import Ratcheting
from swgpar.evaluation.first_yield import yield_torque
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.model.drive_model import DriveModel
from swgpar.results.history import Row

AT_TEETH, IN_SPLINE, NOTHING = "teeth jump over", "flexible spline buckles", "nothing"
"""What gives way: the teeth move on with the output; they stay, and the spline yields between them
and the output; nothing up to the end of the run."""

FELL, SUFFICIENT = "torque fell", "torque is sufficient"
"""Why a run with [ratcheting] ends before its last increment."""


@dataclass(frozen=True)
class TorquePoint:
    """A state of equilibrium under a prescribed rotation of the output.

    step : point of the program that it leads to
    rotation_deg : of the output beyond its kinematic one, in the sense of a positive torque
    torque_Nm : of the output;  teeth_deg : mean rotation of the flexible spline's teeth
    """

    step: int
    rotation_deg: float
    torque_Nm: float
    teeth_deg: float


PEAK_TORQUE = AnswerKind(
    "ratcheting.peak_torque_Nm", "largest torque of the output", "N·m", remark="peak_remark"
)
YIELD_TORQUE = AnswerKind(
    "ratcheting.yield_torque_Nm",
    "torque of the output at which the gears begin to yield",
    "N·m",
    remark="yield_remark",
)


@evaluation
class RatchetingTorque(AnswerGroup):
    """The largest torque of the output under a prescribed rotation, and what gave way.

    Without a peak that the torque has fallen from, the largest torque is a lower bound of it.

    peak_error_Nm : by which the torque may be larger between two states, at least `tolerance` of
    [ratcheting]; None without a peak
    peak_step : point of the program that its state leads to
    last_torque_Nm, last_step : of the last state
    is_peak : whether the torque has fallen from it;  gave_way : `AT_TEETH`, `IN_SPLINE` or
    `NOTHING`; ended : why
    states : computed, those between the points of the program among them
    yield_torque_Nm : None where the gears do not yield, or without `yield_strength` of [ratcheting]
    """

    peak_torque_Nm: float = part_answers(PEAK_TORQUE)
    peak_error_Nm: float | None
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
    states: int = 0
    yield_torque_Nm: float | None = part_answers(YIELD_TORQUE, default=None)

    TITLE = "ratcheting torque"
    ASKED_BY = "[ratcheting]"
    SECTION = "ratcheting"

    @property
    def peak_remark(self) -> str:
        """What to know of the largest torque."""
        if not self.is_peak:
            return f"no peak up to the end of the run ({self.ended})"
        by_steps = "" if self.peak_error_Nm is None else f" ± {self.peak_error_Nm:.2g} N·m"
        return f"by the steps{by_steps}; the error by the mesh is not known"

    @property
    def yield_remark(self) -> str:
        """How the torque of the first yield bounds that of a drive that yields."""
        return "the ratcheting torque of elastic, perfectly plastic gears is not below it"

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


def overshoot(rotations: Sequence[float], torques: Sequence[float]) -> float:
    """How far the torque may be above the largest one of the points, between these.

    Up to a peak the curve bends down: behind a point it lies below the straight line through this
    point and the one before. Before the largest point it also lies below the line from behind.
    Behind it the torque may fall at once, and no line from there is used. 0 where the last point
    has the largest torque; infinite where no point was before it.
    """
    x, y = rotations, torques
    top = int(np.argmax(y))
    if top == len(y) - 1:
        return 0.0

    def line(a: int, b: int, at: float) -> float:
        """The line through two points; above all where they are no points or the same."""
        if a < 0 or x[a] == x[b]:
            return np.inf
        return y[a] + (y[b] - y[a]) / (x[b] - x[a]) * (at - x[a])

    missed = line(top - 1, top, x[top + 1]) - y[top]
    if top > 0:
        # of two lines that cross the lower one is highest where they do
        ends = x[top - 1], x[top]
        over = [line(top - 2, top - 1, at) - line(top, top + 1, at) for at in ends]
        if np.isfinite(over).all() and over[0] < 0.0 < over[1]:
            at = x[top - 1] + over[0] / (over[0] - over[1]) * (x[top] - x[top - 1])
            missed = max(missed, line(top - 2, top - 1, at) - y[top])
        elif over[0] < 0.0:
            missed = max(missed, line(top - 2, top - 1, x[top]) - y[top])
    return missed


def peak(points: Sequence[TorquePoint]) -> int:
    """Index of the point with the largest torque."""
    return int(np.argmax([point.torque_Nm for point in points]))


def why_ended(section: Ratcheting, points: Sequence[TorquePoint], least: float) -> str:
    """`FELL` where the torque of the last point is clearly below its peak, `SUFFICIENT` where it
    has reached the sufficient one; empty where the run goes on.

    least : N·m, up to which a torque is none: in the backlash it rises and falls by round-off
    """
    if not points:
        return ""
    top = points[peak(points)].torque_Nm
    if top > least and points[-1].torque_Nm < (1.0 - section.drop) * top:
        return FELL
    enough = section.sufficient_torque
    return SUFFICIENT if enough is not None and top >= enough else ""


def what_gave_way(kinematics: Kinematics, points: Sequence[TorquePoint]) -> str:
    """What the output's rotation since the peak went into: `AT_TEETH`, `IN_SPLINE`, or `NOTHING`
    without a peak."""
    top = peak(points)
    if top == len(points) - 1:
        return NOTHING
    output = points[-1].rotation_deg - points[top].rotation_deg
    turned = kinematics.torque_direction * (points[-1].teeth_deg - points[top].teeth_deg)
    between_teeth = output - turned if kinematics.output_gear == "ring_gear" else turned
    return AT_TEETH if between_teeth > 0.5 * output else IN_SPLINE


def evaluate_ratcheting(
    kinematics: Kinematics,
    section: Ratcheting,
    points: Sequence[TorquePoint],
    least: float,
    *,
    ended_early: bool,
    rows: Sequence[Row] = (),
) -> RatchetingTorque:
    """The largest torque from the states of a run with [ratcheting].

    least : N·m, up to which a torque is none
    ended_early : whether no equilibrium was found behind the last state
    rows : of the history, for the torque at which the gears begin to yield
    """
    top = peak(points)
    largest = points[top].torque_Nm
    error = overshoot([p.rotation_deg for p in points], [p.torque_Nm for p in points])
    error = max(error, section.tolerance * largest)
    lowest = min(point.torque_Nm for point in points[top:])
    is_peak = largest > least and largest - lowest > error
    return RatchetingTorque(
        peak_torque_Nm=largest,
        peak_error_Nm=error if is_peak and np.isfinite(error) else None,
        peak_rotation_deg=points[top].rotation_deg,
        peak_rotation_pitches=points[top].rotation_deg / kinematics.output_pitch,
        peak_step=points[top].step,
        last_torque_Nm=points[-1].torque_Nm,
        last_step=points[-1].step,
        is_peak=is_peak,
        gave_way=what_gave_way(kinematics, points) if is_peak else NOTHING,
        ended="no equilibrium found"
        if ended_early
        else why_ended(section, points, least) or "limit reached",
        states=len(points),
        yield_torque_Nm=None
        if section.yield_strength is None
        else yield_torque(rows, kinematics.torque_direction, section.yield_strength),
    )
