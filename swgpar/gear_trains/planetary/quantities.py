"""What a run of a planetary train gives by name, and values derived from its design."""

from __future__ import annotations

from itertools import product

import numpy as np

from swgpar.gear_trains.planetary.design import PlanetaryDesign
from swgpar.gear_trains.planetary.monitored import MONITORED
from swgpar.gear_trains.planetary.time_stepping import TimeStepper
from swgpar.gear_trains.planetary.wind_load import WindLoad
from swgpar.gear_trains.planetary_parts.model import PlanetaryModel, base_radii
from swgpar.gear_trains.planetary_parts.natural_modes import natural_modes
from swgpar.gear_trains.published import SAMPLING_ERROR, STATISTICS, number_label
from swgpar.results.quantity import Quantity
from swgpar.vibration.backlash import force

LISTED = 12
"""Natural frequencies that are answers; a train has 21 at least."""

OF_RING = ("ring_contact_radial", "ring_node_tangential")
"""Monitored displacements of the ring."""


def quantities(design: PlanetaryDesign) -> dict[str, Quantity]:
    """Results that can be compared with published values."""
    harmonic = "largest slow harmonic, in cycles per carrier revolution, of the"
    known = {
        "sampling_error_percent": SAMPLING_ERROR,
        "least_eigenvalue_over_largest": Quantity(
            "least eigenvalue of the linearised covariance over the largest, worst of the checks",
            detail=True,
        ),
        "asymmetry_of_correlations": Quantity(
            "largest difference of the scaled covariance from its transpose, worst of the checks",
            detail=True,
        ),
        "dominant_cycles_ring_contact": Quantity(
            f"{harmonic} outward ring displacement at planet 1"
        ),
        "dominant_cycles_ring_node": Quantity(f"{harmonic} tangential displacement of a ring node"),
        "natural_frequencies": Quantity(
            "lowest natural frequencies with all meshes in contact", "Hz", count=LISTED
        ),
        "out_of_contact": Quantity(
            "share of steps and samples in which a mesh is not in contact on its loaded flank"
        ),
    }
    for (kind, statistic), (name, meaning) in product(STATISTICS.items(), MONITORED.items()):
        known[f"{kind}_{name}"] = Quantity(
            f"largest {statistic} of the {meaning}",
            "m",
            remark=_remark(design, name, design.ring.rim),
        )
        known[f"error_{kind}_{name}"] = Quantity(
            f"error of the linearised {statistic} of the {meaning} against Monte Carlo", "%"
        )
    for rim, (kind, statistic), (name, meaning) in product(
        design.ring.rims, STATISTICS.items(), MONITORED.items()
    ):
        known[f"{kind}_{name}_{number_label(rim)}"] = Quantity(
            f"largest {statistic} of the {meaning} with a rim of {rim:g} mm",
            "m",
            remark=_remark(design, name, rim),
        )
    return known


def _remark(design: PlanetaryDesign, name: str, rim: float) -> str:
    """What to know about a monitored quantity. rim : mm"""
    return design.remark_on_rim(rim) if name in OF_RING else ""


def derived(design: PlanetaryDesign) -> dict[str, float]:
    """Values derived from the design file, for `swgpar check`."""
    step = design.end / design.time.steps
    train, wind = PlanetaryModel(design), WindLoad.of(design, step)
    start, flanks = TimeStepper(train, step, 1).static_equilibrium(wind.steady)
    deflection_rows, k = (
        train.modal_deflection_rows(np.zeros(1))[0],
        train.mesh_stiffness(np.zeros(1))[0],
    )
    forces = force(k, deflection_rows @ start.q[:, 0], train.half_backlash)
    frequencies = natural_modes(train).frequency
    lowest = float(frequencies[frequencies > 1.0][0])
    sun, planets, centres = base_radii(design)
    return {
        "coordinates": train.size,
        "base radius of the sun (mm)": 1e3 * sun,
        "base radius of the planets (mm)": 1e3 * planets,
        "radius of the planet centres (mm)": 1e3 * centres,
        "radius of the centre line of the ring (mm)": 1e3 * train.ring.section.radius,
        "carrier period (s)": 2.0 * np.pi / design.carrier.speed,
        "mesh frequency (rad/s)": train.mesh.frequency,
        "time step (s)": step,
        "steady torque of the wind (N·m)": wind.steady,
        "flank that carries the load (1 or -1)": float(flanks[0]),
        "largest mesh force at rest (N)": float(np.abs(forces).max()),
        "lowest natural frequency above 1 Hz, all meshes in contact (Hz)": lowest,
        "highest natural frequency (Hz)": float(frequencies[-1]),
    }
