"""Prescribed rotations of the output: steps that follow its torque where teeth meet and let go."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.step_bounds import PART_OF_PITCH, pitches_turned
from swgpar.design.program_sections import Ratcheting
from swgpar.errors import ConvergenceError
from swgpar.evaluation.ratcheting import TorquePoint, overshoot, why_ended
from swgpar.load.load_states import LoadState
from swgpar.log import logger

BEND, BEND_DOWN = 0.1, 0.02
"""Largest departure of a torque from the straight line through the two before it, away from zero
and towards it, over the largest torque of the three. Teeth that let go bend the curve down."""

SMALLEST_STEP = PART_OF_PITCH / 16.0
"""Pitches: where flanks meet the torque bends at a point, and no smaller step makes it straight."""

SMALLEST_STEP_AT_PEAK = PART_OF_PITCH / 1024.0
"""Pitches: where equilibrium is lost the torque falls at once, whatever the step."""

EARLY_FALL = 0.125
"""Share of the tolerance of the peak by which the torque may be missed at a fall: Newton's
iteration leaves the rising branch before its end, and later after smaller steps."""

SAME_SHARE = 1e-9
"""Share of an increment that is round-off."""

SAME_PLACE = 1e-6
"""Difference (deg) of two rotations that are the same."""


class RotationPath:
    """Follows the torque of the output under a prescribed rotation.

    A step is halved until the torque at its end is nearly on the straight line through the two
    before it. After a fall it is halved until the peak is known to `tolerance`. In a backlash,
    where no flanks touch, it is not: a bearing has a small torque there, which no step makes
    straight.

    stepper : whose states are advanced
    points : so far; those of later steps are appended
    measure : makes a point of the present state; collective
    tolerance : share of the peak torque
    section : says where the way ends; None without an end
    """

    def __init__(
        self,
        stepper: LoadStepper,
        points: list[TorquePoint],
        measure: Callable[[], TorquePoint],
        tolerance: float,
        section: Ratcheting | None,
    ) -> None:
        self.stepper, self.points, self.measure = stepper, points, measure
        self.tolerance, self.section = tolerance, section
        self._step = PART_OF_PITCH
        # N·m; below it torques are round-off of the forces that bend the spline
        self._floor = stepper.design.negligible_torque_Nm
        self._is_free = False

    def follow(self, target: LoadState) -> None:
        """Go to `target`, or to where the torque has fallen; the stepper's iterations are those of
        all steps.

        Raises ConvergenceError where neither small steps nor large ones find an equilibrium; the
        last point is then the last state that has it.
        """
        stepper, here = self.stepper, self.measure()
        if stepper.load_state.control == "torque":
            stepper.hold_output()
        origin = stepper.origin(target)
        whole = abs(pitches_turned(origin, target, stepper.design.kinematics))
        if not self.points or abs(self.points[-1].rotation_deg - here.rotation_deg) > SAME_PLACE:
            self.points[:] = [here]  # the way to here was not a prescribed rotation
        done, iterations, steps, leaps = 0.0, 0, 0, False
        self._is_free = not stepper.problem.touching_pairs()
        while done < 1.0 and not self.has_ended():
            before, end = stepper.snapshot(), done + self._step / whole
            end = 1.0 if end > 1.0 - SAME_SHARE else end
            step, failure = (end - done) * whole, None
            try:
                stepper.advance(stepper.between(origin, target, end), cut_back=False)
                point = self.measure()
            except ConvergenceError as error:
                failure = error
            iterations, steps = iterations + stepper.iterations, steps + 1
            free = failure is None and not stepper.problem.touching_pairs()
            in_backlash = free and self._is_free
            if failure is None and (leaps or in_backlash or self._is_resolved(point, step)):
                self.points.append(point)
                self._is_free = free
                # the last step of an increment may be a short one
                done, self._step = end, min(max(self._step, 2.0 * step), PART_OF_PITCH)
                leaps = False
                continue
            stepper.restore(before)
            if failure is not None and (leaps or step <= SMALLEST_STEP):
                # no equilibrium is near: look for one that is farther
                if leaps and (self._step >= PART_OF_PITCH or end == 1.0):
                    stepper.iterations = iterations
                    raise failure
                leaps, self._step = True, 4.0 * step
            else:
                self._step = 0.5 * step
        stepper.iterations = iterations
        if steps > 1:
            logger.info("   in %d steps, the last of %.2g pitches", steps, step)

    def has_ended(self) -> bool:
        """Whether the torque has fallen from its peak, or is sufficient."""
        return self.section is not None and bool(why_ended(self.section, self.points, self._floor))

    def _is_resolved(self, point: TorquePoint, step: float) -> bool:
        """Whether the steps so far, one of so many pitches to `point` the last, show the torque."""
        known = [*self.points[-3:], point]
        torques = [abs(one.torque_Nm) for one in known]
        missed = overshoot([one.rotation_deg for one in known], torques)
        scale, top = max(self._floor, *torques), max(abs(one.torque_Nm) for one in self.points)
        falls_unseen = missed > EARLY_FALL * self.tolerance * scale
        falls_unseen &= step > SMALLEST_STEP_AT_PEAK
        if falls_unseen and max(torques) + missed > (1.0 + self.tolerance) * top:
            return False
        # behind a torque that is not from a rotation there is no line yet
        starts = len(known) == 2 and abs(known[0].torque_Nm) > self._floor
        bend = 0.0 if starts else departure(known)
        return step <= SMALLEST_STEP or -BEND_DOWN * scale <= bend <= BEND * scale


def departure(points: Sequence[TorquePoint]) -> float:
    """How far (N·m) the last torque is above the straight line through the two before it in
    magnitude; above the one before it where there is no other."""
    if len(points) < 2:
        return 0.0
    before, last = points[-2:]
    expected = before.torque_Nm
    if len(points) > 2 and before.rotation_deg != points[-3].rotation_deg:
        slope = before.torque_Nm - points[-3].torque_Nm
        slope /= before.rotation_deg - points[-3].rotation_deg
        expected += slope * (last.rotation_deg - before.rotation_deg)
    return (last.torque_Nm - expected) * (1.0 if before.torque_Nm >= 0.0 else -1.0)
