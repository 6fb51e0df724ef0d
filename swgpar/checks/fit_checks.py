"""Checks of sizes that have to fit each other. Each refusal names the key, its value and what is
allowed."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from swgpar.checks.bearing_checks import check_bearing
from swgpar.checks.conjugate_checks import check_conjugate
from swgpar.checks.cup_checks import check_cup
from swgpar.checks.deviation_checks import check_deviations
from swgpar.checks.pancake_checks import check_pancake
from swgpar.checks.program_checks import check_program
from swgpar.design.drive_design import DriveDesign
from swgpar.design.linear_solvers import LINEAR_SOLVERS
from swgpar.design.sections import OMITTED_BENDING
from swgpar.errors import InputError
from swgpar.geometry.cams import FourRoller
from swgpar.geometry.cams.keys import Harmonic
from swgpar.input.quantities import show

UNIQUE = 0.25
"""1 less curvature of a concave cam times its distance from the bore, at least: at 0 foot points
are not unique."""

SMALLEST_MINOR_AXIS = 0.4
"""Smallest minor semi-axis of a cam over the inner radius of the flexible spline."""

THINNEST_RIM, THICKEST_RIM = 0.01, 100.0
"""Thickness of a rim, or of a housing, in modules: thinner and thicker ones are slips."""

LARGEST_SHEAR = 0.01
"""Nominal shear strain under the output torque; steel yields at half of it, and far above the teeth
find no contact."""

OUTLINE_POINTS = 2000
"""Points of the cam's outline at which its largest radius is measured."""


def check_fit(design: DriveDesign) -> None:
    """Raise InputError for the first size that does not fit the others."""
    check_conjugate(design)
    check_pancake(design)
    if design.has_cup:
        check_cup(design)
    _check_sizes(design)
    check_program(design)
    if design.deviations is not None:
        check_deviations(design, design.deviations)
    if design.bearing is not None:
        check_bearing(design)


def _check_sizes(design: DriveDesign) -> None:
    """Sizes of wave generator, teeth, steps, torque, fatigue and micro-geometry."""
    _check_wave_generator(design)
    _check_teeth(design)
    _check_steps(design)
    _check_torque(design)
    _check_fatigue(design)
    if design.wave_generator.face_width > design.drive.face_width:
        width = design.drive.face_width
        _refuse(
            "wave_generator.face_width",
            design.wave_generator.face_width,
            f"above 0 to {width:g} mm (drive.face_width)",
        )
    _check_linear_solver(design)
    if design.drive.model == "plane":
        _check_plane(design)
    else:
        _check_micro_geometry(design)
    _check_outline(design)


def _refuse(key: str, value: float, allowed: str) -> None:
    raise InputError(f"{key} = {value:g} is out of range: allowed {allowed}")


def _check_linear_solver(design: DriveDesign) -> None:
    """Friction makes the tangent unsymmetric."""
    linear, friction = design.solver.linear, design.contact.friction
    if friction > 0.0 and LINEAR_SOLVERS[linear].symmetric_only:
        general = [name for name, entry in LINEAR_SOLVERS.items() if not entry.symmetric_only]
        raise InputError(
            f'solver.linear = "{linear}" is not available with contact.friction = {friction:g}: '
            f"allowed {' or '.join(map(show, general))} with friction"
        )


