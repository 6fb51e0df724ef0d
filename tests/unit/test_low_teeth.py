"""Low teeth on thin rims are meshed, with every profile and recipe."""

from __future__ import annotations

from typing import get_args

import pytest

import swgpar
from swgpar.checks.starter_teeth import Profile
from swgpar.design.drive_design import DriveDesign
from swgpar.meshing.recipe import load_recipe
from swgpar.meshing.tooth_sector import build_sector

GEARS = ("flexible_spline", "ring_gear")


def low(profile: Profile, height: float, rim: float, edge: float) -> DriveDesign:
    """A plane drive of ratio 50. height : of its teeth over that of a start;  rim : modules
    edge : rounding of the tips over that of a start"""
    start = swgpar.new(ratio=50, diameter=60.0, torque=1.0, profile=profile, model="plane")
    values = {"flexible_spline.rim": rim * start.drive.module}
    for key in ("addendum_coef", "dedendum_coef"):
        values[f"drive.{key}"] = height * getattr(start.drive, key)
    for gear in GEARS:
        keys = getattr(start, gear)
        if keys.tip_relief:
            values[f"{gear}.tip_relief_height"] = height * keys.tip_relief_height
        if hasattr(keys.profile, "r_tip"):
            values[f"{gear}.profile.r_tip"] = height * edge * keys.profile.r_tip
            values[f"{gear}.profile.r_root"] = height * keys.profile.r_root
    return start.with_values(values)


@pytest.mark.parametrize("profile", get_args(Profile))
@pytest.mark.parametrize(("height", "edge"), [(0.7, 1.0), (0.6, 0.2)])
def test_low_teeth_on_thin_rims_are_meshed(profile: Profile, height: float, edge: float) -> None:
    """Angles at the corners of all elements are far from those of an element that is inside out."""
    for rim in (0.2, 0.5):
        drive = low(profile, height, rim, edge).geometry
        for recipe in ("coarse", "plane"):
            for gear in GEARS:
                sector = build_sector(drive, load_recipe(recipe), gear)
                assert sector.quality["min_scaled_jacobian"] > 0.08, (rim, recipe, gear)
