"""The largest stresses of the gears by windows where these resolve them, by nodal averages
elsewhere."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.largest_stress.places import APART, BODIES, OF_REGION, OFF_CORNERS, ROLLER, Place
from swgpar.largest_stress.places import STRESSES as OF_BODY
from swgpar.largest_stress.root_stress import RootStress
from swgpar.largest_stress.wall_stress import WallStress
from swgpar.model.regions import CUP_WALL, INSIDE, UNDER_CONTACT

STRESSES = tuple(f"{body}_{stress}" for body in BODIES for stress in OF_BODY)
"""Stresses that windows resolve."""

MOST_LOST = 1.0
"""Share of a stress that it may lack where nothing says how much it does. A stress that such a one
may overtake has no estimate."""


def with_windows(
    places: Mapping[str, Place],
    loaded: Mapping[str, float],
    root_stress: RootStress | None,
    wall: WallStress | None,
) -> dict[str, Place]:
    """The places with the values and errors of windows.

    Windows resolve the loaded state. Where nodal averages are larger at another angle, so are the
    stresses in proportion. The largest stress of a body is that of its largest region. Nodal
    averages have no error: a mesh with one or two elements in a fillet does not show its stress.

    places : by names of `find_places`;  loaded : MPa, nodal averages of the loaded state by these
    names
    """
    found, resolved = dict(places), windowed_places(root_stress, wall)
    if root_stress is not None and (corner := root_stress.at_corner) is not None:
        resolved[f"fs_s1{OF_REGION}{corner.region}"] = corner
    for name, place in resolved.items():
        nodal, risen = places.get(name), _risen(place, places.get(name), loaded.get(name))
        beyond = nodal is not None and nodal.value > risen.value
        if nodal is not None and nodal.warning and (beyond or nodal.warning == ROLLER):
            continue  # the largest of the region has no limit, or is not resolved
        if place.region == CUP_WALL and (wall is None or name not in wall.places):
            # windows see no more of the wall than what is beside the teeth
            if beyond:
                continue
            risen = replace(risen, error=None)
        found[name] = risen
    for stress in STRESSES:
        if any(name.startswith(stress + OF_REGION) for name in resolved):
            found |= _totals(stress, found, places)
    return found


def windowed_places(root_stress: RootStress | None, wall: WallStress | None) -> dict[str, Place]:
    """Places that windows, rings and slices give, by name. What two of them resolve has the larger
    stress."""
    found = dict(wall.places) if wall is not None else {}
    if root_stress is None:
        return found
    for name, stress in root_stress.regions.items():
        found[name] = _largest([p for p in (stress.resolved, found.get(name)) if p is not None])
    return found | _of_root(root_stress)


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
            warning="",
            error=root_stress.total_error,
        )
    }


def _risen(place: Place, nodal: Place | None, loaded: float | None) -> Place:
    """A place of the loaded state with what nodal averages rise by at other angles.

    Its error rises in proportion. Of the rise it has the share that nodal averages do not show, as
    they do not show all of the stress of the loaded state.

    nodal : the largest average under load;  loaded : MPa, that of the loaded state
    """
    if nodal is None or not loaded:
        return place
    rise = max(nodal.value / loaded, 1.0)
    unseen = (rise - 1.0) * abs(place.value - loaded)
    error = None if place.error is None else rise * place.error + unseen
    return replace(place, value=rise * place.value, error=error, on_mesh=nodal.value)


def _totals(
    stress: str, found: Mapping[str, Place], nodal: Mapping[str, Place]
) -> dict[str, Place]:
    """The largest stress of a body, that apart from the contact of flanks, and that off corners.

    A tension below a contact comes from the elements alone: surfaces are pressed there. What
    compression and von Mises stress have below it is not resolved, so that the largest of all has
    no estimate where flanks touch.
    """
    regions = [place for name, place in found.items() if name.startswith(stress + OF_REGION)]
    apart = [place for place in regions if place.region not in (UNDER_CONTACT, INSIDE)]
    limited, known = [place for place in apart if not place.warning], {}
    name = stress + OFF_CORNERS
    if limited and name in nodal:
        known[name] = replace(_largest(limited), on_mesh=nodal[name].value)
    if stress.endswith("s1"):
        return known | {stress: replace(_largest(apart), on_mesh=nodal[stress].value)}
    largest = _largest(regions)
    if any(place.region == UNDER_CONTACT for place in regions):
        largest = replace(largest, error=None)
    known[stress] = replace(largest, on_mesh=nodal[stress].value)
    if stress + APART in nodal:
        known[stress + APART] = replace(_largest(apart), on_mesh=nodal[stress + APART].value)
    return known


def _largest(regions: Sequence[Place]) -> Place:
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
