"""A planetary stage to start from: ratio, size and torque are given, all else are proportions."""

from __future__ import annotations

import math
from typing import Any

from swgpar.errors import InputError
from swgpar.gear_trains.planetary_stage.design import PlanetaryStageDesign
from swgpar.input.commented_file import section_lines
from swgpar.input.quantities import show
from swgpar.input.require import require

PLANETS = 3
SMALLEST_SUN, LARGEST_SUN = 17, 60
"""Numbers of teeth that are tried: 17 need no profile shift."""

RATIOS = 3.0, 12.0
"""Of sun over carrier; below, planets are small, above, they overlap."""

RATIO_ERROR = 0.02
"""Largest difference of the ratio from the given one, relative."""

K_FACTOR = 4.0
"""F (u + 1) / (u b d) of the sun meshes in N/mm²: hardened and ground gears; an assumption."""

STEEL = {"E": 206.0, "nu": 0.3, "density": 7850.0}

WIDEST = 1.2
"""Face width over the pitch diameter of the sun."""

PITCH_SPEED = 1.0
"""Of the pitch circle of the ring, as if it turned with the carrier, m/s."""


def _teeth(ratio: float) -> tuple[int, int]:
    """Teeth of sun and ring whose ratio is nearest, planets with even places and no overlap."""
    fitting = [
        (abs((1.0 + ring / sun) / ratio - 1.0), sun, ring)
        for sun in range(SMALLEST_SUN, LARGEST_SUN + 1)
        for ring in range(2 * sun, 12 * sun)
        if (ring - sun) % 2 == 0
        and (sun + ring) % PLANETS == 0
        and (ring - sun) // 2 >= 17
        and (ring - sun) / 2 + 2.0 < (sun + ring) / 2 * math.sin(math.pi / PLANETS)
    ]
    error, sun, ring = min(fitting, key=lambda one: (one[0] > 0.25 * RATIO_ERROR, one[1], one[0]))
    if error > 0.25 * RATIO_ERROR:
        error, sun, ring = min(fitting)
    nearest = f"{1.0 + ring / sun:.4g}, the nearest that numbers of teeth have"
    require(error <= RATIO_ERROR, "ratio", ratio, nearest)
    return sun, ring


def _disc(diameter: float, width: float, bore: float = 0.0) -> tuple[float, float]:
    """Mass (kg) and moment of inertia (kg·m²) of a steel disc; mm."""
    outer, inner = 0.5e-3 * diameter, 0.5e-3 * bore
    mass = STEEL["density"] * math.pi * (outer**2 - inner**2) * 1e-3 * width
    return mass, 0.5 * mass * (outer**2 + inner**2)


def starter(
    ratio: float, diameter: float, torque: float, name: str
) -> tuple[PlanetaryStageDesign, str]:
    """A design and its file.

    ratio : of sun over carrier;  diameter : pitch diameter of the ring, mm
    torque : on the carrier, N·m;  name : of the file, for the commands in its head

    Raises InputError for what is out of range.
    """
    low, high = RATIOS
    require(low <= ratio <= high, "ratio", ratio, f"{low:g} to {high:g} (sun over carrier)")
    require(1.0 <= diameter <= 1e5, "diameter", diameter, "1 to 100000 mm")
    require(1e-3 <= torque <= 1e9, "torque", torque, "0.001 to 1e+09 N·m")
    sun, ring = _teeth(ratio)
    module, planet = diameter / ring, (ring - sun) // 2
    sun_diameter, planet_diameter = module * sun, module * planet
    force = 1e3 * torque / (PLANETS * (sun_diameter + planet_diameter))
    width = force * (1.0 + sun / planet) / (K_FACTOR * sun_diameter)
    if width > WIDEST * sun_diameter:
        largest = torque * WIDEST * sun_diameter / width
        allowed = f"up to {largest:.4g} N·m with this diameter (K factor of {K_FACTOR:g} N/mm²)"
        raise InputError(f"torque = {show(torque)} is out of range: allowed {allowed}")
    width = _rounded(max(width, 0.3 * sun_diameter))
    table = _table((sun, planet, ring), module, width, torque)
    design = PlanetaryStageDesign.model_validate(table)
    lines = [
        f"# Planetary stage: ratio {1.0 + ring / sun:.6g} (asked {ratio:g}),",
        f"# torque {torque:g} N·m, pitch diameter of the ring {diameter:g} mm.",
        "# These are given. All other values are assumptions to start from: solid steel gears,",
        f"# a face width for a K factor of {K_FACTOR:g} N/mm² or a third of the sun's diameter, "
        "bearings as stiff as",
        "# three sun meshes, a ring on twelve bolts, tolerances of a 300th of the module.",
        f"#   swgpar check {name}",
        f"#   swgpar run {name} --out results/{name.removesuffix('.toml')}",
    ]
    for section, content in table.items():
        lines += section_lines(section, getattr(design, section), content)
    return design, "\n".join(lines) + "\n"


