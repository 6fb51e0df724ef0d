"""History of the whole rotation from the angles that are sampled in one period.

After a rotation of the wave generator by one pitch of the fixed gear, the drive is in the same
state with its teeth renumbered by one, and the output has rotated by pitch / ratio. Without
friction this is exact. With friction it holds once the slip is periodic.
"""

from __future__ import annotations

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.load.load_states import LoadState, Stage
from swgpar.results.history import Row


def of_period(design: DriveDesign, rows: list[Row]) -> list[Row]:
    """The last `steps.samples` rows, which are repeated; without friction the first of them is the
    loaded state."""
    return rows[-design.steps.samples :]


def sample_of(design: DriveDesign, state: LoadState) -> int | None:
    """Number of the sample of the repeated period, from 0, that a load state is; None outside of
    that period.

    In a load program every point is a sample.
    """
    if state.stage == Stage.PROGRAM:
        return state.step - Stage.LOAD
    samples = design.steps.samples
    if not samples or not state.is_periodic:
        return None
    # with friction the first of two periods settles
    number = round(state.angle / design.period_angle * samples) - (
        samples + 1 if design.contact.friction else 0
    )
    return number if 0 <= number < samples else None


def require_samples(design: DriveDesign) -> None:
    """Raise InputError where fatigue or losses are asked for without a sampled period."""
    if (design.fatigue or design.losses) and not (design.steps.samples or design.has_program):
        section = "fatigue" if design.fatigue else "losses"
        raise InputError(
            f"[{section}] is not available with steps.samples = 0: allowed 1 to 1000, with "
            f"steps.rotation of at least "
            f"{np.degrees(design.period_angle) * design.periods:.6g} degrees"
        )


def sampling_error(
    design: DriveDesign, rows: list[Row], names: tuple[str, ...]
) -> dict[str, float]:
    """Differences of the means over the period from those of half as many samples; empty for odd
    numbers of samples."""
    if design.steps.samples % 2:
        return {}
    period = of_period(design, rows)
    return {
        name: abs(
            float(np.mean([r[name] for r in period]) - np.mean([r[name] for r in period[::2]]))
        )
        for name in names
    }


def continued(design: DriveDesign, rows: list[Row]) -> list[Row]:
    """History up to `steps.rotation` from the rows of all computed increments, a period or more.

    The added rows have no wall time and no iterations.
    """
    out, period = list(rows), of_period(design, rows)
    pitch, periods = np.degrees(design.period_angle), 1
    while True:
        for row in period:
            angle = row["wg_angle_deg"] + periods * pitch
            if angle > design.steps.rotation * (1.0 + 1e-9):
                return out
            out.append(
                {
                    **row,
                    "step": out[-1]["step"] + 1,
                    "wg_angle_deg": angle,
                    "output_angle_deg": row["output_angle_deg"] + periods * pitch / design.ratio,
                    "newton_iterations": 0,
                    "wall_s": 0.0,
                }
            )
        periods += 1
