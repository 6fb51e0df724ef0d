"""Distances of the contact search of flanks."""

from __future__ import annotations

from swgpar.contact.flank_state import ContactSearch, SearchRange

NEAR = 0.25
REACH = 0.1
TOUCH = 0.01
TIP_MARGIN = 0.1
"""Distances of the contact search over the module: faces that are evaluated, those of a flank one
of which is closer than the second distance; faces with blocks in the tangent's pattern; radial
distance of the tips."""

FOOT_REACH = 0.5
"""Largest gap over the module at which a foot point is looked for."""


def search_distance(module: float, backlash: float, share: float = NEAR) -> float:
    """Distance (mm) within which flanks are followed: under torque all those that the backlash may
    bring together.

    module, backlash : mm;  share : of the module, at least
    """
    return max(share * module, TOUCH * module + backlash)


def foot_reach(module: float, backlash: float) -> float:
    """Largest gap (mm) at which a foot point is looked for. module, backlash : mm"""
    return max(FOOT_REACH * module, search_distance(module, backlash))


def contact_search(
    module: float, backlash: float, outer_radius: float, condensed_teeth: bool
) -> ContactSearch:
    """Distances of the contact search.

    module, backlash : mm;  outer_radius : mm, radius that no tooth is farther out than
    condensed_teeth : whether teeth are one element where nothing touches them
    """
    near = search_distance(module, backlash)
    reach = search_distance(module, backlash, REACH) if condensed_teeth else near
    return ContactSearch(
        tip_margin=TIP_MARGIN * module,
        distances=SearchRange(near=near, reach=reach, touch=TOUCH * module),
        outer_radius=outer_radius,
    )
