"""The largest stresses of the flexible spline by windows where these resolve them, by nodal
averages elsewhere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.largest_stress.place_errors import MOST_LOST
from swgpar.largest_stress.places import APART, OF_REGION, Place
from swgpar.largest_stress.root_stress import RootStress
from swgpar.largest_stress.wall_stress import WallStress
from swgpar.model.regions import UNDER_CONTACT, WALL

STRESSES = "fs_s1", "fs_s3", "fs_vm"
"""Stresses that windows resolve."""


def with_windows(
    places: Mapping[str, Place],
    loaded: Mapping[str, float],
    root_stress: RootStress | None,
    wall: WallStress | None,
) -> dict[str, Place]:
    """The places with the values and errors of windows.

    Windows resolve the loaded state. Where nodal averages are larger at another angle, so are the
    stresses in proportion. The largest stress of the body is that of the largest region. Nodal
    averages of the wall have no error: the meshes of a drive may have one or two elements in its
    fillet, so that none of them shows its stress.

    places : by names of `find_places`, with their errors;  loaded : MPa, nodal averages of the
    loaded state by these names
    """
    found = {
        name: replace(place, error=None) if place.region in WALL else place
        for name, place in places.items()
    }
    resolved = dict(wall.places) if wall is not None else {}
    if root_stress is not None:
        resolved |= _of_root(root_stress)
    for name, place in resolved.items():
        found[name] = _risen(place, places.get(name), loaded.get(name))
    for stress in STRESSES:
        if not any(name.startswith(stress + OF_REGION) for name in resolved):
            continue
        regions = [place for name, place in found.items() if name.startswith(stress + OF_REGION)]
        names = (stress, stress + APART) if stress + APART in places else (stress,)
        for name in names:
            if name.endswith(APART):
                regions = [place for place in regions if place.region != UNDER_CONTACT]
            found[name] = replace(_largest(regions), on_mesh=places[name].value)
    return found


def _of_root(root_stress: RootStress) -> dict[str, Place]:
    """Largest tension at the teeth as a place, by its name."""
    return {
        f"fs_s1{OF_REGION}{root_stress.region}": Place(
            value=root_stress.s1,
            body=FLEXIBLE_SPLINE,
            region=root_stress.region,
            tooth=root_stress.tooth,
            radius=root_stress.radius,
            z=root_stress.z,
            angle_deg=root_stress.angle_deg,
            warning=root_stress.warning,
            error=root_stress.total_error,
        )
    }


def _risen(place: Place, nodal: Place | None, loaded: float | None) -> Place:
    """A place of the loaded state with what nodal averages rise by at other angles.

    nodal : the largest average under load;  loaded : MPa, that of the loaded state
    """
    if nodal is None or not loaded:
        return place
    rise = max(nodal.value / loaded, 1.0)
    error = None if place.error is None else rise * place.error
    return replace(place, value=rise * place.value, error=error, on_mesh=nodal.value)


def _largest(regions: list[Place]) -> Place:
    """The largest of several regions. Its error reaches as far as the largest one may."""
    largest = max(regions, key=lambda place: place.value)
    error = largest.error
    for other in regions:
        if other.warning or other is largest:
            continue
        reach = MOST_LOST * other.value if other.error is None else other.error
        beyond = other.value + reach - largest.value
        if beyond > 0.0 and error is not None:
            error = None if other.error is None else max(error, beyond)
    return replace(largest, error=error)