def _rounded(value: float) -> float:
    """Three digits."""
    return float(f"{value:.3g}")


def _table(
    teeth: tuple[int, int, int], module: float, width: float, torque: float
) -> dict[str, Any]:
    sun, planet, ring = teeth
    sun_diameter, planet_diameter = module * sun, module * planet
    (sun_mass, sun_inertia), (planet_mass, planet_inertia) = (
        _disc(sun_diameter, width),
        _disc(planet_diameter, width, 0.5 * planet_diameter),
    )
    centres = sun_diameter + planet_diameter
    carrier_mass, carrier_inertia = _disc(1.3 * centres, width)
    mesh = 20e6 * width  # N/m: 20 N/(mm µm)
    shaft = 1e-3 * 0.7 * sun_diameter
    twist = 80e9 * math.pi / 32.0 * shaft**4 / (5e-3 * sun_diameter)
    rim = _rounded(3.5 * module)
    tolerance = _rounded(1e3 / 300.0 * module)  # µm
    each = _rounded(mesh)
    return {
        "gear_train": {"model": "planetary_stage", "seed": 1},
        "sun": {
            "teeth": sun,
            "mass": _rounded(sun_mass),
            "inertia": _rounded(sun_inertia),
            "pitch_diameter": sun_diameter,
            "bearing": 0.0,
            "torsional": _rounded(twist),
        },
        "planet": {
            "count": PLANETS,
            "mass": _rounded(planet_mass),
            "inertia": _rounded(planet_inertia),
            "pitch_diameter": planet_diameter,
            "bearing": _rounded(3.0 * mesh),
            "clearance": 0.0,
        },
        "carrier": {
            "mass": _rounded(carrier_mass),
            "inertia": _rounded(carrier_inertia),
            "bearing": _rounded(3.0 * mesh),
            "speed": _rounded(PITCH_SPEED / (0.5e-3 * module * ring)),
        },
        "ring": {
            "teeth": ring,
            **STEEL,
            "root_radius": 0.5 * module * ring + 1.25 * module,
            "rim": rim,
            "face_width": width,
            "elements": 36,
            "supports": 12,
            "radial": each,
            "tangential": each,
            "torsional": _rounded(mesh * (1e-3 * rim) ** 2 / 12.0),
        },
        "mesh": {"pressure_angle": 20.0, "helix": 0.0, "half_backlash": _rounded(10.0 * module)},
        "teeth": {"stiffness": "iso_6336", "addendum": 1.0, "dedendum": 1.25, "sun_shift": 0.0},
        "damping": {"mass": 0.0, "stiffness": 1e-6},
        "load": {"torque": torque, "gravity": 9.81, "positions": 5 * ring},
        "tolerances": {
            "pin": tolerance,
            "sun_eccentricity": tolerance,
            "planet_eccentricity": tolerance,
            "ring_eccentricity": tolerance,
            "pitch": _rounded(0.3 * tolerance),
            "samples": 400,
        },
    }
