"""The length of a Newton step while contacts switch on and off."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from swgpar.log import Phases
from swgpar.solve.bordered_system import BorderedSystem

MET = 0.1
"""Share of the slope that constraints may have for it to be that of the potential."""


class LineSearch:
    """Newton step with a line search along the potential: the `PC` (type python) of SNES's linear solve.

    Contact switches on and off along a step, so a full one can overshoot by orders of magnitude. The step is
    scaled by t in (0, 1] such that the slope F(x - t step) . step has fallen below half of its start: a point near
    the minimum of the potential on the line. The full step is tried first and kept near the solution. (PETSc's own
    line searches judge by the residual's norm, which grows while contact is being established, or take one secant
    step; petsc4py 3.18 cannot replace them, hence the scaling inside the preconditioner.)

    A point of the flanks that comes to stick changes the slope over a ten-thousandth of a usual way: with few trials
    its slip changes the sign in every step instead. `careful` lets the search end only where the potential still
    falls, with trials down to the last digit, see `swgpar.solve.active_set_cycles`.

    The tangent is indefinite where a thin rim gives way between contacts. A step along which the potential grows is
    then taken the other way, unless the residual halves along it all the same, as it does near a solution.

    `longest` (mm) bounds a node's way in a step.
    """

    TARGET, TRIALS, CAREFUL = 0.5, 16, 60

    def __init__(
        self,
        border: BorderedSystem,
        residual: Callable[[PETSc.Vec, PETSc.Vec], bool],
        x: PETSc.Vec,
        phases: Phases,
    ) -> None:
        self.border, self.residual, self.x, self.phases = border, residual, x, phases
        self.trial, self.force = x.duplicate(), x.duplicate()
        self.careful, self.longest = False, np.inf

    def _residual(self, step: PETSc.Vec, t: float) -> bool:
        """Put the residual after t times the step into `force`; whether an element has collapsed there."""
        # rounded as SNES does it with the scaled step, so that it meets the same point
        step.copy(self.trial)
        self.trial.scale(t)
        self.trial.aypx(-1.0, self.x)
        return self.residual(self.trial, self.force)

    def _halves(self, right: PETSc.Vec, step: PETSc.Vec) -> bool:
        """Whether the full step halves the residual; one that is bounded hardly does, even towards a maximum."""
        return not self._residual(step, 1.0) and self.force.norm() < 0.5 * right.norm()

    def _own(self, vector: PETSc.Vec) -> np.ndarray:
        """What this rank has of a vector without the multipliers behind it."""
        partition = self.border.partition
        last = partition.comm.rank == partition.comm.size - 1
        return vector.array_r[: -partition.n_multipliers] if last else vector.array_r

    def _grows(self, right: PETSc.Vec, step: PETSc.Vec, start: float) -> bool:
        """Whether the potential grows along a step whose slope `start` is negative.

        It is no measure of a step towards constraints that are not met yet, the multipliers' part of the slope.
        """
        slope = self.border.partition.comm.allreduce(float(self._own(right) @ self._own(step)), op=MPI.SUM)
        return abs(start - slope) < MET * abs(slope)

    def _bound(self, step: PETSc.Vec) -> float:
        """Shorten the step to the longest way of a node, to the share of it that is returned."""
        ways = np.linalg.norm(self._own(step).reshape(-1, 3), axis=1)
        way = self.border.partition.comm.allreduce(float(ways.max(initial=0.0)), op=MPI.MAX)
        share = self.longest / way if way > self.longest else 1.0
        if share < 1.0:
            step.scale(share)
        return share

    def setUp(self, pc: PETSc.PC) -> None:
        with self.phases("factor"):
            self.border.setUp(pc)

    def apply(self, pc: PETSc.PC, right: PETSc.Vec, step: PETSc.Vec) -> None:
        with self.phases("solve"):
            self.border.apply(pc, right, step)
        self._bound(step)
        start = right.dot(step)
        if start < 0.0 and self._grows(right, step, start) and not self._halves(right, step):
            step.scale(-1.0)
            start = -start
        elif not start > 0.0:
            return

        def slope(t: float) -> float:
            collapsed = self._residual(step, t)
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
