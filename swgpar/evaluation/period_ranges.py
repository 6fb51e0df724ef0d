"""Ranges over a sampled period: of the transmission error and of the input torque, with their
errors.

The error has two parts, of which one does not know of the other. The angles may miss the largest
and the smallest value (`missed_peaks`). The mesh is shown by the same angles on a coarser one. Its
curve may have another shape and the same range, so the whole curves are compared.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from swgpar.answers.missed_peaks import FEWEST, missed_range
from swgpar.design.kinematics import Kinematics
from swgpar.evaluation.period import in_order, places
from swgpar.results.history import Row, column, transmission_error

INPUT_TORQUE = "wg_torque_Nmm"


@dataclass(frozen=True)
class PeriodRanges:
    """Largest less smallest over a period, or errors of these.

    transmission_error : arc seconds;  torque : N mm, of the input
    """

    transmission_error: float
    torque: float


@dataclass(frozen=True)
class PeriodCurves:
    """Values at the angles of a period.

    transmission_error : (n,) arc seconds;  torque : (n,) N mm, of the input
    """

    transmission_error: list[float]
    torque: list[float]

    @property
    def ranges(self) -> PeriodRanges:
        """Largest less smallest."""
        return PeriodRanges(
            float(np.ptp(self.transmission_error)),
            float(np.ptp(self.torque)),
        )


@dataclass(frozen=True)
class CoarsePeriod:
    """A period on a coarser mesh.

    curves : at the angles of the run
    factor : on the changes from there, which gives the errors by the mesh
    """

    curves: PeriodCurves
    factor: float


def period_curves(kinematics: Kinematics, rows: Sequence[Row], torque: str) -> PeriodCurves:
    """Curves over rows of the history. torque : column of the input torque"""
    angles = column(rows, "wg_angle_deg"), column(rows, "output_angle_deg")
    error = transmission_error(*angles, kinematics.ratio)
    return PeriodCurves(error.tolist(), column(rows, torque).tolist())


def range_errors(
    kinematics: Kinematics, rows: Sequence[Row], torque: str, coarse: CoarsePeriod | None
) -> PeriodRanges | None:
    """Errors of the ranges over the rows of a period; None where they are not known: without a
    coarser mesh, or with fewer than four angles that show different states."""
    order = in_order(places(kinematics, rows))
    if coarse is None or len(order) < FEWEST:
        return None
    curves = period_curves(kinematics, rows, torque)

    def error(name: str) -> float:
        value, before = (np.array(getattr(one, name)) for one in (curves, coarse.curves))
        by_mesh = coarse.factor * float(np.ptp(value - before))
        return math.hypot(missed_range(value[order]), by_mesh)

    return PeriodRanges(error("transmission_error"), error("torque"))
