"""Checks that deviations fit the drive. Each refusal names the key, its value and what is
allowed."""

from __future__ import annotations

import numpy as np

from swgpar.checks.program_checks import given_program
from swgpar.design.deviations import MICRO, Deviations
from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GEARS, GearName
from swgpar.errors import InputError
from swgpar.input.quantities import show

LARGEST = 0.1
"""Largest deviation over the module: everything is of first order in them."""


def check_deviations(design: DriveDesign, deviations: Deviations) -> None:
    """Raise InputError for the first deviation that does not fit."""
    if design.lobes != 2:
        raise InputError(
            f"[deviations] is not available with wave_generator.lobes = {design.lobes}: allowed "
            f"with two"
        )
    if design.load.torque == 0.0:
        raise InputError("load.torque = 0 holds the output: allowed above 0 N·m with [deviations]")
    if program := given_program(design):
        raise InputError(
            f"[deviations] is not available with {program}: allowed under one torque, load.torque"
        )
    if design.contact.friction:
        raise InputError(
            f"contact.friction = {design.contact.friction:g} is out of range: allowed 0 with "
            f"[deviations]"
        )
    for gear in GEARS:
        _check_pitch(design, deviations, gear)
    cam = deviations.wave_generator
    for key, value in (("eccentricity", cam.eccentricity), ("tilt", cam.tilt)):
        if value and design.bearing is not None:
            raise InputError(
                f"deviations.wave_generator.{key} = {value:g} is out of range: allowed only 0 with "
                "wave_generator.bearing"
            )
    module = design.drive.module
    for key, unit in LENGTHS.items():
        section, name = key.split(".")
        value, most = getattr(getattr(deviations, section), name), LARGEST * module / unit
        if abs(value) > most:
            raise InputError(
                f"deviations.{key} = {value:g} is out of range: allowed up to {most:g} "
                f"{'mm' if unit == 1.0 else 'µm'} (a tenth of the module)"
            )
    if design.drive.model == "plane":
        for key in ("cup.eccentricity", "cup.tilt", "ring_gear.tilt", "wave_generator.tilt"):
            section, name = key.split(".")
            if value := getattr(getattr(deviations, section), name):
                raise InputError(
                    f"deviations.{key} = {value:g} is out of range: allowed only 0 with "
                    f'drive.model = "plane"'
                )


LENGTHS = {
    **{
        f"{gear}.{key}": unit
        for gear in GEARS
        for key, unit in (("profile_slope", MICRO), ("profile_form", MICRO))
    },
    **{f"{part}.eccentricity": 1.0 for part in (*GEARS, "wave_generator", "cup")},
    "ring_gear.ovality": 1.0,
}
"""Keys of deviations that are lengths, with their units in mm."""


def _check_pitch(design: DriveDesign, deviations: Deviations, gear: GearName) -> None:
    section, key = getattr(deviations, gear), f"deviations.{gear}"
    errors, teeth = section.pitch_errors, design.drive.teeth(gear).n_teeth
    if section.pitch_column:
        raise InputError(
            f"{key}.pitch_column = {show(section.pitch_column)} has no file: allowed with "
            f"pitch_file"
        )
    if errors and section.pitch_grade:
        raise InputError(
            f"{key}.pitch_grade = {section.pitch_grade} stands beside {key}.pitch_errors: allowed "
            f"is one of them"
        )
    if errors and len(errors) != teeth:
        raise InputError(
            f"{key}.pitch_errors has {len(errors)} values: allowed {teeth}, one for each tooth"
        )
    most = LARGEST * design.drive.module / MICRO
    if errors and np.ptp(errors) > most:
        raise InputError(
            f"{key}.pitch_errors = {show(max(errors, key=abs))} is out of range: allowed "
            f"differences up to {most:g} µm "
            "(a tenth of the module)"
        )
