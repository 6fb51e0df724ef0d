"""Checks of the cam's keys: deflection, axes, rollers, outline. Each refusal names the key, its
value and what is allowed."""

from __future__ import annotations

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.geometry.bracketed_root import root_between
from swgpar.geometry.cams import FourRoller, OffsetCam, TwoRoller
from swgpar.geometry.cams.keys import CamPoints, Harmonic, Polar, Reduced, Simplified
from swgpar.input.require import require, require_available

UNIQUE = 0.25
"""1 less curvature of a concave cam times its distance from the bore, at least: at 0 foot points
are not unique."""

SMALLEST_MINOR_AXIS, NARROWEST = 0.4, 0.1
"""Smallest minor semi-axis of a cam over the inner radius of the flexible spline, and that of two
semicircles, from which points have one foot however narrow they are."""

OUTLINE_POINTS, CURVE_POINTS = 2000, 7200
"""Points of the cam's outline at which its largest radius is measured, and at which a curve from
points or from an expression is looked at."""

DEFLECTION_KEYS = ("deflection", "major_axis", "centre_radius")
"""Keys of a cam that set the deflection: one of them may be given."""


def check_cam(design: DriveDesign) -> None:
    """Raise InputError for the first key of the cam that does not fit the others or the bore."""
    wave = design.wave_generator
    require_available(
        wave.lobes == 2 or isinstance(wave, Harmonic | Polar | CamPoints),
        f"wave_generator.lobes = {wave.lobes}",
        f'wave_generator.type = "{wave.type}"',
        'with "harmonic", "polar" or "points"',
    )
    _check_deflection(design)
    if isinstance(wave, FourRoller):
        allowed = f"above 0 to below {wave.pin_half_angle:g} deg (pin_half_angle)"
        require(wave.beta < wave.pin_half_angle, "wave_generator.beta", wave.beta, allowed)
    if isinstance(wave, TwoRoller) and wave.distance:
        _check_discs(design, wave)
    if isinstance(wave, Reduced):
        _check_minor_axis(design, wave)
    if wave.offset:
        _check_offset(design)
    if isinstance(wave, Harmonic) and not wave.offset:
        _check_concave(design, wave)
    elif isinstance(wave, Harmonic | Polar | CamPoints):
        _check_curve(design)
    width, widest = wave.width, design.drive.face_width
    allowed = f"above 0 to {widest:g} mm (drive.face_width)"
    require(width <= widest, "wave_generator.face_width", width, allowed)
    if design.drive.model != "plane":
        _check_modifications(design)


def _check_deflection(design: DriveDesign) -> None:
    """A deflection from one key, above 0 and below half the bore."""
    wave, bore, deflection = design.wave_generator, design.inner_radius, 0.5 * design.deflection
    if isinstance(wave, CamPoints):
        _require_points_fit(wave, bore, deflection)
        return
    given = [key for key in DEFLECTION_KEYS if getattr(wave, key, None) is not None]
    if len(given) > 1:
        raise InputError(
            f"wave_generator.{given[0]} and wave_generator.{given[1]} are both given: allowed is "
            "one of them"
        )
    smallest, rim = 0.0 if given else design.drive.standard_deflection, design.flexible_spline.rim
    allowed = f"below {rim + bore - smallest:.6g} mm, which leaves an inner radius"
    allowed += "" if given else f" above the deflection, {smallest:g} mm"
    require(bore > smallest, "flexible_spline.rim", rim, allowed)
    if given:
        value = getattr(wave, given[0])  # of the curve, with an offset
        per_key = 2.0 if given[0] == "major_axis" else 1.0
        least = value - per_key * deflection
        lowest, highest = max(least, 0.0), least + per_key * 0.5 * bore
        allowed = f"above {lowest:.6g} to below {highest:.6g} mm (a deflection of half the bore's"
        allowed += " radius)"
        require(0.0 < deflection < 0.5 * bore, f"wave_generator.{given[0]}", value, allowed)


def _check_discs(design: DriveDesign, wave: TwoRoller) -> None:
    """Discs beside each other, in a cup drive, without a slope."""
    key, given = "wave_generator.distance", f"wave_generator.distance = {wave.distance:g}"
    model, slope = design.drive.model, design.micro_geometry.wg_slope
    require_available(
        model == "cup", given, f'drive.model = "{model}"', 'with "cup", or rollers of a distance 0'
    )
    require_available(slope == 0.0, f"micro_geometry.wg_slope = {slope:g}", given, "0")
    most = design.drive.face_width - wave.face_width
    allowed = (
        f"{wave.face_width:g} (wave_generator.face_width, of a disc) to {most:g} mm (the rest of "
        "drive.face_width)"
    )
    require(wave.face_width <= wave.distance <= most, key, wave.distance, allowed)
    reach = design.major_semi_axis - wave.r_2
    require(reach > 0.0, "wave_generator.r_2", wave.r_2, f"below {design.major_semi_axis:.6g} mm")


def _require_points_fit(wave: CamPoints, bore: float, deflection: float) -> None:
    """Points set the deflection, and lie outside of the bore at the major axis."""
    if wave.deflection is not None:
        raise InputError(
            f"wave_generator.deflection = {wave.deflection:g} is given beside points, which set "
            f"the deflection, {deflection:.6g} mm: allowed is one of them"
        )
    if not 0.0 < deflection < 0.5 * bore:
        given, least, most = (x - wave.offset for x in (bore + deflection, bore, 1.5 * bore))
        less = " less wave_generator.offset" if wave.offset else ""
        raise InputError(
            f"wave_generator.points have the radius {given:.6g} mm at the major axis: allowed "
            f"above {least:.6g} mm (the bore{less}) to below {most:.6g} mm"
        )


