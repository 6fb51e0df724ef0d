"""How far one step of an increment may go: no tooth passes another one, and with friction the wave
generator turns by a part of the period only."""

from __future__ import annotations

import numpy as np

from swgpar.design.kinematics import Kinematics
from swgpar.load.load_states import LoadState

PART_OF_PITCH = 0.02
"""Largest rotation of the output beyond its kinematic one in a step, in pitches of the output.

A step of a pitch leads into the next slot, as if the drive had not moved. Teeth let go one after
the other: in a small drive at every 0.05 pitches, where longer steps find a torque that only rises.
"""

PART_OF_STANDING_PITCH = 0.25
"""Largest rotation of the wave generator in a step with friction, in pitches of the standing gear.

In a pitch every tooth takes the place of its neighbour. A point that was far from the other flank
at the begin of a step has no slip in it, and no friction. A pair is in contact for several quarters
of a pitch, so that its points are near the other flank one step before.
"""


def pitches_turned(origin: LoadState, target: LoadState, kinematics: Kinematics) -> float:
    """Rotation of the output between two load states under prescribed rotations, beyond what the
    wave generator's makes of it, in pitches of the output; positive as a positive torque turns
    it."""
    turned = target.output_rotation - origin.output_rotation
    turned -= (target.angle - origin.angle) / kinematics.ratio
    return float(kinematics.torque_direction * np.degrees(turned) / kinematics.output_pitch)


def steps_needed(
    origin: LoadState, target: LoadState, kinematics: Kinematics, *, friction: bool
) -> int:
    """Number of equal steps from one load state to another under the same control. friction :
    whether the flanks have it"""
    if not target.is_periodic:
        return 1
    parts = [0.0]
    if target.control == "rotation":
        parts.append(pitches_turned(origin, target, kinematics) / PART_OF_PITCH)
    if friction:
        pitches = (target.angle - origin.angle) / kinematics.pitch_angle
        parts.append(pitches / PART_OF_STANDING_PITCH)
    # an increment of just the bound is one step, whatever the last digit
    return max(1, int(np.ceil(round(max(map(abs, parts)), 9))))
