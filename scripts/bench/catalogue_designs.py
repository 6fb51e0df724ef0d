"""Designs of catalogue sizes: the starter's drive with other proportions, alike in all sizes."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from swgpar.checks.starter import (
    BACK_FILLET,
    BALL_DIAMETER,
    RACE_THICKNESS,
    Request,
    starter_design,
)
from swgpar.checks.starter_cam import rounded
from swgpar.checks.starter_teeth import (
    ADDENDUM,
    DEDENDUM,
    RIM_OF_HEIGHT,
    ToothSizes,
    ring_section,
    spline_section,
)

TENTH_OF_AN_INCH = 2.54
"""Pitch diameter (mm) over the number of the size."""

FACE_WIDTH = 0.17
"""Over the pitch diameter."""

TIP_RELIEF = 0.025
"""Of both gears, modules, of teeth of full height."""

BENDING = 8e-4
"""Strain of bending of the rims that the heights of the teeth belong to. At ratio 30 the teeth are
lower by 2 %."""


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
    """Content of the design file. torque : N·m, rated, on the output

    Teeth, face width and deflection are those of the runs of the page, and not those that a starter
    has: the cam deflects mid-width by a module.
    """
    diameter = rounded(TENTH_OF_AN_INCH * size)
    request = Request(ratio=ratio, torque=torque, diameter=diameter, profile="s_shaped")
    _, table = starter_design(request)
    for section in ("fatigue", "rating", "steps"):
        table.pop(section, None)
    _set_teeth(table, proportions)
    rim = proportions.rim * diameter
    cup, bearing = table["cup"], table["wave_generator"]["bearing"]
    cup["thickness_coef"] = rounded(proportions.wall)
    cup["back_fillet"], cup["end_thickness"] = (
        rounded(BACK_FILLET * rim),
        rounded(proportions.end * rim),
    )
    cup["clamping_radius"] = rounded(proportions.hub * diameter)
    drive = table["drive"]
    bore = drive["module"] * (drive["teeth_fs"] - 2.0 * drive["dedendum_coef"]) - 2.0 * rim
    bearing["ball_diameter"] = rounded(BALL_DIAMETER * bore)
    bearing["race_thickness"] = rounded(RACE_THICKNESS * bore)
    bearing["clearance"] = rounded(proportions.clearance * diameter)
    table["micro_geometry"]["fs_crowning"] = rounded(proportions.crowning * drive["module"])
    return table


def _set_teeth(table: dict[str, Any], proportions: Proportions) -> None:
    """Teeth, face width and deflection."""
    drive, cam = table["drive"], table["wave_generator"]
    module, teeth = drive["module"], drive["teeth_fs"]
    thick = BENDING * teeth**2 / 6.0
    lower = min(1.0, thick / (RIM_OF_HEIGHT * (ADDENDUM + DEDENDUM)))
    heights = rounded(lower * ADDENDUM, 3), rounded(lower * DEDENDUM, 3)
    sizes = ToothSizes(thick, *heights, lower, lower * TIP_RELIEF)
    drive["addendum_coef"], drive["dedendum_coef"] = sizes.addendum, sizes.dedendum
    drive["face_width"] = cam["face_width"] = rounded(FACE_WIDTH * module * teeth, 3)
    cam.pop("deflection", None)
    rim = rounded(proportions.rim * module * teeth)
    table["flexible_spline"] = spline_section("s_shaped", sizes, module) | {"rim": rim}
    table["ring_gear"] = ring_section("s_shaped", sizes, module, drive["teeth_rg"], 0.0)
    profile = table["ring_gear"]["profile"]
    profile["backlash"] = rounded(proportions.backlash * module)
