"""Checks of a pancake drive: its second ring gear, and what is not available with it."""

from __future__ import annotations

from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError

WITH = 'with drive.model = "pancake"'
"""End of the sentences that refuse."""


def check_pancake(design: DriveDesign) -> None:
    """Raise InputError where a pancake drive lacks its second ring gear, or has what only other
    drives have."""
    second, drive = design.dynamic_spline, design.drive
    if drive.model != "pancake":
        if second is not None:
            raise InputError(f'dynamic_spline is given: allowed only {WITH}, not "{drive.model}"')
        return
    if second is None:
        raise InputError('dynamic_spline is missing: drive.model = "pancake" needs it')
    _check_widths(design)
    for refused, what, allowed in (
        (design.cup is not None, "cup is given", 'allowed only with drive.model = "cup"'),
        (
            design.kinematics.wave_generator_is_fixed,
            'drive.layout = "wave_generator_fixed"',
            'allowed "ring_fixed" or "spline_fixed"',
        ),
        (design.lobes != 2, f"wave_generator.lobes = {design.lobes}", "allowed 2"),
        (design.housing is not None, "ring_gear.housing", "allowed without it"),
        (design.bearing is not None, "wave_generator.bearing", "allowed a cam without a bearing"),
        (design.deviations is not None, "deviations", "allowed without them"),
        (design.has_program, "a load program, stiffness or ratcheting", "allowed load.torque"),
        (
            design.contact.friction > 0.0,
            f"contact.friction = {design.contact.friction:g}",
            "allowed 0",
        ),
        (design.fatigue is not None, "fatigue", "allowed without it"),
        (design.losses is not None, "losses", "allowed without them"),
        (
            design.output.root_stress and "root_stress" in design.output.model_fields_set,
            "output.root_stress = true",
            "allowed false",
        ),
        (design.solver.condensed_sectors, "solver.condensed_sectors = true", "allowed false"),
        (
            second.profile.type == "conjugate",
            'dynamic_spline.profile.type = "conjugate"',
            "allowed the other profiles",
        ),
    ):
        if refused:
            raise InputError(f"{what} is not available {WITH}: {allowed}")


def _check_widths(design: DriveDesign) -> None:
    """Both ring gears and the gap share the face width of the flexible spline, all of which lies on
    the cam."""
    second, width, cam = (
        design.dynamic_spline,
        design.drive.face_width,
        design.wave_generator.face_width,
    )
    if second.gap >= width:
        raise InputError(
            f"dynamic_spline.gap = {second.gap:g} is out of range: allowed above 0 to below "
            f"{width:g} mm "
            "(drive.face_width)"
        )
    if second.face_width is not None and second.face_width >= width - second.gap:
        raise InputError(
            f"dynamic_spline.face_width = {second.face_width:g} is out of range: allowed above 0 "
            f"to below "
            f"{width - second.gap:g} mm (drive.face_width less dynamic_spline.gap)"
        )
    if cam != width:
        raise InputError(
            f"wave_generator.face_width = {cam:g} is out of range: allowed only {width:g} mm "
            f"(drive.face_width) {WITH}"
        )
