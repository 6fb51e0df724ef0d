"""A mesh with backlash: force and energy, and their expectations for a normally distributed
deflection.

    f(d) = k (d - b) beyond b, k (d + b) below -b, 0 between;    P(d) = k (|d| - b)² / 2 outside, 0
    between

P is the integral of f. Equation 4.32 of the source lacks k b² / 2: its energy jumps at the gap's
ends. Arrays broadcast; stiffness k in N/m, deflections d, half backlash b, deviations s >= 0 in m.
"""

from __future__ import annotations

import numpy as np
from scipy.special import ndtr

Values = np.ndarray | float


def dead_zone(deflection: Values, half_backlash: Values) -> np.ndarray:
    """The part of a deflection beyond the backlash, m."""
    return deflection - np.clip(deflection, -half_backlash, half_backlash)


def force(stiffness: Values, deflection: Values, half_backlash: Values) -> np.ndarray:
    """f, N."""
    return stiffness * dead_zone(deflection, half_backlash)


def energy(stiffness: Values, deflection: Values, half_backlash: Values) -> np.ndarray:
    """P, J."""
    return 0.5 * stiffness * dead_zone(deflection, half_backlash) ** 2


def _beyond(
    mean: Values, deviation: Values, half_backlash: Values
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Expectations (2, ...) of 1, x and x² over x = d - b > 0 and over x = -d - b > 0."""
    m, s = np.asarray(mean, dtype=float), np.asarray(deviation, dtype=float)
    x = np.array([m - half_backlash, -m - half_backlash])
    ratio = x / np.where(s > 0.0, s, 1.0)
    share = np.where(s > 0.0, ndtr(ratio), x > 0.0)
    tail = s * np.exp(-0.5 * np.minimum(ratio**2, 1400.0)) / np.sqrt(2.0 * np.pi)
    first = x * share + tail
    return share, first, (x * x + s * s) * share + x * tail


def mean_force(
    stiffness: Values, mean: Values, deviation: Values, half_backlash: Values
) -> np.ndarray:
    """E[f], N (eq. 4.50)."""
    return mean_force_and_stiffness(stiffness, mean, deviation, half_backlash)[0]


def mean_stiffness(
    stiffness: Values, mean: Values, deviation: Values, half_backlash: Values
) -> np.ndarray:
    """E[df/dd], N/m: the equivalent stiffness of the force-based linearisation (eq. 3.39)."""
    return mean_force_and_stiffness(stiffness, mean, deviation, half_backlash)[1]


def mean_force_and_stiffness(
    stiffness: Values, mean: Values, deviation: Values, half_backlash: Values
) -> tuple[np.ndarray, np.ndarray]:
    """E[f] and E[df/dd], which is also the derivative of E[f] with respect to the mean."""
    share, first, _ = _beyond(mean, deviation, half_backlash)
    return stiffness * (first[0] - first[1]), stiffness * (share[0] + share[1])


def mean_energy(
    stiffness: Values, mean: Values, deviation: Values, half_backlash: Values
) -> np.ndarray:
    """E[P], J."""
    return 0.5 * stiffness * _beyond(mean, deviation, half_backlash)[2].sum(axis=0)


def energy_stiffness(
    stiffness: Values, mean: Values, deviation: Values, half_backlash: Values
) -> np.ndarray:
    """The equivalent stiffness of the energy-based linearisation, N/m.

    The mean square of P(d) - P(m) - k_e (d - m)² / 2 - f_0 (d - m) has its minimum at

        k_e = 2/3 (E[df/dd] + (E[P] - P(m)) / s²),    f_0 = E[f].

    The energy counts from that of the mean deflection m. In print (eqs 4.31, 4.43) it counts from
    zero. Then k_e is wrong even for a mesh that never leaves contact: k (1 + (m - b)² / (3 s²))
    instead of k. With a free constant in the energy the minimum is at E[df/dd], the force-based
    stiffness.
    """
    s2 = np.asarray(deviation, dtype=float) ** 2
    slope = mean_stiffness(stiffness, mean, deviation, half_backlash)
    # for smaller deviations the difference of energies is round-off; its limit is half the slope
    resolved = s2 > 1e-10 * (np.abs(mean) + half_backlash) ** 2
    rise = mean_energy(stiffness, mean, deviation, half_backlash)
    rise = rise - energy(stiffness, mean, half_backlash)
    return np.where(resolved, 2.0 / 3.0 * (slope + rise / np.where(resolved, s2, 1.0)), slope)
