"""Ranges over a sampled period: of the transmission error and of the input torque, with their
errors.

The error has two parts. The angles may miss the largest and the smallest value: the range over
every other angle shows how much. The mesh is shown by the same period on a coarser one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from swgpar.design.kinematics import Kinematics
from swgpar.results.history import Row, column, transmission_error

INPUT_TORQUE = "wg_torque_Nmm"

MISSED = 1.0 / 3.0
"""Error of a largest value by the angles, over what every other angle changes: a smooth curve rises
between angles by the square of their distance."""


@dataclass(frozen=True)
class PeriodRanges:
    """Largest less smallest over a period, or errors of these.

    transmission_error : arc seconds;  torque : N mm, of the input
    """

    transmission_error: float
    torque: float


@dataclass(frozen=True)
class CoarsePeriod:
    """Ranges on a coarser mesh.

    factor : on the changes from there, which gives the errors by the mesh
    """

    ranges: PeriodRanges
    factor: float


def period_ranges(kinematics: Kinematics, rows: Sequence[Row], torque: str) -> PeriodRanges:
    """Ranges over rows of the history. torque : column of the input torque"""
    angles = column(rows, "wg_angle_deg"), column(rows, "output_angle_deg")
    return PeriodRanges(
        float(np.ptp(transmission_error(*angles, kinematics.ratio))),
        float(np.ptp(column(rows, torque))),
    )


def range_errors(
    kinematics: Kinematics, rows: Sequence[Row], torque: str, coarse: CoarsePeriod | None
) -> PeriodRanges | None:
    """Errors of the ranges over the rows of a period; None where they are not known: without a
    coarser mesh, or with an odd number of angles."""
    if coarse is None or len(rows) % 2:
        return None
    every = period_ranges(kinematics, rows, torque)
    halves = [period_ranges(kinematics, rows[first::2], torque) for first in (0, 1)]

    def error(name: str) -> float:
        value = getattr(every, name)
        missed = MISSED * (value - min(getattr(half, name) for half in halves))
        return float(missed + coarse.factor * abs(value - getattr(coarse.ranges, name)))

    return PeriodRanges(error("transmission_error"), error("torque"))
