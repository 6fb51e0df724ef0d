"""Pitch deviations of a gear: tolerances of ISO 1328-1 and random deviations that stay in them.

ISO 1328-1:2013, section 5.3: with the pitch diameter d and the module m in mm and the tolerance
class A

    f_pT = (0.001 d + 0.4 m + 5) sqrt(2)^(A - 5)                     single pitch, eq. 5
    F_pT = (0.002 d + 0.55 sqrt(d) + 0.7 m + 12) sqrt(2)^(A - 5)     total cumulative pitch, eq. 6

in micrometres. The standard rounds these values; here they are not rounded.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class PitchTolerances(NamedTuple):
    """Bounds, µm. single : f_pT, of neighbours' difference;  total : F_pT, of any two teeth"""

    single: float
    total: float


def pitch_tolerances(diameter: float, module: float, grade: int) -> PitchTolerances:
    """Tolerances (µm) of a gear of this pitch diameter and module (mm), tolerance class 1 to 11."""
    factor = 2.0 ** (0.5 * (grade - 5))
    single = (0.001 * diameter + 0.4 * module + 5.0) * factor
    total = (0.002 * diameter + 0.55 * np.sqrt(diameter) + 0.7 * module + 12.0) * factor
    return PitchTolerances(single, float(total))


def random_pitch_errors(
    n_teeth: int, tolerances: PitchTolerances, seed: tuple[int, ...]
) -> np.ndarray:
    """Positions (n_teeth,) µm, of mean 0, of the teeth on the pitch circle less the theoretical.

    Differences of neighbours are drawn from a normal distribution and closed over the circle. They
    are then scaled so that single and total pitch deviation stay in their tolerances and one of
    them reaches it: the gear just meets its grade.

    seed : the same numbers give the same deviations
    """
    single = np.random.default_rng(seed).standard_normal(n_teeth)
    single -= single.mean()
    position = np.cumsum(single)
    reached = max(np.abs(single).max() / tolerances.single, np.ptp(position) / tolerances.total)
    return (position - position.mean()) / reached
