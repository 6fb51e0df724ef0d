"""What a run of a planetary stage gives by name, and values derived from its design."""

from __future__ import annotations

from itertools import product
from typing import get_args

import numpy as np

from swgpar.gear_trains.planetary_parts.model import PlanetaryModel, base_radii
from swgpar.gear_trains.planetary_parts.natural_modes import natural_modes
from swgpar.gear_trains.planetary_stage.design import PlanetaryStageDesign
from swgpar.gear_trains.planetary_stage.tooth_meshes.helical import Method, stiffnesses
from swgpar.results.quantity import Quantity

LISTED = 12
"""Natural frequencies that are answers; a stage has 21 at least."""

METHODS = ("ISO 6336-1, method B", "plane finite elements")
"""Of mesh stiffness, as `Method` lists them."""

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
        "back_flank": Quantity("part of places and meshes in contact on the back flank"),
        "natural_frequencies": Quantity(
            "lowest natural frequencies with all meshes in contact", "Hz", count=LISTED
        ),
    }
    if design.teeth is not None:
        for mesh, method in product(("sun", "ring"), get_args(Method)):
            pair, by = f"{mesh} and planet", METHODS[get_args(Method).index(method)]
            known[f"{mesh}_single_{method}"] = Quantity(
                f"largest stiffness of one pair of teeth of {pair} by {by}", "N/m"
            )
            known[f"{mesh}_mean_{method}"] = Quantity(
                f"mean mesh stiffness of {pair} by {by}", "N/m"
            )
        known["sun_contact_ratio"] = Quantity("transverse contact ratio of sun and planet")
        known["ring_contact_ratio"] = Quantity("transverse contact ratio of ring and planet")
        known["mesh_phase"] = Quantity("phase of ring meshes behind sun meshes", "cycles")
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


def of_teeth(design: PlanetaryStageDesign) -> dict[str, float]:
    """Quantities of the meshes that follow from the teeth alone."""
    if design.teeth is None:
        return {}
    teeth, found = design.gear_teeth(design.teeth), {}
    width = 1e3 * design.ring.face_width
    for method in get_args(Method):
        both = stiffnesses(teeth, design.tooth_load, method)
        for mesh, stiffness in zip(("sun", "ring"), both, strict=True):
            found[f"{mesh}_single_{method}"] = width * stiffness.single
            found[f"{mesh}_mean_{method}"] = width * stiffness.mean
    cycle = design.mesh_cycle
    found["sun_contact_ratio"], found["ring_contact_ratio"] = cycle.contact_ratio
    return found | {"mesh_phase": cycle.phase}
