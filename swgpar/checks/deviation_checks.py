"""Checks that deviations fit the drive. Each refusal names the key, its value and what is
allowed."""

from __future__ import annotations

import numpy as np

from swgpar.checks.program_checks import given_program, in_rating
from swgpar.design.deviations import MICRO, Deviations
from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GEARS, GearName
from swgpar.errors import InputError
from swgpar.input.quantities import show
from swgpar.input.require import require, require_available

LARGEST = 0.1
"""Largest deviation over the module: everything is of first order in them."""

LENGTHS = {
    **{f"{gear}.{key}": "µm" for gear in GEARS for key in ("profile_slope", "profile_form")},
    **{f"{part}.eccentricity": "mm" for part in (*GEARS, "wave_generator", "cup")},
    "ring_gear.ovality": "mm",
}
"""Keys of deviations that are lengths, with their units."""

BEARING_ZERO = ("wave_generator.eccentricity", "wave_generator.tilt")
PLANE_ZERO = ("cup.eccentricity", "cup.tilt", "ring_gear.tilt", "wave_generator.tilt")
"""Keys that are 0 with a bearing, and in the plane model."""


def check_deviations(design: DriveDesign, deviations: Deviations) -> None:
    """Raise InputError for the first deviation that does not fit."""
    lobes = f"wave_generator.lobes = {design.wave_generator.lobes}"
    require_available(design.wave_generator.lobes == 2, "[deviations]", lobes, "with two")
    if design.load.torque == 0.0:
        raise InputError("load.torque = 0 holds the output: allowed above 0 N·m with [deviations]")
    program = given_program(design) or ""
    allowed = f"under one torque, load.torque{in_rating(program)}"
    require_available(not program, "[deviations]", program, allowed)
    for gear in GEARS:
        _check_pitch(design, deviations, gear)
    if design.bearing is not None:
        _require_zero(deviations, BEARING_ZERO, "wave_generator.bearing")
    for key, unit in LENGTHS.items():
        value = _value(deviations, key)
        most = LARGEST * design.drive.module / (MICRO if unit == "µm" else 1.0)
        allowed = f"up to {most:g} {unit} (a tenth of the module)"
        require(abs(value) <= most, f"deviations.{key}", value, allowed)
    if design.drive.model == "plane":
        _require_zero(deviations, PLANE_ZERO, 'drive.model = "plane"')


def _value(deviations: Deviations, key: str) -> float:
    part, name = key.split(".")
    return float(getattr(getattr(deviations, part), name))


def _require_zero(deviations: Deviations, keys: tuple[str, ...], beside: str) -> None:
    for key in keys:
        value = _value(deviations, key)
        require(value == 0.0, f"deviations.{key}", value, f"only 0 with {beside}")


def _check_pitch(design: DriveDesign, deviations: Deviations, gear: GearName) -> None:
    section, key = getattr(deviations, gear), f"deviations.{gear}"
    errors, teeth = section.pitch_errors, design.teeth(gear).n_teeth
    if section.pitch_column:
        raise InputError(
            f"{key}.pitch_column = {show(section.pitch_column)} has no file: allowed with "
            f"pitch_file"
        )
    if not errors:
        return
    if section.pitch_grade:
        raise InputError(
            f"{key}.pitch_grade = {section.pitch_grade} stands beside {key}.pitch_errors: allowed "
            f"is one of them"
        )
    if len(errors) != teeth:
        raise InputError(
            f"{key}.pitch_errors has {len(errors)} values: allowed {teeth}, one for each tooth"
        )
    most = LARGEST * design.drive.module / MICRO
    allowed = f"differences up to {most:g} µm (a tenth of the module)"
    require(np.ptp(errors) <= most, f"{key}.pitch_errors", max(errors, key=abs), allowed)