def _check_minor_axis(design: DriveDesign, wave: Reduced) -> None:
    """A minor axis from one key, below the major one and not much smaller than the bore."""
    share = NARROWEST if isinstance(wave, Simplified) else SMALLEST_MINOR_AXIS
    least = share * design.inner_radius
    if wave.minor_axis is None:
        smallest = wave.C * (least - wave.offset) / (design.minor_semi_axis - wave.offset)
        allowed = (
            f"{smallest:.6g} and more: a minor semi-axis of at least {share:g} of the spline's "
            "inner radius"
        )
        require(design.minor_semi_axis >= least, "wave_generator.C", wave.C, allowed)
        return
    if wave.C != 1.0:
        raise InputError(
            "wave_generator.C and wave_generator.minor_axis are both given: allowed is one of them"
        )
    allowed = (
        f"{2.0 * (least - wave.offset):.6g} ({share:g} of the bore) to below "
        f"{2.0 * (design.major_semi_axis - wave.offset):.6g} mm (the major axis)"
    )
    fits = least <= design.minor_semi_axis < design.major_semi_axis
    require(fits, "wave_generator.minor_axis", wave.minor_axis, allowed)


def _check_concave(design: DriveDesign, wave: Harmonic) -> None:
    """Bores so far from a concave part of a harmonic cam that points of them have several feet on
    it."""
    a, b, bore = design.major_semi_axis, design.minor_semi_axis, design.inner_radius
    order = design.wave_generator.lobes**2

    def room(b: float) -> float:
        return 1.0 + (b - 0.5 * order * (a - b)) / b**2 * (bore - b) - UNIQUE

    if b < bore and room(b) < 0.0:  # the curvature there is the least one of the cam
        root = root_between(room, b, bore)
        reason = "(a concave cam near the spline) to"
        if wave.minor_axis is not None:
            allowed = f"{2.0 * root:.6g} {reason} below {2.0 * a:.6g} mm"
            require(False, "wave_generator.minor_axis", wave.minor_axis, allowed)
        require(False, "wave_generator.C", wave.C, f"{wave.C * root / b:.4g} {reason} 1")


def _check_offset(design: DriveDesign) -> None:
    """A parallel curve without corners, of a cam and not of rollers."""
    wave, cam = design.wave_generator, design.cam()
    require_available(
        not isinstance(wave, FourRoller | TwoRoller),
        f"wave_generator.offset = {wave.offset:g}",
        f'wave_generator.type = "{wave.type}"',
        "0",
    )
    assert isinstance(cam, OffsetCam)
    curvature = cam.cam.evaluate(cam.cam.outline(CURVE_POINTS))[2]
    sharp, hollow = float(curvature.max()), float(curvature.min())
    least = (UNIQUE - 1.0) / sharp if sharp > 0.0 else -np.inf
    most = (UNIQUE - 1.0) / hollow if hollow < 0.0 else np.inf
    most = min(most, 0.5 * design.inner_radius)
    allowed = f"{least:.4g} to {most:.4g} mm (curvature of the cam)"
    require(least <= wave.offset <= most, "wave_generator.offset", wave.offset, allowed)


def _check_curve(design: DriveDesign) -> None:
    """A curve that is not much smaller than the bore anywhere, and has one foot for each point of
    the bore."""
    cam, bore = design.cam(), design.inner_radius
    outline = cam.outline(CURVE_POINTS)
    radius, curvature = np.hypot(*outline.T), cam.evaluate(outline)[2]
    angle = np.degrees(np.arctan2(-outline[:, 0], outline[:, 1]))
    at = int(radius.argmin())
    if radius[at] < SMALLEST_MINOR_AXIS * bore:
        raise InputError(
            f"wave_generator ({design.wave_generator.type}) has the radius {radius[at]:.4g} mm at "
            f"{angle[at]:.4g} degrees from the major axis: allowed from "
            f"{SMALLEST_MINOR_AXIS * bore:.4g} mm ({SMALLEST_MINOR_AXIS:g} of the bore's)"
        )
    room = 1.0 + curvature * np.maximum(bore - radius, 0.0) - UNIQUE
    at = int(room.argmin())
    if room[at] < 0.0:
        raise InputError(
            f"wave_generator ({design.wave_generator.type}) is concave with the radius "
            f"{-1.0 / curvature[at]:.4g} mm at {angle[at]:.4g} degrees from the major axis, "
            f"{bore - radius[at]:.4g} mm inside of the bore: allowed radii above "
            f"{(bore - radius[at]) / (1.0 - UNIQUE):.4g} mm there"
        )


def _check_modifications(design: DriveDesign) -> None:
    # beyond a quarter of its width the cam is a cone of some 30 degrees, off which the spline
    # slides
    most = min(0.5 * design.deflection, 0.25 * design.wave_generator.face_width)
    for key, least in (("wg_crowning", 0.0), ("wg_slope", -most)):
        value = getattr(design.micro_geometry, key)
        allowed = f"{least:g} to {most:g} mm (half the deflection, a quarter of the cam's width)"
        require(least <= value <= most, f"micro_geometry.{key}", value, allowed)


def check_outline(design: DriveDesign) -> None:
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
            f"semi-axis: allowed up to {clearance:.3g} mm, where the flexible spline's teeth meet "
            f"the ring gear's root circle; its shape follows from {_shape_keys(design)}"
        )


def _shape_keys(design: DriveDesign) -> str:
    """The keys that determine the curve of the cam; a smaller C, where there is one, makes it
    slimmer."""
    others = ("type", "lobes", "face_width", "pin_half_angle", "bearing")
    keys = sorted(set(type(design.wave_generator).model_fields).difference(others))
    return ", ".join(
        f"wave_generator.{key}{' (smaller is slimmer)' if key == 'C' else ''}" for key in keys
    )
