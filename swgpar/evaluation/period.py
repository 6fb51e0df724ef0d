"""History of the whole rotation from the angles that are sampled in one period.

After a period of the motion, a rotation of the wave generator by one pitch of the fixed gear or
with bolts by several, the drive is in the same state with its teeth renumbered, and the output has
rotated by period / ratio. Against the wave generator the state is the same: vectors in space have
rotated by the period. Without friction this is exact. With friction it holds once the slip is
periodic.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from swgpar.design.kinematics import Kinematics
from swgpar.errors import InputError
from swgpar.geometry.rotation import rotated
from swgpar.load.load_sequence import LoadSequence
from swgpar.load.load_states import LoadState, Stage
from swgpar.results.history import IN_SPACE, Row, column

PLACE_DIGITS = 6
"""Digits in which places of a period that are the same agree."""


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


def places(kinematics: Kinematics, rows: Sequence[Row]) -> np.ndarray:
    """Places (n,) of the rows of a period in the part of it after which the state repeats, 0 to
    1."""
    part = np.degrees(kinematics.period_angle) / kinematics.repeats(len(rows))
    return np.round(column(rows, "wg_angle_deg") / part % 1.0, PLACE_DIGITS) % 1.0


def in_order(place: np.ndarray) -> np.ndarray:
    """Indices of different places in ascending order, one for each."""
    return np.unique(place, return_index=True)[1]


def sampling_error(
    sequence: LoadSequence, rows: list[Row], names: tuple[str, ...]
) -> dict[str, float]:
    """Differences of the means over the period from those over every other place of its samples;
    empty for a single place.

    With balls that pass they are at least the standard deviation over the number of samples: waves
    in which teeth and balls move together have the phase of every other place by chance.
    """
    period = of_period(sequence, rows)
    place = places(sequence.kinematics, period)
    half = in_order(place)[::2]
    if len(half) == len(np.unique(place)):
        return {}
    gaps = np.diff(place[half], append=place[half[0]] + 1.0)
    weights = 0.5 * (gaps + np.roll(gaps, 1))
    passes = sequence.kinematics.ball_passings(len(period)) != 0
    found = {}
    for name in names:
        values = column(period, name)
        error = abs(float(values.mean() - weights @ values[half]))
        found[name] = max(error, float(values.std()) / len(values)) if passes else error
    return found


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
                    **_in_space(row, np.radians(periods * pitch)),
                    "step": out[-1]["step"] + 1,
                    "wg_angle_deg": angle,
                    "output_angle_deg": row["output_angle_deg"] + periods * pitch / ratio,
                    "newton_iterations": 0,
                    "wall_s": 0.0,
                }
            )
        periods += 1


def _in_space(row: Row, angle: float) -> Row:
    """Vectors in space of a row, after the state has rotated by an angle (rad)."""
    pairs = [pair for pair in IN_SPACE if pair[0] in row]
    turned = [rotated(np.array([row[name] for name in pair]), angle) for pair in pairs]
    return {
        name: float(value)
        for pair, values in zip(pairs, turned, strict=True)
        for name, value in zip(pair, values, strict=True)
    }
