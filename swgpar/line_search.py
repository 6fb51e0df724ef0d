"""The length of a Newton step while contacts switch on and off."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from swgpar.linear import Bordered
from swgpar.log import Phases


class SearchedStep:
    """Newton step with a line search along the potential: the `PC` (type python) of SNES's linear solve.

    Contact switches on and off along a step, so a full one can overshoot by orders of magnitude. The step is
    scaled by t in (0, 1] such that the slope F(x - t step) . step has fallen below half of its start: a point near
    the minimum of the potential on the line. The full step is tried first and kept near the solution. (PETSc's own
    line searches judge by the residual's norm, which grows while contact is being established, or take one secant
    step; petsc4py 3.18 cannot replace them, hence the scaling inside the preconditioner.)

    A point of the flanks that comes to stick changes the slope over a ten-thousandth of a usual way: with few trials
    its slip changes the sign in every step instead. `careful` lets the search end only where the potential still
    falls, with trials down to the last digit, see `swgpar.cycling`.
    """

    TARGET, TRIALS, CAREFUL = 0.5, 16, 60

    def __init__(
        self, border: Bordered, residual: Callable[[PETSc.Vec, PETSc.Vec], bool], x: PETSc.Vec, phases: Phases
    ) -> None:
        self.border, self.residual, self.x, self.phases = border, residual, x, phases
        self.trial, self.force = x.duplicate(), x.duplicate()
        self.careful = False

    def setUp(self, pc: PETSc.PC) -> None:
        with self.phases("factor"):
            self.border.setUp(pc)

    def apply(self, pc: PETSc.PC, right: PETSc.Vec, step: PETSc.Vec) -> None:
        with self.phases("solve"):
            self.border.apply(pc, right, step)
        start = right.dot(step)
        if not start > 0.0:  # no descent: leave it to the plain Newton step
            return

        def slope(t: float) -> float:
            # rounded as SNES does it with the scaled step, so that it meets the same point
            step.copy(self.trial)
            self.trial.scale(t)
            self.trial.aypx(-1.0, self.x)
            collapsed = self.residual(self.trial, self.force)
            value = self.force.dot(step) / start
            return value if np.isfinite(value) and not collapsed else -1e30

        low, low_value, high, high_value = 0.0, 1.0, 1.0, slope(1.0)
        t, value = 1.0, high_value
        least, trials = (0.0, self.CAREFUL) if self.careful else (-self.TARGET, self.TRIALS)
        for _ in range(trials):
            if least <= value <= self.TARGET or (t == 1.0 and value > 0.0):
                break
            t = low + (high - low) * float(np.clip(low_value / (low_value - high_value), 0.1, 0.9))
            value = slope(t)
            if value > 0.0:
                low, low_value, high_value = t, value, 0.5 * high_value
            else:
                high, high_value, low_value = t, value, 0.5 * low_value
        step.scale(low if self.careful and value < 0.0 else t)
