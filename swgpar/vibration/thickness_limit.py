"""Where beam theory of a ring ends: errors found on solid rings in the plane.

tests/verification/test_solid_ring.py compares curved beams with shear with plane finite elements,
for thicknesses up to the radius of the centre line and up to half a wavelength. Natural frequencies
of bending are within 2 %, displacements under loads spread over the section within 6 %. Loads on
the bore press the rim as well, which no beam has: displacements there are too small by about twice
the square of thickness over wavelength.
"""

from __future__ import annotations

import math

THICKEST = 1.0
"""Largest thickness over the radius of the centre line that was compared."""

SHORTEST = 0.5
"""Largest thickness over the wavelength that was compared."""

NEGLIGIBLE = 0.02
"""Error of displacements that is not worth a remark."""


def error_at_bore(share: float) -> float:
    """How much too small the displacement under loads on the bore is. share : thickness over
    wavelength"""
    return 2.0 * share**2 + 0.005


def displacement_remark(thickness: float, radius: float, supports: int) -> str:
    """A sentence on displacements under loads between equally spaced supports, or none; lengths in
    one unit."""
    waves = max(2, supports)
    share = waves * thickness / (2.0 * math.pi * radius)
    if error_at_bore(share) <= NEGLIGIBLE:
        return ""
    where = f"the rim is {share:.2g} of a wavelength thick ({waves} waves around)"
    limit = "" if share <= SHORTEST else f"beam theory ends at {SHORTEST:g}, where "
    percent = 100.0 * error_at_bore(min(share, SHORTEST))
    return (
        f"{where}: {limit}displacements of the ring under loads are up to {percent:.2g} % too small"
    )


def size_remark(largest: float, radius: float) -> str:
    """A sentence on the largest displacement of a ring, or none; lengths in m.

    The rotation of the sections is displacement over radius, and what is linear in it is off by as
    much.
    """
    share = largest / radius
    if share <= NEGLIGIBLE:
        return ""
    return (
        f"the ring is displaced by up to {largest:.2g} m, {100.0 * share:.2g} % of its radius: the "
        "linear theory is off by about as much"
    )


def frequency_remark(thickness: float, radius: float, modes: int) -> str:
    """A sentence on the first bending modes of a ring, or none; lengths in one unit."""
    waves = int(SHORTEST * 2.0 * math.pi * radius / thickness)
    if modes + 1 <= waves:
        return ""
    return (
        f"beam theory ends at {waves} waves: shorter ones are less than twice the thickness of "
        f"the rim"
    )
