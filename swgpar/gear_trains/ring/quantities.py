"""Quantities of an elastic ring: results that can be compared with published values, derived values
of the design."""

from __future__ import annotations

from itertools import product

import numpy as np

from swgpar.gear_trains.published import STATISTICS, number_label
from swgpar.gear_trains.ring.design import RingDesign
from swgpar.gear_trains.ring.natural_frequencies import distinct_frequencies
from swgpar.results.quantity import Quantity
from swgpar.vibration.curved_beam import free_frequencies

POINTS = {
    "moving_point": "ring point under the first load",
    "middle_node": "node midway between two supports",
}
"""Points whose outward displacement is computed: name -> meaning."""


def quantities(design: RingDesign) -> dict[str, Quantity]:
    """Results that can be compared with published values."""
    known = {
        "frequencies": Quantity(
            "natural frequencies of in-plane bending, equal ones once",
            "Hz",
            count=design.ring.modes,
            remark=design.remark_on_modes,
        ),
        "dimensionless_frequencies": Quantity(
            "the same times 2 pi sqrt(density A R⁴ / (E I))", count=design.ring.modes
        ),
    }
    load = design.moving_load
    if load is not None:
        for point, meaning in POINTS.items():
            for speed, (kind, statistic) in product(load.speeds, STATISTICS.items()):
                known[f"{kind}_{point}_{number_label(speed)}"] = Quantity(
                    f"largest {statistic} of the outward displacement of the {meaning} at "
                    f"{speed:g} rad/s",
                    "m",
                    remark=design.remark_on_loads,
                )
            known[f"dominant_cycles_{point}"] = Quantity(
                f"largest slow harmonic, in cycles per revolution, of the {meaning} at the first "
                f"speed"
            )
        known["critical_speeds"] = Quantity(
            "speeds of the five highest peaks of the mean of the middle node, ascending",
            "rad/s",
            count=5,
        )
    return known


def derived(design: RingDesign) -> dict[str, float]:
    """Values derived from the design file, for `swgpar check`."""
    section = design.beam_section()
    out = {
        "radius of the centre line (mm)": 1e3 * section.radius,
        "mass (kg)": 2.0 * np.pi * section.radius * section.density * section.area,
        "bending stiffness (N·m²)": section.E * section.inertia,
        "I / (A R²)": section.slenderness,
    }
    for n in range(2, 5):
        out[f"free ring, {n} waves (Hz)"] = free_frequencies(section, n)[0] / (2.0 * np.pi)
    for k, f in enumerate(distinct_frequencies(design, min(3, design.ring.modes))[0], start=1):
        out[f"natural frequency {k} (Hz)"] = f
    return {name: float(value) for name, value in out.items()}
