"""What windows make of nodal averages, by region: the factors on the stresses of a cycle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from swgpar.largest_stress.places import OF_REGION, Place
from swgpar.largest_stress.resolved_places import windowed_places
from swgpar.largest_stress.root_stress import RootStress
from swgpar.largest_stress.wall_stress import WallStress
from swgpar.model.regions import FLANK, TIP, TOOTH_END, TOOTH_ROOT

IN_CONTACT = (FLANK, TIP)
"""Regions that flanks press on: their largest tension says nothing of what is below a contact."""

TENSION, MISES = f"fs_s1{OF_REGION}", f"fs_vm{OF_REGION}"
"""Beginnings of the names of the largest tensions and von Mises stresses of the flexible spline's
regions."""


@dataclass(frozen=True)
class StressFactor:
    """Largest tension by windows over that by nodal averages, in the loaded state.

    error : None where it is not known
    mises : the same of the largest von Mises stress; None where windows do not resolve it
    """

    factor: float
    error: float | None
    mises: float | None = None


def root_factor(root_stress: RootStress) -> StressFactor:
    """Factor of the teeth."""
    error = root_stress.total_error
    return StressFactor(
        root_stress.s1 / root_stress.on_mesh,
        None if error is None else error / root_stress.on_mesh,
    )


def stress_factors(
    root_stress: RootStress | None, wall: WallStress | None, loaded: Mapping[str, float]
) -> dict[str, StressFactor]:
    """Factors by region; none of regions that windows do not resolve, and of flanks and tips.

    All but those of the roots are at least 1: nodal averages are larger where a region has its
    largest stress beside the part that is resolved.

    loaded : MPa, nodal averages of the loaded state by the names of `find_places`
    """
    found: dict[str, StressFactor] = {}
    places = windowed_places(root_stress, wall)
    for name, place in places.items():
        nodal = loaded.get(name)
        if name.startswith(TENSION) and nodal and place.region not in IN_CONTACT:
            error = None if place.error is None else place.error / nodal
            found[place.region] = StressFactor(max(place.value / nodal, 1.0), error)
    if root_stress is not None:
        ends = [TOOTH_END] if root_stress.region == TOOTH_END else []
        found |= dict.fromkeys([TOOTH_ROOT, *ends], root_factor(root_stress))
    return {
        region: replace(one, mises=_mises(region, places, loaded)) for region, one in found.items()
    }


def _mises(region: str, places: Mapping[str, Place], loaded: Mapping[str, float]) -> float | None:
    """Factor of the largest von Mises stress of a region; None where it is not known."""
    name = f"{MISES}{region}"
    if name not in places or not loaded.get(name):
        return None
    factor = places[name].value / loaded[name]
    return factor if region == TOOTH_ROOT else max(factor, 1.0)
