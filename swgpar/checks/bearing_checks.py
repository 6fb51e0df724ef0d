"""Checks of the bearing's sizes. Each refusal names the key, its value and what is allowed."""

from __future__ import annotations

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.geometry.bearing import depth_of_hollows, smallest_curvature_radius
from swgpar.geometry.cams import FourRoller, TwoRoller
from swgpar.input.require import require, require_available

SECTION = "wave_generator.bearing"
RADIUS = "the cam's smallest radius of curvature"

DEEPEST_HOLLOW = 0.01
"""Depth of a hollow of the cam that its inner race may span, over half of the deflection: balls are
off their places by that much there."""

LOWER = 0.1
"""Share of half the deflection by which balls beside a lobe may lie lower than its tip without a
remark."""


THINNEST_RACE = 0.01
"""Thickness of the outer race, in modules: thinner ones are slips, as rims are."""


def check_bearing(design: DriveDesign) -> None:
    """Raise InputError for the first size of the bearing that does not fit the others."""
    bearing, sizes = design.bearing, design.bearing_sizes
    require_available(
        not isinstance(design.wave_generator, FourRoller | TwoRoller),
        SECTION,
        f'wave_generator.type = "{design.wave_generator.type}"',
        "with cams whose curve an inner race can follow",
    )
    depth, ball = bearing.race_thickness, bearing.ball_diameter
    radius, half = smallest_curvature_radius(design.cam()), 0.5 * design.deflection
    least = THINNEST_RACE * design.drive.module
    allowed = f"{least:.4g} mm ({THINNEST_RACE:g} modules) to below {radius:.4g} mm ({RADIUS})"
    require(least <= depth < radius, f"{SECTION}.race_thickness", depth, allowed)
    allowed = f"above 0 to below {radius - depth:.4g} mm ({RADIUS} less race_thickness)"
    require(ball < radius - depth, f"{SECTION}.ball_diameter", ball, allowed)
    hollow, deepest = depth_of_hollows(design.cam(), depth + ball), DEEPEST_HOLLOW * half
    if hollow > deepest:
        raise InputError(
            f"[{SECTION}] is not available with a cam that is hollow by {hollow:.3g} mm at the "
            "inner race, which is pressed on it and spans hollows: allowed up to "
            f"{deepest:.3g} mm (a hundredth of half the deflection)"
        )
    most = int(np.pi / np.arcsin(ball / sizes.pitch_diameter))
    allowed = f"3 to {most} (balls of ball_diameter beside each other)"
    require(bearing.balls <= most, f"{SECTION}.balls", bearing.balls, allowed)
    width, face_width = design.race_width, design.drive.face_width
    allowed = f"above 0 to {face_width:g} mm (drive.face_width)"
    require(width <= face_width, f"{SECTION}.race_width", width, allowed)
    allowed = f"above {-half:g} to below {half:g} mm (half the deflection)"
    require(abs(bearing.clearance) < half, f"{SECTION}.clearance", bearing.clearance, allowed)
    _check_taper(design)


def _check_taper(design: DriveDesign) -> None:
    """A taper of the race's outside, and no slope of the cam."""
    slope, taper = design.micro_geometry.wg_slope, f"{SECTION}.race_taper"
    allowed = (
        f"only 0 with {SECTION}: the slope goes round with the cam and the outer race does not, "
        f"and balls do not lean with their grooves; {taper} is the taper of the race"
    )
    require(slope == 0.0, "micro_geometry.wg_slope", slope, allowed)
    most = min(0.5 * design.deflection, 0.25 * design.race_width) if design.has_cup else 0.0
    allowed = (
        f"{-most:g} to {most:g} mm (half the deflection, a quarter of the race's width)"
        if design.has_cup
        else f'only 0 with drive.model = "{design.drive.model}", which has no open end'
    )
    require(abs(design.bearing.race_taper) <= most, taper, design.bearing.race_taper, allowed)


def bearing_remarks(design: DriveDesign) -> list[str]:
    """Balls so few that a lobe is between two of them at times."""
    if design.bearing is None:
        return []
    spacing = 2.0 * np.pi / design.bearing.balls
    centres, *_ = design.grown_ball_lines()(np.array([0.0, 0.5 * spacing, -0.5 * spacing]))
    tip, *beside = np.hypot(*centres.T)
    lower = (tip - max(beside)) / (0.5 * design.deflection)
    if lower <= LOWER:
        return []
    balls, lobes = design.bearing.balls, design.wave_generator.lobes
    return [
        f"{SECTION}.balls = {balls} are few for {lobes} lobes: where a lobe is midway between two "
        f"of them, they lie {100.0 * lower:.0f} % of half the deflection lower than its tip, and "
        "the flexible spline is deflected less"
    ]
