"""What a run of a planetary stage gives by name, and values derived from its design."""

from __future__ import annotations

import numpy as np

from swgpar.gear_trains.planetary_parts.model import PlanetaryModel, base_radii
from swgpar.gear_trains.planetary_parts.natural_modes import natural_modes
from swgpar.gear_trains.planetary_stage.design import PlanetaryStageDesign
from swgpar.results.quantity import Quantity

LISTED = 12
"""Natural frequencies that are answers; a stage has 21 at least."""

QUANTILES = {"median": 0.5, "90": 0.9, "99": 0.99}
"""Of the random load sharing factors: part of the name -> level."""


def quantities(design: PlanetaryStageDesign) -> dict[str, Quantity]:
    """Results that can be compared with published values."""
    planets, place = design.planet.count, "at any place of the carrier"
    known = {
        "load_sharing_factor": Quantity(
            f"largest load of a planet over the mean of all, {place} (K_gamma)"
        ),
        "mean_load_sharing_factor": Quantity(
            "largest of the planets' mean loads in a revolution over the mean of all"
        ),
        "mean_share": Quantity("mean part of each planet of the load", count=planets),
        "largest_share": Quantity(f"largest part of each planet, {place}", count=planets),
        "largest_sun_force": Quantity(
            f"largest force of sun and each planet, {place}", "N", count=planets
        ),
        "largest_ring_force": Quantity(
            f"largest force of ring and each planet, {place}", "N", count=planets
        ),
        "largest_bearing_force": Quantity(
            f"largest force of the bearing of each planet, {place}", "N", count=planets
        ),
        "axial_force": Quantity("largest axial force of a mesh of sun and planet", "N"),
        "tilting_moment": Quantity(
            "largest moment of the axial forces on a planet, which its bearing carries", "N·m"
        ),
        "sun_orbit": Quantity(f"largest displacement of the sun from the middle, {place}", "m"),
        "transmission_error": Quantity(
            "static transmission error, peak to peak, at the radius of the planet centres", "m"
        ),
        "out_of_contact": Quantity("part of places and meshes without contact on the loaded flank"),
        "natural_frequencies": Quantity(
            "lowest natural frequencies with all meshes in contact", "Hz", count=LISTED
        ),
    }
    if design.tolerances is not None:
        for name, level in QUANTILES.items():
            known[f"random_factor_{name}"] = Quantity(
                f"load sharing factor that {100.0 * level:g} % of trains with random errors keep"
            )
        known["random_factor_largest"] = Quantity("largest of these load sharing factors")
    return known


def derived(design: PlanetaryStageDesign) -> dict[str, float]:
    """Values derived from the design file, for `swgpar check`."""
    train, (sun, planets, centres) = PlanetaryModel(design), base_radii(design)
    frequencies = natural_modes(train).frequency
    mean = design.load.torque / (centres * design.planet.count)
    ratio = 1.0 + design.ring.teeth / design.sun.teeth
    return {
        "speed of the sun over that of the carrier": ratio,
        "torque of the sun (N·m)": design.load.torque / ratio,
        "power (kW)": 1e-3 * design.load.torque * design.carrier.speed,
        "teeth of a planet": design.planet_teeth,
        "base radius of the sun (mm)": 1e3 * sun,
        "base radius of the planets (mm)": 1e3 * planets,
        "radius of the planet centres (mm)": 1e3 * centres,
        "load of a planet, equally shared (N)": mean,
        "mesh frequency (Hz)": train.mesh.frequency / (2.0 * np.pi),
        "lowest natural frequency above 1 Hz, all meshes in contact (Hz)": float(
            frequencies[frequencies > 1.0][0]
        ),
    }
