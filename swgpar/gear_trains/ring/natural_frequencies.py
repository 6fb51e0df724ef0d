"""Natural frequencies of bending of an elastic ring, equal ones counted once."""

from __future__ import annotations

import numpy as np

from swgpar.gear_trains.ring.design import RingDesign
from swgpar.vibration.curved_beam import free_frequencies

RIGID = 1e-3
"""Modes below this share of the first bending frequency of the free ring are rigid motions."""

EQUAL = 1e-6
"""Relative difference below which two frequencies are equal."""

BENDING_SHARE = 0.5
"""Modes with a larger share of bending in their strain energy are bending modes."""


def distinct_frequencies(design: RingDesign, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Lowest bending frequencies (count,) in Hz, equal ones once, and a mode of each (unknowns,
    count)."""
    ring = design.elastic_ring()
    rate, shapes = ring.modes()
    bent = (rate > RIGID * free_frequencies(ring.section, 2)[0]) & (
        ring.bending_share(shapes) > BENDING_SHARE
    )
    number = np.flatnonzero(bent)
    kept = number[np.diff(rate[number], prepend=0.0) > EQUAL * rate[number]][:count]
    return rate[kept] / (2.0 * np.pi), shapes[:, kept]
