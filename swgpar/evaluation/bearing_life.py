"""Rating life of a ball bearing by ISO 281, from the loads of its balls.

C = b_m f_c Z^(2/3) D^1.8 with the factor f_c of ISO/TR 1281-1. Loads that are not those of one
radial force are taken ball by ball, as in ISO/TS 16281: with the capacities Q_c of the contacts
that follow from C,

    L10 = ((Q_ci / Q_ei)^(-10/3) + (Q_co / Q_eo)^(-10/3))^(-9/10) million turns,

where Q_e is the mean load of power 3 of a race that rotates relative to the load, of power 10/3 of
one that does not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

MATERIAL_FACTOR = 1.3
"""b_m of radial ball bearings (ISO 281, table 1)."""

BALL_FACTOR = 0.41 * 0.95 * 98.0665
"""Constant of f_c for deep groove ball bearings (ISO/TR 1281-1)."""

LARGEST_BALL = 25.4
"""Diameter (mm) above which ISO 281 counts balls with a smaller power."""

STATIONARY, ROTATING = 10.0 / 3.0, 3.0
"""Powers of the mean load of a race that stands still relative to the load, and of one that does
not."""


@dataclass(frozen=True)
class BearingSeries:
    """What the rating of a bearing depends on.

    number : of balls;  diameter, pitch_diameter : mm;  inner, outer : conformities, groove radius
    over ball diameter
    """

    number: int
    diameter: float
    pitch_diameter: float
    inner: float
    outer: float

    def _size(self) -> float:
        return self.diameter / self.pitch_diameter

    def _races(self, constant: float) -> float:
        """Capacity of the inner race's contact over that of the outer one's, with the constant of a
        standard."""
        size = self._size()
        grooves = self.inner * (2.0 * self.outer - 1.0) / (self.outer * (2.0 * self.inner - 1.0))
        return constant * ((1.0 - size) / (1.0 + size)) ** 1.72 * grooves**0.41

    def load_rating(self) -> float:
        """Basic dynamic load rating C, N."""
        size, ratio = self._size(), self._races(1.04)
        factor = BALL_FACTOR * (1.0 + ratio ** (10.0 / 3.0)) ** -0.3
        factor *= size**0.3 * (1.0 - size) ** 1.39 / (1.0 + size) ** (1.0 / 3.0)
        factor *= (2.0 * self.inner / (2.0 * self.inner - 1.0)) ** 0.41
        power = self.diameter**1.8 if self.diameter <= LARGEST_BALL else 3.647 * self.diameter**1.4
        return MATERIAL_FACTOR * factor * self.number ** (2.0 / 3.0) * power

    def contact_capacities(self, load_rating: float) -> tuple[float, float]:
        """Capacities Q_c (N) of the contacts on the inner and on the outer race, by the load rating
        C (N)."""
        ratio = self._races(1.044) ** (10.0 / 3.0)
        inner = load_rating / (0.407 * self.number) * (1.0 + ratio) ** 0.3
        outer = load_rating / (0.389 * self.number) * (1.0 + 1.0 / ratio) ** 0.3
        return inner, outer


def mean_load(loads: np.ndarray, power: float) -> float:
    """Mean of loads (any shape, N) with a power."""
    return float(np.mean(np.asarray(loads, dtype=float) ** power) ** (1.0 / power))


def million_turns(series: BearingSeries, load_rating: float, loads: np.ndarray) -> float:
    """L10 in million relative turns of the races, whose inner one stands still relative to the
    load; inf without load.

    load_rating : C, N;  loads : N, of all balls at all their places, of any shape
    """
    capacities = series.contact_capacities(load_rating)
    means = mean_load(loads, STATIONARY), mean_load(loads, ROTATING)
    damage = sum((mean / capacity) ** (10.0 / 3.0) for mean, capacity in zip(means, capacities))
    return float(damage**-0.9) if damage > 0.0 else np.inf
