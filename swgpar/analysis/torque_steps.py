"""Steps of the torque that a load program has taken at angles of the wave generator: each foretells
the same step at another angle."""

from __future__ import annotations

import math
from collections.abc import Sequence

from swgpar.analysis.predictor import SAME_ANGLE, KnownState
from swgpar.load.load_states import LoadState
from swgpar.petsc import PETSc

SAME_TORQUE = 1e-9
"""Relative difference of two torques that are the same."""

BEND = 0.1
"""What a straight line misses of a step, over the step, from which on it foretells less than the
same step at another angle. In small drives a line that misses 0.3 and 0.5 takes 14 to 52 Newton
iterations, the other way 2; where it misses 0.03 the line takes 1, the other way 1 or 2."""


class TorqueSteps:
    """States of a load program under torques."""

    def __init__(self) -> None:
        self._known: list[tuple[LoadState, PETSc.Vec]] = []

    def keep(self, state: LoadState, x: PETSc.Vec) -> None:
        """Keep x, which nobody changes any more, as that of a state."""
        self._known.append((state, x))

    def elsewhere(self, loads: Sequence[LoadState]) -> list[list[KnownState]] | None:
        """The states under each of these loads of one angle, at the same other angles; None where
        there are none. Between torques of different signs is a backlash, which nothing foretells.
        """
        signs = {math.copysign(1.0, load.torque) for load in loads}
        angles = {load.angle for load in loads}
        if {load.control for load in loads} != {"torque"} or len(signs) > 1 or len(angles) > 1:
            return None
        under = [self._under(load) for load in loads]
        shared = [angle for angle in under[0] if all(angle in known for known in under)]
        return [[known[angle] for angle in shared] for known in under] if shared else None

    def bends(self, loads: Sequence[LoadState], factor: float) -> bool:
        """Whether at another angle the straight line through the first two of three loads, on by
        this share of the step between them, misses the last one by more than `BEND`; collective."""
        known = self.elsewhere(loads)
        if known is None:
            return False
        older, last, target = (states[-1].x for states in known)
        step, line = target.copy(), last.copy()
        step.axpy(-1.0, last)
        line.axpy(-1.0, older)
        change = step.norm()
        step.axpy(-factor, line)
        missed = step.norm()
        step.destroy()
        line.destroy()
        return bool(missed > BEND * change)

    def _under(self, load: LoadState) -> dict[float, KnownState]:
        """The states under a torque, by their angles; not those at the angle of the load."""
        return {
            state.angle: KnownState(state.angle, x)
            for state, x in self._known
            if abs(state.angle - load.angle) > SAME_ANGLE
            and abs(state.torque - load.torque) <= SAME_TORQUE * abs(load.torque)
        }
