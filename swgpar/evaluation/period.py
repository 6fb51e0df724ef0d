"""History of the whole rotation from the angles that are sampled in one period.

After a rotation of the wave generator by one pitch of the fixed gear, the drive is in the same
state with its teeth renumbered by one, and the output has rotated by pitch / ratio. Without
friction this is exact. With friction it holds once the slip is periodic.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from swgpar.errors import InputError
from swgpar.load.load_sequence import LoadSequence
from swgpar.load.load_states import LoadState, Stage
from swgpar.results.history import Row


def of_period(sequence: LoadSequence, rows: list[Row]) -> list[Row]:
    """The last `samples` rows, which are repeated; without friction the first of them is the
    loaded state."""
    return rows[-sequence.samples :]


def sample_of(sequence: LoadSequence, state: LoadState) -> int | None:
    """Number of the sample of the repeated period, from 0, that a load state is; None outside of
    that period.

    In a load program every point is a sample.
    """
    if state.stage == Stage.PROGRAM:
        return state.step - Stage.LOAD
    samples = sequence.samples
    if not samples or not state.is_periodic:
        return None
    number = round(state.angle / sequence.kinematics.period_angle * samples)
    if sequence.periods > 1:  # the first of two periods settles
        number -= samples + 1
    return number if 0 <= number < samples else None


def require_samples(sequence: LoadSequence, sections: Sequence[str]) -> None:
    """Raise InputError where sections that need a sampled period are asked for without one."""
    if sections and not sequence.samples and not sequence.points:
        least = np.degrees(sequence.kinematics.period_angle) * sequence.periods
        raise InputError(
            f"[{sections[0]}] is not available with steps.samples = 0: allowed 1 to 1000, with "
            f"steps.rotation of at least {least:.6g} degrees"
        )


def sampling_error(
    sequence: LoadSequence, rows: list[Row], names: tuple[str, ...]
) -> dict[str, float]:
    """Differences of the means over the period from those of half as many samples; empty for odd
    numbers of samples."""
    if sequence.samples % 2:
        return {}
    period = of_period(sequence, rows)
    return {
        name: abs(
            float(np.mean([r[name] for r in period]) - np.mean([r[name] for r in period[::2]]))
        )
        for name in names
    }


def continued(sequence: LoadSequence, rows: list[Row]) -> list[Row]:
    """History up to `steps.rotation` from the rows of all computed increments, a period or more.

    The added rows have no wall time and no iterations.
    """
    out, period = list(rows), of_period(sequence, rows)
    ratio, pitch = sequence.kinematics.ratio, np.degrees(sequence.kinematics.period_angle)
    periods = 1
    while True:
        for row in period:
            angle = row["wg_angle_deg"] + periods * pitch
            if angle > sequence.rotation * (1.0 + 1e-9):
                return out
            out.append(
                {
                    **row,
                    "step": out[-1]["step"] + 1,
                    "wg_angle_deg": angle,
                    "output_angle_deg": row["output_angle_deg"] + periods * pitch / ratio,
                    "newton_iterations": 0,
                    "wall_s": 0.0,
                }
            )
        periods += 1
