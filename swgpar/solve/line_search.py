"""The length of a Newton step while contacts switch on and off."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from mpi4py import MPI

from swgpar.log import PhaseTimes
from swgpar.petsc import PETSc
from swgpar.solve.bordered_system import BorderedSystem

CONSTRAINT_SHARE = 0.1
"""Share of the slope up to which constraints may contribute: it is then the potential's."""


class LineSearch:
    """Newton step with a line search along the potential: the `PC` (type python) of SNES.

    Contact switches on and off along a step, so that a full step can overshoot by orders of
    magnitude. The step is scaled by t in (0, 1] such that the slope F(x - t step) . step has fallen
    below half of its start: a point near the minimum of the potential on the line. The full step is
    tried first and taken near the solution. (PETSc's own line searches judge by the residual's
    norm, which grows while contact is being established, or take one secant step. petsc4py 3.18
    cannot replace them, hence the scaling inside the preconditioner.)

    A point of the flanks that begins to stick changes the slope over a ten-thousandth of a usual
    step. With few trials the sign of its slip changes in every step instead. With `descending` the
    search ends only where the potential still decreases, with trials down to the last digit, see
    `swgpar.solve.active_set_cycles`.

    The tangent may be indefinite (`DiscreteProblem.tangent`). A step along which the potential
    grows is then reversed, unless the residual halves along it all the same, as it does near a
    solution.

    system : linear system of the step;  x : present state;  phases : wall seconds
    residual : sets its second argument to that at the first; returns whether an element collapsed

    Attributes:
    descending : see above;  max_node_step : mm, bound of a node's displacement in a step
    """

    TARGET, TRIALS, DESCENDING_TRIALS = 0.5, 16, 60

    def __init__(
        self,
        system: BorderedSystem,
        residual: Callable[[PETSc.Vec, PETSc.Vec], bool],
        x: PETSc.Vec,
        phases: PhaseTimes,
    ) -> None:
        self.system = system
        self.residual = residual
        self.x = x
        self.phases = phases
        self.trial, self.force = x.duplicate(), x.duplicate()
        self.descending, self.max_node_step = False, np.inf

    def _residual(self, step: PETSc.Vec, t: float) -> bool:
        """Set `force` to the residual after t times the step; returns if an element collapsed."""
        # rounded as SNES does it with the scaled step, so that it meets the same point
        step.copy(self.trial)
        self.trial.scale(t)
        self.trial.aypx(-1.0, self.x)
        return self.residual(self.trial, self.force)

    def _halves(self, right: PETSc.Vec, step: PETSc.Vec) -> bool:
        """Whether the full step halves the residual; bounded ones hardly do, even to a maximum."""
        return not self._residual(step, 1.0) and self.force.norm() < 0.5 * right.norm()

    def _nodal(self, vector: PETSc.Vec) -> np.ndarray:
        """This rank's part of a vector without the multipliers at its end."""
        partition, values = self.system.partition, vector.array_r
        return values[: -partition.n_multipliers] if partition.has_multipliers else values

    def _grows(self, right: PETSc.Vec, step: PETSc.Vec, start: float) -> bool:
        """Whether the potential grows along a step whose slope `start` is negative.

        It is no measure of a step towards constraints that are not met yet, the multipliers' part
        of the slope.
        """
        slope = self.system.partition.comm.allreduce(
            float(self._nodal(right) @ self._nodal(step)), op=MPI.SUM
        )
        return abs(start - slope) < CONSTRAINT_SHARE * abs(slope)

    def _bound(self, step: PETSc.Vec) -> None:
        """Scale the step so that no node moves farther than `max_node_step`."""
        lengths = np.linalg.norm(self._nodal(step).reshape(-1, 3), axis=1)
        longest = self.system.partition.comm.allreduce(float(lengths.max(initial=0.0)), op=MPI.MAX)
        share = self.max_node_step / longest if longest > self.max_node_step else 1.0
        if share < 1.0:
            step.scale(share)

    def setUp(self, pc: PETSc.PC) -> None:
        """Factorise the tangent; called by PETSc."""
        with self.phases("factor"):
            self.system.setUp(pc)

    def apply(self, pc: PETSc.PC, right: PETSc.Vec, step: PETSc.Vec) -> None:
        """Set step to the scaled Newton step for the residual `right`; called by PETSc."""
        with self.phases("solve"):
            self.system.apply(pc, right, step)
        self._bound(step)
        start = right.dot(step)
        if start < 0.0 and self._grows(right, step, start) and not self._halves(right, step):
            step.scale(-1.0)
            start = -start
        elif not start > 0.0:
            return

        step.scale(self._scale(step, start))

    def _scale(self, step: PETSc.Vec, start: float) -> float:
        """Factor t of the step; start : slope of the potential at its beginning, above 0."""

        def slope(t: float) -> float:
            collapsed = self._residual(step, t)
            value = self.force.dot(step) / start
            return value if np.isfinite(value) and not collapsed else -1e30

        low = 0.0
        low_value = 1.0
        high = 1.0
        high_value = slope(1.0)
        t, value = 1.0, high_value
        least, trials = (
            (0.0, self.DESCENDING_TRIALS) if self.descending else (-self.TARGET, self.TRIALS)
        )
        for _ in range(trials):
            if least <= value <= self.TARGET or (t == 1.0 and value > 0.0):
                break
            t = low + (high - low) * float(np.clip(low_value / (low_value - high_value), 0.1, 0.9))
            value = slope(t)
            if value > 0.0:
                low, low_value, high_value = t, value, 0.5 * high_value
            else:
                high, high_value, low_value = t, value, 0.5 * low_value
        return low if self.descending and value < 0.0 else t
