"""Motion of a loaded output: how far it may move in a Newton step, and what closes the backlash."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from swgpar.constraints.supports import SPLINE_COUPLING, Supports
from swgpar.contact.clearance import LOADED_SIDE, FlankClearance
from swgpar.contact.flanks import FlankContact
from swgpar.load.load_states import LoadState


class TorqueControl:
    """Bounds and closes the clearance of the flanks that carry the torque; all is collective.

    supports : of the drive;  clearances : of the flanks, one for each ring gear
    """

    def __init__(self, supports: Supports, clearances: Sequence[FlankClearance]) -> None:
        self.supports, self.clearances = supports, clearances

    def output_step_bound(self, state: LoadState) -> float | None:
        """Bound of the output's motion in a step, in units of the last border, or None.

        The output closes its own clearance to a flexible spline that is held. One that is not it
        takes along, and closes the clearance to the fixed ring gear too.
        """
        if state.control != "torque":
            return None
        held = self.supports.holds_spline(state)
        return self.supports.scale * min(
            (
                clearance.largest_rotation(self._loaded_side(clearance.flanks, state))
                for clearance in self.clearances
                if not held or self._is_output(clearance.flanks)
            ),
            default=np.inf,
        )

    def closing_rotation(self, u: np.ndarray, state: LoadState) -> float:
        """Rotation (rad) of the output, along the torque of `state`, that brings flanks together.

        They are those of the output, or where the flexible spline rotates with it those of the
        fixed ring gear. 0 where a Newton step does the rest, or where none is near.

        u : (n_local, 3) mm, of the last search
        """
        held = self.supports.holds_spline(state)
        (clearance,) = (one for one in self.clearances if self._is_output(one.flanks) == held)
        clearance.flanks.evaluate(u, state, None, None)
        side = self._loaded_side(clearance.flanks, state)
        return float(np.copysign(clearance.closing_rotation(side), state.torque))

    def _is_output(self, flanks: FlankContact) -> bool:
        """Whether the ring gear of these flanks is the output."""
        return self.supports.output_gear != SPLINE_COUPLING and flanks.ring_motion.floats

    def _loaded_side(self, flanks: FlankContact, state: LoadState) -> int:
        """Side of the flanks that carry the torque, on the flexible spline or the ring gear."""
        counter_clockwise = (state.torque >= 0.0) != self._is_output(flanks)
        return LOADED_SIDE if counter_clockwise else -LOADED_SIDE