def _check_teeth(design: DriveDesign) -> None:
    drive = design.drive
    difference, lobes = drive.teeth_rg - drive.teeth_fs, design.lobes
    if difference <= 0 or difference % lobes:
        multiple = "two" if lobes == 2 else f"wave_generator.lobes = {lobes}"
        raise InputError(
            f"drive.teeth_rg - drive.teeth_fs = {difference} is out of range: allowed a positive "
            f"multiple of {multiple}"
        )
    if drive.dedendum_coef <= drive.addendum_coef:
        allowed = f"above {drive.addendum_coef:g} (the addendum) to 2 modules"
        _refuse("drive.dedendum_coef", drive.dedendum_coef, allowed)
    walls = {f"{gear}.rim": getattr(design, gear).rim for gear in design.gears}
    if design.housing is not None:
        walls["ring_gear.housing.thickness"] = design.housing.thickness
    least, most = THINNEST_RIM * drive.module, THICKEST_RIM * drive.module
    for key, thickness in walls.items():
        if not least <= thickness <= most:
            _refuse(
                key,
                thickness,
                f"{least:g} to {most:g} mm ({THINNEST_RIM:g} to {THICKEST_RIM:g} modules)",
            )
    if design.inner_radius <= design.deflection:
        allowed = "a rim that leaves an inner radius above the deflection"
        _refuse("flexible_spline.rim", design.flexible_spline.rim, allowed)


def _check_wave_generator(design: DriveDesign) -> None:
    wave = design.wave_generator
    if wave.lobes != 2 and not isinstance(wave, Harmonic):
        raise InputError(
            f"wave_generator.lobes = {wave.lobes} is not available with wave_generator.type = "
            f'"{wave.type}": '
            'allowed with "harmonic"'
        )
    if isinstance(wave, FourRoller):
        if wave.beta >= wave.pin_half_angle:
            _refuse(
                "wave_generator.beta",
                wave.beta,
                f"above 0 to below {wave.pin_half_angle:g} deg (pin_half_angle)",
            )
    elif design.minor_semi_axis < SMALLEST_MINOR_AXIS * design.inner_radius:
        allowed = (
            f"values whose minor semi-axis is at least {SMALLEST_MINOR_AXIS:g} of the spline's "
            f"inner radius"
        )
        _refuse("wave_generator.C", wave.C, allowed)
    elif wave.type == "harmonic":
        _check_concave(design, wave)


def _check_concave(design: DriveDesign, wave: Harmonic) -> None:
    """Bores so far from a concave part of a harmonic cam that points of them have several feet on
    it."""
    a = design.major_semi_axis
    b = design.minor_semi_axis
    bore = design.inner_radius
    order = design.lobes**2

    def room(b: float) -> float:
        return 1.0 + (b - 0.5 * order * (a - b)) / b**2 * (bore - b) - UNIQUE

    if b < bore and room(b) < 0.0:  # the curvature there is the least one of the cam
        least = wave.C * brentq(room, b, bore) / b
        _refuse(
            "wave_generator.C",
            wave.C,
            f"{least:.4g} (a concave cam near the spline) to 1",
        )


def _check_steps(design: DriveDesign) -> None:
    steps, least = design.steps, np.degrees(design.kinematics.period_angle) * design.periods
    if steps.samples and steps.rotation < 0.999999 * least:
        allowed = f"{least:.6g} deg (periods: {design.periods}) and more with steps.samples"
        _refuse("steps.rotation", steps.rotation, allowed)


def _check_torque(design: DriveDesign) -> None:
    """Torques that a cylinder like the weakest section of the cup, or the rim in the plane model,
    cannot carry."""
    material = design.materials["flexible_spline"]
    shear_modulus = 0.5 * material.modulus / (1.0 + material.poisson)
    weakest = design.inner_radius**2 * design.cup_thickness
    if design.has_cup:
        weakest = min(radius**2 * thickness for _, radius, thickness, _ in design.cup_sizes.points)
    most = 0.001 * LARGEST_SHEAR * shear_modulus * 2.0 * np.pi * weakest
    torques = {"load.torque": design.load.torque}
    torques |= {
        f"load.program.{k}.torque": stage.torque or 0.0
        for k, stage in enumerate(design.load.program, 1)
    }
    if design.stiffness is not None:
        torques["stiffness.torque"] = design.stiffness.torque or 0.0
    for key, torque in torques.items():
        if abs(torque) > most:
            of = "cup's wall" if design.has_cup else "rim"
            _refuse(
                key,
                torque,
                f"up to {most:.4g} N·m (nominal shear strain of the {of}: {LARGEST_SHEAR:g})",
            )


