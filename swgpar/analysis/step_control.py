"""Steps that control themselves: prescribed rotations follow the torque, and the slip of friction
is compared with that of half the steps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.rotation_path import RotationPath
from swgpar.analysis.snapshot import Snapshot
from swgpar.analysis.step_bounds import pitches_turned
from swgpar.errors import ConvergenceError
from swgpar.evaluation.ratcheting import TorquePoint, tooth_rotation
from swgpar.evaluation.slip_error import SLIP_TOLERANCE, SlipCheck
from swgpar.load.load_states import LoadState, Stage
from swgpar.log import logger
from swgpar.results.history import wrapped

DOUBTFUL_SLIP = 0.01
"""Share of the flanks' force on points that stick, or have no slip, from which a step is compared
with its halves. Points that slip through the whole step carry the bound of friction, whatever the
step."""

SAME_PITCHES = 1e-6
"""Rotation of the output in pitches up to which it is at a point of the program."""

MOST_PARTS = 16
"""Of a step with friction; the wave generator then turns by a 64th of the period in each."""

PROGRAM_TOLERANCE = 0.01
"""Share of a largest torque by which a load program may miss it."""


@dataclass(frozen=True)
class Step:
    """A step of an increment. before : state that it begins with;  origin : the same under the
    control of its end"""

    before: Snapshot
    origin: LoadState
    end: LoadState


class StepControl:
    """Advances a stepper from increment to increment in steps that follow what happens between.

    stepper : which is advanced
    torque_points : of the prescribed rotation, those of [ratcheting] over the whole run
    slip_checks : with friction, of increments with doubtful slip
    """

    def __init__(
        self, stepper: LoadStepper, torque_points: list[TorquePoint], slip_checks: list[SlipCheck]
    ) -> None:
        self.stepper, self.design = stepper, stepper.design
        self.slip_checks = slip_checks
        ratcheting = self.design.ratcheting
        self._teeth = ratcheting is not None
        tolerance = PROGRAM_TOLERANCE if ratcheting is None else ratcheting.tolerance
        self._path = RotationPath(stepper, torque_points, self._torque_point, tolerance, ratcheting)

    def advance(self, target: LoadState) -> None:
        """Solve up to `target`; raises ConvergenceError as the stepper does."""
        stepper, here = self.stepper, self.stepper.load_state
        rotated = target.stage == Stage.PROGRAM and target.control == "rotation"
        if rotated and self.design.steps.subdivide:
            origin = stepper.origin(target)
            if pitches_turned(origin, target, self.design.kinematics):
                self._path.follow(target)
                return
        if target.friction_acts and here.is_periodic and self.design.contact.friction:
            self._advance_with_friction(target)
            return
        stepper.advance(target)

    def has_passed(self, target: LoadState) -> bool:
        """Whether the torque that [ratcheting] starts with has rotated the output beyond `target`
        already."""
        if not self._teeth or target.control == "torque" or target.stage != Stage.PROGRAM:
            return False
        origin = self.stepper.origin(target)
        return pitches_turned(origin, target, self.design.kinematics) < SAME_PITCHES

    def has_ended(self) -> bool:
        """Whether the rotation of [ratcheting] has gone far enough."""
        return self._path.has_ended()

    # -- prescribed rotations ----------------------------------------------------------------------

    def _torque_point(self) -> TorquePoint:
        """The present state as a point of the torque over the rotation; collective."""
        row, kinematics = self.stepper.row(), self.design.kinematics
        turned = wrapped(row["output_angle_deg"] - row["wg_angle_deg"] / kinematics.ratio)
        return TorquePoint(
            step=int(row["step"]),
            rotation_deg=float(kinematics.torque_direction * turned),
            torque_Nm=kinematics.torque_direction * row["output_torque_Nmm"] / 1000.0,
            teeth_deg=tooth_rotation(self.stepper.model) if self._teeth else 0.0,
        )

    # -- friction ----------------------------------------------------------------------------------

    def _advance_with_friction(self, target: LoadState) -> None:
        """Take the steps to `target`; compare the last one with its halves where slip is doubtful.

        Halves take its place until they change the result by less than `SLIP_TOLERANCE`. Where the
        user gives the steps, they only show the change.
        """
        stepper = self.stepper
        *first, last = stepper.steps_to(target)
        iterations = 0
        for state in first:
            stepper.advance(state)
            iterations += stepper.iterations
        step = Step(stepper.snapshot(), stepper.origin(last), last)
        iterations += self._take(step, 1)
        doubtful = stepper.problem.doubtful_slip()
        if doubtful > DOUBTFUL_SLIP:
            iterations += self._halve(step, doubtful)
        stepper.iterations = iterations

    def _take(self, step: Step, count: int) -> int:
        """Take a step in `count` parts, the last of which ends the same; returns their Newton
        iterations."""
        stepper, iterations = self.stepper, 0
        stepper.restore(step.before)
        for k in range(1, count + 1):
            stepper.advance(stepper.between(step.origin, step.end, k / count))
            iterations += stepper.iterations
        return iterations

    def _halve(self, step: Step, doubtful: float) -> int:
        """Take a step again in halves, in quarters, ...; returns their Newton iterations. doubtful
        : share of the force"""
        stepper, fixed = self.stepper, not self.design.steps.subdivide
        iterations, count, check = 0, 1, None
        row, start = stepper.row(), self._rotation_before(step)
        while count < MOST_PARTS:
            try:
                iterations += self._take(step, 2 * count)
            except ConvergenceError as error:
                logger.info("   the slip is not known any better: %s", error)
                iterations += self._take(step, count)
                break
            halved = stepper.row()
            check = self._compare(row, halved, start, doubtful, count if fixed else 2 * count)
            if fixed:
                iterations += self._take(step, count)
                break
            row, count = halved, 2 * count
            if check.share <= SLIP_TOLERANCE:
                break
        self.slip_checks.append(check or SlipCheck(int(row["step"]), row["wg_angle_deg"], doubtful))
        return iterations

    def _rotation_before(self, step: Step) -> float | None:
        """Angle (deg) of the output before a step in which the wave generator stands; else None."""
        if step.before.load_state.angle != step.end.angle:
            return None
        problem = self.stepper.problem
        displacement = problem.displacement(step.before.x)
        return float(np.degrees(problem.supports.output_rotation(displacement)))

    def _compare(
        self,
        row: Mapping[str, float],
        halved: Mapping[str, float],
        start: float | None,
        doubtful: float,
        parts: int,
    ) -> SlipCheck:
        """What half the steps change. start : deg, `_rotation_before`;  parts : of the step"""
        torque = halved["wg_torque_Nmm"] - row["wg_torque_Nmm"]
        rotation = float(wrapped(halved["output_angle_deg"] - row["output_angle_deg"]))
        if start is None:
            by_teeth = halved["tooth_torque_Nmm"] / self.design.kinematics.ratio
            change, scale = torque, max(abs(halved["wg_torque_Nmm"]), abs(by_teeth))
        else:
            change, scale = rotation, abs(float(wrapped(halved["output_angle_deg"] - start)))
        return SlipCheck(
            step=int(halved["step"]),
            wg_angle_deg=halved["wg_angle_deg"],
            doubtful=doubtful,
            parts=parts,
            share=abs(change) / scale if scale else 0.0,
            by_rotation=start is not None,
            torque_change_Nmm=abs(torque),
            rotation_change_arcmin=60.0 * abs(rotation),
        )
