"""Checks of sizes that have to fit each other. Each refusal names the key, its value and what is
allowed."""

from __future__ import annotations

import numpy as np

from swgpar.checks.bearing_checks import check_bearing
from swgpar.checks.cam_checks import check_cam, check_outline
from swgpar.checks.cup_checks import check_cup
from swgpar.checks.deviation_checks import check_deviations
from swgpar.checks.fatigue_checks import check_fatigue
from swgpar.checks.frequency_checks import check_frequencies
from swgpar.checks.growth_checks import check_growth
from swgpar.checks.inertia import check_inertia
from swgpar.checks.input_coupling_checks import check_input_coupling
from swgpar.checks.output_bearing_checks import check_output_bearing
from swgpar.checks.program_checks import check_program
from swgpar.checks.strain_checks import check_strains
from swgpar.checks.tooth_checks import check_teeth
from swgpar.design.drive_design import OMITTED_BENDING, DriveDesign
from swgpar.design.linear_solvers import LINEAR_SOLVERS
from swgpar.design.sections import FLANK_CROWNINGS, GEARS
from swgpar.errors import InputError
from swgpar.input.quantities import show
from swgpar.input.require import require, require_available
from swgpar.profiles import Conjugate

THINNEST_RIM, THICKEST_RIM = 0.01, 100.0
"""Thickness of a rim, or of a housing, in modules: thinner and thicker ones are slips."""

PANCAKE = 'drive.model = "pancake"'


def check_fit(design: DriveDesign) -> None:
    """Raise InputError for the first size that does not fit the others."""
    _check_conjugate(design)
    _check_pancake(design)
    _check_tooth_numbers(design)
    _check_rims(design)
    if design.has_cup and design.cup is None:
        raise InputError('cup is missing: allowed only with drive.model = "plane"')
    _check_steps(design)
    if design.fatigue is not None:
        check_fatigue(design, design.fatigue)
    _check_linear_solver(design)
    if design.drive.model == "plane":
        _check_plane(design)
    check_program(design)
    check_cam(design)
    check_teeth(design)
    if design.has_cup:
        check_cup(design)
    check_outline(design)
    check_strains(design)
    if design.deviations is not None:
        check_deviations(design, design.deviations)
    if design.bearing is not None:
        check_bearing(design)
    check_growth(design)
    if design.input_coupling is not None:
        check_input_coupling(design, design.input_coupling)
    if design.output_bearing is not None:
        check_output_bearing(design, design.output_bearing)
    if design.frequencies is not None:
        check_frequencies(design)
    if design.load.inertia:
        check_inertia(design)


def _check_conjugate(design: DriveDesign) -> None:
    """A conjugate profile needs another gear of its own profile, and a cam with two axes of
    symmetry."""
    conjugate = [
        gear for gear in design.gears if isinstance(getattr(design, gear).profile, Conjugate)
    ]
    for gear in conjugate:
        name, profile = f"{gear}.profile", getattr(design, gear).profile
        if set(GEARS) <= set(conjugate):
            raise InputError(
                f'{name}.type = "conjugate" is available for one of flexible_spline and ring_gear '
                "only: allowed another type for one"
            )
        require_available(
            design.wave_generator.is_mirror_symmetric,
            f'{name}.type = "conjugate"',
            f'wave_generator.type = "{design.wave_generator.type}" whose sides differ',
            "are cams with two axes of symmetry, because both flanks of a tooth are mirror images",
        )
        half = 0.5 * design.drive.face_width if design.has_cup else 0.0
        allowed = f"-{half:g} to {half:g} mm"
        require(abs(profile.section) <= half, f"{name}.section", profile.section, allowed)


