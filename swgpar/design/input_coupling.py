"""Section [input_coupling] of the drive's design file."""

from __future__ import annotations

import numpy as np

from swgpar.input.quantities import Section, not_negative, positive


class InputCoupling(Section):
    """Section [input_coupling]: the coupling between the motor's shaft and the cam. The stiffness,
    its backlash and lost motion are then those with the shaft locked; without it the cam is locked.
    """

    stiffness: float | None = positive(
        "torque on the cam over its rotation against the shaft; rigid without it",
        "N·m/rad",
        None,
        le=1e9,
    )
    play: float = not_negative(
        "angle by which the cam turns against the shaft without a torque, from end to end",
        "deg",
        0.0,
        le=10.0,
    )

    def output_stiffness(self, ratio: float) -> float | None:
        """Stiffness (N·m/rad) seen from the output; None where it is rigid.

        ratio : wave generator over output
        """
        return None if self.stiffness is None else ratio**2 * self.stiffness

    def output_play(self, ratio: float) -> float:
        """Play (rad) seen from the output."""
        return float(np.radians(self.play)) / abs(ratio)

    def rotation(self, torque: float, ratio: float) -> float:
        """Rotation (rad) of the output that the coupling allows under a torque (N·m) on the output,
        from the middle of its play. On the input the torque is over the ratio."""
        stiffness = self.output_stiffness(ratio)
        elastic = 0.0 if stiffness is None else torque / stiffness
        return float(np.sign(torque)) * 0.5 * self.output_play(ratio) + elastic
