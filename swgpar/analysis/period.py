"""One period of the motion stands for all: the history over the whole rotation from the angles sampled in it.

When the wave generator has turned by one pitch of the fixed gear, the drive is the same with its teeth renamed by
one, and the output has turned by pitch / ratio. Without friction this is exact; with friction it holds once the slip
has settled.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from swgpar.design.drive_design import DriveDesign

Row = dict[str, Any]


def of_period(design: DriveDesign, rows: list[Row]) -> list[Row]:
    """The last `steps.samples` rows: those that are continued, without friction from the loaded state on."""
    return rows[-design.steps.samples :]


def sampling_error(design: DriveDesign, rows: list[Row], names: tuple[str, ...]) -> dict[str, float]:
    """How far the means over the period are from those of every second sample; empty for odd numbers of samples."""
    if design.steps.samples % 2:
        return {}
    period = of_period(design, rows)
    return {
        name: abs(float(np.mean([r[name] for r in period]) - np.mean([r[name] for r in period[::2]]))) for name in names
    }


def continued(design: DriveDesign, rows: list[Row]) -> list[Row]:
    """History (rows of all computed increments, a period or more) with the rows that follow up to `steps.rotation`.

    Rows that follow cost no time and no iterations.
    """
    out, period = list(rows), of_period(design, rows)
    pitch, turns = np.degrees(design.period_angle), 1
    while True:
        for row in period:
            angle = row["wg_angle_deg"] + turns * pitch
            if angle > design.steps.rotation * (1.0 + 1e-9):
                return out
            out.append(
                {
                    **row,
                    "step": str(int(out[-1]["step"]) + 1),
                    "wg_angle_deg": angle,
                    "output_angle_deg": row["output_angle_deg"] + turns * pitch / design.ratio,
                    "newton_iterations": 0,
                    "wall_s": 0.0,
                }
            )
        turns += 1
