"""Designs of catalogue sizes: the starter's drive with other proportions, alike in all sizes."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from swgpar.checks.starter import BACK_FILLET, Request, starter_design
from swgpar.checks.starter_cam import rounded

TENTH_OF_AN_INCH = 2.54
"""Pitch diameter (mm) over the number of the size."""


@dataclass(frozen=True)
class Proportions:
    """What a catalogue does not say, over lengths that it does.

    rim : of the flexible spline, over the pitch diameter
    wall, end : thickness of the wall behind the teeth and of the closed end, over the rim
    hub : radius of the clamped hub, over the pitch diameter
    clearance : of a ball, over the pitch diameter
    backlash, crowning : of the teeth, and of their flanks, modules
    """

    rim: float = 0.012
    wall: float = 0.667
    end: float = 1.15
    hub: float = 0.30
    clearance: float = 0.0
    backlash: float = 0.005
    crowning: float = 0.065


NAMES = tuple(field.name for field in fields(Proportions))


def catalogue_design(
    size: int, ratio: int, torque: float, proportions: Proportions
) -> dict[str, Any]:
    """Content of the design file. torque : N·m, rated, on the output"""
    diameter = rounded(TENTH_OF_AN_INCH * size)
    request = Request(ratio=ratio, torque=torque, diameter=diameter, profile="s_shaped")
    design, table = starter_design(request)
    for section in ("fatigue", "rating", "steps"):
        table.pop(section, None)
    rim = proportions.rim * diameter
    bore = 2.0 * (design.inner_radius + design.flexible_spline.rim - rim)
    grown = 0.5 * bore / design.inner_radius
    table["flexible_spline"]["rim"] = rounded(rim)
    cup, bearing = table["cup"], table["wave_generator"]["bearing"]
    cup["thickness_coef"] = rounded(proportions.wall)
    cup["back_fillet"], cup["end_thickness"] = (
        rounded(BACK_FILLET * rim),
        rounded(proportions.end * rim),
    )
    cup["clamping_radius"] = rounded(proportions.hub * diameter)
    for key in ("ball_diameter", "race_thickness"):
        bearing[key] = rounded(grown * bearing[key])
    bearing["clearance"] = rounded(proportions.clearance * diameter)
    module = table["drive"]["module"]
    table["micro_geometry"]["fs_crowning"] = rounded(proportions.crowning * module)
    profile = table["ring_gear"]["profile"]
    profile["backlash"] = rounded(proportions.backlash * module)
    return table
