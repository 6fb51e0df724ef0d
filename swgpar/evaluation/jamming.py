"""Whether the input torque is that of the energy balance, and that of a drive whose teeth do not
jam."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from swgpar.load.load_sequence import LoadSequence
from swgpar.results.history import Row, column

TORQUE = "wg_torque_Nmm"

ENERGY = 0.05
"""Largest difference between the mean input torque of a drive without friction and T / ratio,
relative, beside the error by the angles.

The coupling of the plane model takes up to 2 % of it (docs/theory/drive.md); the rest is the
sampling.
"""

LEAST_EFFICIENCY = 0.5
"""Below this a drive loses more than it transmits: its teeth jam, or it turns against itself."""


def jamming_remark(
    sequence: LoadSequence,
    rows: Sequence[Row],
    means: Mapping[str, float],
    left: float,
    pairs: Sequence[Row],
) -> str | None:
    """A sentence where the mean input torque is far from that of the energy balance, T / ratio;
    else None. It names angle and pair as `energy_remark` does.

    Over a period the work of the input torque is that of the output torque, plus what friction
    takes. Less than a period, drives without a torque and bolted ones, which do not repeat after a
    pitch, are not judged. Nor is a difference that the torque left over can make.

    rows : increments of the rotation whose `means` are given
    left : N·mm, largest torque that an increment leaves over;  pairs : rows of pairs.csv
    """
    expected, mean = _expected(sequence, rows), means.get(TORQUE, 0.0)
    if expected is None or abs(mean - expected) <= left:
        return None
    if LEAST_EFFICIENCY * expected <= mean <= expected / LEAST_EFFICIENCY:
        return None
    where = _largest_departure(sequence, rows, pairs, mean - expected)
    return (
        f"the mean input torque of {mean:.4g} N·mm is far from the {expected:.4g} N·mm of the "
        f"energy balance, {where}: the teeth may jam, and the results are not those of a running "
        f"drive; swgpar check shows where teeth overlap{_too_few(rows, mean - expected)}"
    )


def energy_remark(
    sequence: LoadSequence,
    rows: Sequence[Row],
    means: Mapping[str, float],
    left: float,
    pairs: Sequence[Row],
    *,
    friction: bool,
) -> str | None:
    """A sentence where the mean input torque departs from the energy balance by more than its
    error; else None. With friction it may be larger.

    It names the angle at which the departure is largest, and the pair of flanks with the largest
    torque in its sense.

    left : N·mm, error of the mean by the increments and by the angles;  pairs : rows of pairs.csv
    """
    expected = _expected(sequence, rows)
    if not expected:
        return None
    departure, allowed = means[TORQUE] - expected, ENERGY * expected + left
    if abs(departure) <= allowed or (friction and departure > 0.0):
        return None
    return (
        f"the mean input torque of {means[TORQUE]:.4g} N·mm departs from the {expected:.4g} N·mm "
        f"of the energy balance by {100 * abs(departure) / expected:.2g} %, more than its error of "
        f"{100 * allowed / expected:.2g} %: {_largest_departure(sequence, rows, pairs, departure)}"
        f"{_too_few(rows, departure)}"
    )


def _too_few(rows: Sequence[Row], departure: float) -> str:
    """Words where the few angles can make a departure (N·mm) of the mean torque; else none.

    The mean over a period lies within the variation of the curve over twice the number of even
    angles, by Koksma's inequality, and the curve varies as much as its values at least.
    """
    torque = column(rows, TORQUE)
    variation = float(np.abs(torque - np.roll(torque, 1)).sum())
    if abs(departure) > variation / (2.0 * len(torque)):
        return ""
    return (
        f"; or {len(rows)} angles are too few for the mean of a torque that varies by "
        f"{np.ptp(torque):.4g} N·mm: steps.samples"
    )


def _largest_departure(
    sequence: LoadSequence, rows: Sequence[Row], pairs: Sequence[Row], departure: float
) -> str:
    """Words for the angle at which the input torque departs most in the sense of its mean, and for
    the pair with the largest torque in that sense."""
    sign = np.sign(departure)
    angle = max(rows, key=lambda row: sign * row[TORQUE])["wg_angle_deg"]
    # the torque of the teeth on the spline has the sign of the ratio
    sense = sign * np.sign(sequence.kinematics.ratio)
    pushing = [
        pair for pair in pairs if pair["wg_angle_deg"] == angle and sense * pair["torque_Nmm"] > 0.0
    ]
    where = f"most at {angle:.4g}° of the wave generator"
    if not pushing:
        return where
    pair = max(pushing, key=lambda pair: abs(pair["torque_Nmm"]))
    return (
        f"{where}, where tooth {pair['tooth']} of the flexible spline pushes on tooth "
        f"{pair['ring_tooth']} of the {pair.get('ring', 'ring_gear').replace('_', ' ')} with "
        f"{pair['force_N']:.3g} N at {pair['angle_deg']:.1f}° from +y"
    )


def _expected(sequence: LoadSequence, rows: Sequence[Row]) -> float | None:
    """The mean input torque, N mm, of rows of a whole period by the energy balance; None where it
    says nothing."""
    if not rows or not sequence.repeats or sequence.loaded.control == "rotation":
        return None
    angles = column(rows, "wg_angle_deg")
    covered = sequence.samples or (
        np.ptp(angles) + sequence.increment >= np.degrees(sequence.kinematics.period_angle)
    )
    return sequence.kinematics.wave_generator_torque(sequence.torque) if covered else None
