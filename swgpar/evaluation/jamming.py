"""Whether the input torque is that of a drive whose teeth do not jam."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from swgpar.load.load_sequence import LoadSequence
from swgpar.results.history import Row, column

LEAST_EFFICIENCY = 0.5
"""Below this a drive loses more than it transmits: its teeth jam, or it turns against itself."""


def jamming_remark(
    sequence: LoadSequence, rows: Sequence[Row], means: Mapping[str, float], left: float
) -> str | None:
    """A sentence where the mean input torque is far from that of the energy balance, T / ratio;
    else None.

    Over a period the work of the input torque is that of the output torque, plus what friction
    takes. Less than a period, drives without a torque and bolted ones, which do not repeat after a
    pitch, are not judged. Nor is a difference that the torque left over can make.

    rows : increments of the rotation whose `means` are given
    left : N·mm, largest torque that an increment leaves over
    """
    if not rows or not sequence.repeats or sequence.loaded.control == "rotation":
        return None
    kinematics, angles = sequence.kinematics, column(rows, "wg_angle_deg")
    expected = kinematics.wave_generator_torque(sequence.torque)
    covered = sequence.samples or (
        np.ptp(angles) + sequence.increment >= np.degrees(kinematics.period_angle)
    )
    mean = means["wg_torque_Nmm"]
    near = LEAST_EFFICIENCY * expected <= mean <= expected / LEAST_EFFICIENCY
    if not covered or near or abs(mean - expected) <= left:
        return None
    return (
        f"the mean input torque of {mean:.4g} N·mm is far from the {expected:.4g} N·mm of the "
        f"energy balance: the "
        "teeth may jam, and the results are not those of a running drive; swgpar check shows where "
        "teeth overlap"
    )
