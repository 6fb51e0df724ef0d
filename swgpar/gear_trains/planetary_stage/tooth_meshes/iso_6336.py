"""Mesh stiffness by ISO 6336-1, method B: solid steel gears, basic rack of ISO 53.

The coefficients are those of the standard as public programs print them; the standard itself is not
at hand.
"""

from __future__ import annotations

import numpy as np

COEFFICIENTS = (0.04723, 0.15551, 0.25791, -0.00635, -0.11654, -0.00193, -0.24188, 0.00529, 0.00182)
"""Of the flexibility q' in mm·µm/N: 1, 1/z1, 1/z2, x1, x1/z1, x2, x2/z2, x1², x2²."""

C_M = 0.8
"""Correction of the theoretical stiffness, which solid discs of measured pairs gave."""

STEEL = 206.0
"""Modulus of elasticity, GPa, of the coefficients."""

FULL_LOAD = 100.0
"""In N/mm of face width: below it teeth are softer."""

SECOND_PAIR = 0.75
"""Stiffness that a second pair of teeth adds, over that of a single pair: c_gamma of the standard
is c' (0.75 e + 0.25) with the contact ratio e."""


def single_stiffness(
    teeth: tuple[float, float],
    shifts: tuple[float, float],
    *,
    dedendum: float,
    angle: float,
    helix: float,
    modulus: float,
    load: float,
) -> float:
    """Largest stiffness c' of a pair of teeth, N/(mm·µm).

    teeth : of the pinion and the wheel, infinite for a ring;  shifts : in normal modules
    dedendum : of the basic rack, normal modules;  angle : normal pressure angle, rad
    helix : rad;  modulus : GPa;  load : N/mm of face width
    """
    z1, z2 = (z / np.cos(helix) ** 3 for z in teeth)
    x1, x2 = shifts
    terms = 1.0, 1.0 / z1, 1.0 / z2, x1, x1 / z1, x2, x2 / z2, x1**2, x2**2
    flexibility = float(np.dot(COEFFICIENTS, terms))
    rack = (1.0 + 0.5 * (1.2 - dedendum)) * (1.0 - 0.02 * (20.0 - np.degrees(angle)))
    light = min(load / FULL_LOAD, 1.0) ** 0.25
    return light * C_M * rack * float(np.cos(helix)) / flexibility * modulus / STEEL


def mesh_stiffness(single: float, contact_ratio: float) -> float:
    """c_gamma from c', N/(mm·µm)."""
    return single * (SECOND_PAIR * contact_ratio + 1.0 - SECOND_PAIR)
