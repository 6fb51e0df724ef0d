"""Checks of the bearing of the output and of the forces on it. Each refusal names the key, its
value and what is allowed."""

from __future__ import annotations

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.design.output_bearing import OutputBearing
from swgpar.input.require import require, require_available

SECTION = "[output_bearing]"
SIDEWAYS = f"a radial force or a tilting moment in {SECTION}"

LARGEST_TILT, LARGEST_SHIFT = 0.01, 0.1
"""Tilt (rad) and displacement (modules) up to which forces may move the output on its bearing
alone: tilts are small, and teeth mesh."""

FARTHEST = 10.0
"""Distance of the bearing from the middle of the face width, in pitch diameters of the flexible
spline. Farther away it does not carry the output, and its place is a slip of units."""


def check_output_bearing(design: DriveDesign, bearing: OutputBearing) -> None:
    """Raise InputError for the first thing that does not fit the design."""
    for given, beside, allowed in (
        (
            design.drive.model == "pancake",
            'drive.model = "pancake"',
            '"cup" or "plane", because no end of its flexible spline is held',
        ),
        (
            design.kinematics.wave_generator_is_fixed,
            'drive.layout = "wave_generator_fixed"',
            '"ring_fixed" or "spline_fixed"',
        ),
        (design.deviations is not None, "[deviations]", "without them"),
        (design.frequencies is not None, "[frequencies]", "without them"),
    ):
        require_available(not given, SECTION, beside, allowed)
    if design.drive.model == "plane":
        for key in ("axial_force", "tilting_moment"):
            value = getattr(bearing, key)
            allowed = 'only 0 with drive.model = "plane"'
            require(value == 0.0, f"output_bearing.{key}", value, allowed)
    most = FARTHEST * design.drive.module * design.drive.teeth_fs
    allowed = f"{-most:g} to {most:g} mm ({FARTHEST:g} pitch diameters)"
    fits = bearing.position is None or abs(bearing.position) <= most
    require(fits, "output_bearing.position", bearing.position, allowed)
    _check_size(bearing, design.drive.module)
    if bearing.is_loaded_sideways:
        _check_no_period(design)


def _check_no_period(design: DriveDesign) -> None:
    """Nothing that continues or needs one period, where forces keep the drive from repeating."""
    samples, stiffness = design.steps.samples, design.stiffness
    beside = f"{SIDEWAYS}, which does not repeat after a pitch"
    require(samples == 0, "steps.samples", samples, f"only 0 with {beside}")
    for section in ("fatigue", "losses"):
        absent = getattr(design, section) is None
        require_available(absent, f"[{section}]", beside, "without them")
    if stiffness is not None:
        positions = stiffness.positions
        require(positions == 1, "stiffness.positions", positions, f"only 1 with {beside}")


def _check_size(bearing: OutputBearing, module: float) -> None:
    """Forces that move the output farther than strains and teeth are made for."""
    moved, shift = np.abs(bearing.load) / bearing.stiffness, LARGEST_SHIFT * module
    by_shift, by_tilt = f"moves it by {shift:g} mm", f"tilts it by {LARGEST_TILT:g} rad"
    for key, ratio, most, unit, words in (
        ("radial_force", np.hypot(*moved[:2]), shift, "N", by_shift),
        ("axial_force", moved[2], shift, "N", by_shift),
        ("tilting_moment", np.hypot(*moved[3:]), LARGEST_TILT, "N·m", by_tilt),
    ):
        value = getattr(bearing, key)
        largest = f"{abs(value) * most / max(ratio, most):.4g}"
        least = f"-{largest}" if key == "axial_force" else "0"
        allowed = f"{least} to {largest} {unit}, which {words} on the bearing alone"
        require(ratio <= most, f"output_bearing.{key}", value, allowed)
