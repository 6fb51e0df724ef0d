"""Checks of the bearing's sizes. Each refusal names the key, its value and what is allowed."""

from __future__ import annotations

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.geometry.bearing import smallest_curvature_radius
from swgpar.geometry.cams import FourRoller

SECTION = "wave_generator.bearing"


def check_bearing(design: DriveDesign) -> None:
    """Raise InputError for the first size of the bearing that does not fit the others."""
    bearing, sizes = design.bearing, design.bearing_sizes
    if isinstance(design.wave_generator, FourRoller):
        raise InputError(
            f'{SECTION} is not available with wave_generator.type = "four_roller": allowed with '
            f"cams whose curve an "
            "inner race can follow"
        )
    if design.lobes != 2:
        raise InputError(
            f"{SECTION} is not available with wave_generator.lobes = {design.lobes}: allowed with "
            f"two"
        )
    output = design.output
    if output.root_stress and "root_stress" in output.model_fields_set:
        raise InputError(
            f"output.root_stress = true is out of range: allowed only false with {SECTION}"
        )
    room = smallest_curvature_radius(design.cam()) - bearing.race_thickness
    if room <= 0.0:
        allowed = (
            f"above 0 to below {room + bearing.race_thickness:.4g} mm (the cam's smallest radius "
            f"of curvature)"
        )
        _refuse("race_thickness", bearing.race_thickness, allowed)
    if bearing.ball_diameter >= room:
        allowed = (
            f"above 0 to below {room:.4g} mm (the cam's smallest radius of curvature less "
            f"race_thickness)"
        )
        _refuse("ball_diameter", bearing.ball_diameter, allowed)
    most = int(np.pi / np.arcsin(bearing.ball_diameter / sizes.pitch_diameter))
    if bearing.balls > most:
        _refuse("balls", bearing.balls, f"3 to {most} (balls of ball_diameter beside each other)")
    if design.race_width > design.drive.face_width:
        _refuse(
            "race_width",
            design.race_width,
            f"above 0 to {design.drive.face_width:g} mm (drive.face_width)",
        )
    if bearing.clearance >= 0.5 * design.deflection:
        allowed = f"0 to below {0.5 * design.deflection:g} mm (half the deflection)"
        _refuse("clearance", bearing.clearance, allowed)
    if design.micro_geometry.wg_slope != 0.0:
        slope = design.micro_geometry.wg_slope
        raise InputError(
            f"micro_geometry.wg_slope = {slope:g} is out of range: allowed only 0 with {SECTION}"
        )


def _refuse(key: str, value: float, allowed: str) -> None:
    raise InputError(f"{SECTION}.{key} = {value:g} is out of range: allowed {allowed}")