def _check_pancake(design: DriveDesign) -> None:
    """A pancake drive has a second ring gear, and not what only other drives have."""
    second, drive = design.dynamic_spline, design.drive
    if drive.model != "pancake":
        if second is not None:
            raise InputError(
                f'dynamic_spline is given: allowed only with {PANCAKE}, not "{drive.model}"'
            )
        return
    if second is None:
        raise InputError(f"dynamic_spline is missing: {PANCAKE} needs it")
    # both ring gears and the gap share the face width of the flexible spline, all on the cam
    width, cam = drive.face_width, design.wave_generator.face_width
    allowed = f"above 0 to below {width:g} mm (drive.face_width)"
    require(second.gap < width, "dynamic_spline.gap", second.gap, allowed)
    if second.face_width is not None:
        rest = width - second.gap
        allowed = f"above 0 to below {rest:g} mm (drive.face_width less dynamic_spline.gap)"
        require(second.face_width < rest, "dynamic_spline.face_width", second.face_width, allowed)
    allowed = f"only {width:g} mm (drive.face_width) with {PANCAKE}"
    require(cam == width, "wave_generator.face_width", cam, allowed)
    fixed, friction = design.kinematics.wave_generator_is_fixed, design.contact.friction
    for given, what, allowed in (
        (design.cup, "cup", 'only with drive.model = "cup"'),
        (fixed, 'drive.layout = "wave_generator_fixed"', '"ring_fixed" or "spline_fixed"'),
        (
            design.wave_generator.lobes != 2,
            f"wave_generator.lobes = {design.wave_generator.lobes}",
            "2",
        ),
        (design.housing, "ring_gear.housing", "without it"),
        (design.deviations, "deviations", "without them"),
        # the rotation of the output would hold the spline, which turns with it
        (
            any(stage.output_rotation is not None for stage in design.load.program),
            "load.program with output_rotation",
            "torque",
        ),
        (design.ratcheting, "ratcheting", "without it"),
        # the spline, which contacts alone hold, finds no equilibrium in its backlash
        (design.stiffness and friction, "stiffness", f"contact.friction = 0, not {friction:g}"),
        (design.solver.condensed_sectors, "solver.condensed_sectors = true", "false"),
        (
            second.profile.type == "s_shaped",
            'dynamic_spline.profile.type = "s_shaped"',
            "the other profiles: its teeth stay in their slots",
        ),
    ):
        require_available(not given, what, PANCAKE, allowed)


def _check_linear_solver(design: DriveDesign) -> None:
    """Friction makes the tangent unsymmetric."""
    linear, friction = design.solver.linear, design.contact.friction
    general = [name for name, entry in LINEAR_SOLVERS.items() if not entry.symmetric_only]
    require_available(
        friction == 0.0 or linear in general,
        f'solver.linear = "{linear}"',
        f"contact.friction = {friction:g}",
        f"{' or '.join(map(show, general))} with friction",
    )


def _check_tooth_numbers(design: DriveDesign) -> None:
    drive, lobes = design.drive, design.wave_generator.lobes
    difference = drive.teeth_rg - drive.teeth_fs
    multiple = "two" if lobes == 2 else f"wave_generator.lobes = {lobes}"
    require(
        difference > 0 and difference % lobes == 0,
        "drive.teeth_rg - drive.teeth_fs",
        difference,
        f"a positive multiple of {multiple}",
    )


def _check_rims(design: DriveDesign) -> None:
    """Thicknesses of rims and of a housing that no drive has."""
    walls = {f"{gear}.rim": getattr(design, gear).rim for gear in design.gears}
    if design.housing is not None:
        walls["ring_gear.housing.thickness"] = design.housing.thickness
    module = design.drive.module
    least, most = THINNEST_RIM * module, THICKEST_RIM * module
    allowed = f"{least:g} to {most:g} mm ({THINNEST_RIM:g} to {THICKEST_RIM:g} modules)"
    for key, thickness in walls.items():
        require(least <= thickness <= most, key, thickness, allowed)


def _check_steps(design: DriveDesign) -> None:
    steps, least = design.steps, np.degrees(design.kinematics.period_angle) * design.periods
    covers = not steps.samples or steps.rotation >= 0.999999 * least
    allowed = f"{least:.6g} deg (periods: {design.periods}) and more with steps.samples"
    require(covers, "steps.rotation", steps.rotation, allowed)


def _check_plane(design: DriveDesign) -> None:
    if design.solver.condensed_sectors and not design.can_condense:
        raise InputError(
            f"solver.condensed_sectors = true leaves out {design.omitted_bending:.2g} of the "
            f"bending strain: allowed "
            f"up to {OMITTED_BENDING:g}, with more teeth or a thicker flexible_spline.rim"
        )
    for key in ("wg_crowning", "wg_slope", *FLANK_CROWNINGS.values()):
        value = getattr(design.micro_geometry, key)
        require(value == 0.0, f"micro_geometry.{key}", value, 'only 0 with drive.model = "plane"')