def _check_fatigue(design: DriveDesign) -> None:
    """Strengths in their order; Crossland's criterion needs a shear fatigue limit above that of von
    Mises."""
    fatigue = design.fatigue
    if fatigue is None:
        return
    tensile, limit = fatigue.tensile_strength, fatigue.fatigue_limit
    for key, most, name in (
        ("yield_strength", tensile, "tensile_strength"),
        ("fatigue_limit", tensile, "tensile_strength"),
        ("shear_fatigue_limit", limit, "fatigue_limit"),
    ):
        if getattr(fatigue, key) > most:
            _refuse(
                f"fatigue.{key}", getattr(fatigue, key), f"above 0 to {most:g} MPa (fatigue.{name})"
            )
    least = limit / np.sqrt(3.0)
    if fatigue.shear_fatigue_limit < least:
        allowed = f"{least:.4g} (fatigue.fatigue_limit over the root of 3) to {limit:g} MPa"
        _refuse("fatigue.shear_fatigue_limit", fatigue.shear_fatigue_limit, allowed)


def _check_plane(design: DriveDesign) -> None:
    if design.solver.condensed_sectors and not design.can_condense:
        raise InputError(
            f"solver.condensed_sectors = true leaves out {design.omitted_bending:.2g} of the "
            f"bending strain: allowed "
            f"up to {OMITTED_BENDING:g}, with more teeth or a thicker flexible_spline.rim"
        )
    for key in ("wg_crowning", "wg_slope", "fs_crowning"):
        value = getattr(design.micro_geometry, key)
        if value != 0.0:
            _refuse(f"micro_geometry.{key}", value, 'only 0 with drive.model = "plane"')


def _check_micro_geometry(design: DriveDesign) -> None:
    micro, module = design.micro_geometry, design.drive.module
    # beyond a quarter of its width the cam is a cone of some 30 degrees, off which the spline
    # slides
    most = min(0.5 * design.deflection, 0.25 * design.wave_generator.face_width)
    limits = "half the deflection, a quarter of the cam's width"
    if micro.wg_crowning > most:
        _refuse("micro_geometry.wg_crowning", micro.wg_crowning, f"0 to {most:g} mm ({limits})")
    if abs(micro.wg_slope) > most:
        _refuse("micro_geometry.wg_slope", micro.wg_slope, f"-{most:g} to {most:g} mm ({limits})")
    if micro.fs_crowning > 0.25 * module:
        allowed = f"0 to {0.25 * module:g} mm (a quarter of the module)"
        _refuse("micro_geometry.fs_crowning", micro.fs_crowning, allowed)


def _check_outline(design: DriveDesign) -> None:
    """All profiles and the cam can be built, and the cam's outline leaves room for the teeth."""
    spline, ring, *_ = (design.profile(gear) for gear in design.gears)
    bulge = (
        float(np.linalg.norm(design.cam().outline(OUTLINE_POINTS), axis=1).max())
        - design.major_semi_axis
    )
    clearance = max(
        ring.r_root_circle - spline.r_tip_circle - 0.5 * design.deflection,
        1e-6 * design.major_semi_axis,
    )
    if bulge > clearance:
        raise InputError(
            f"wave_generator ({design.wave_generator.type}) bulges {bulge:.3g} mm beyond its major "
            f"semi-axis: "
            f"allowed up to {clearance:.3g} mm, where the flexible spline's teeth meet the ring "
            f"gear's root circle; "
            f"its shape follows from {_shape_keys(design)}"
        )


def _shape_keys(design: DriveDesign) -> str:
    """The keys that determine the curve of the cam; a smaller C, where there is one, makes it
    slimmer."""
    others = ("type", "lobes", "face_width", "pin_half_angle", "bearing")
    keys = sorted(set(type(design.wave_generator).model_fields).difference(others))
    return ", ".join(
        f"wave_generator.{key}{' (smaller is slimmer)' if key == 'C' else ''}" for key in keys
    )
