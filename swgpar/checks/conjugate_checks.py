"""Checks of a conjugate profile: it needs another gear of its own profile, and a cam with two axes
of symmetry."""

from __future__ import annotations

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GEARS, GearName
from swgpar.errors import InputError
from swgpar.geometry.profiles import Conjugate


def check_conjugate(design: DriveDesign) -> None:
    """Raise InputError where a conjugate profile has nothing to be conjugate to."""
    for gear in GEARS:
        if isinstance(getattr(design, gear).profile, Conjugate):
            _check(design, gear)


def _check(design: DriveDesign, gear: GearName) -> None:
    name, profile = f"{gear}.profile", getattr(design, gear).profile
    if all(isinstance(getattr(design, each).profile, Conjugate) for each in GEARS):
        raise InputError(
            f'{name}.type = "conjugate" is available for one gear only: allowed another type for '
            f"one"
        )
    if design.wave_generator.type == "asymmetric_parabolic":
        raise InputError(
            f'{name}.type = "conjugate" is not available with wave_generator.type = '
            f'"asymmetric_parabolic": both '
            "flanks of a tooth are mirror images, allowed are cams with two axes of symmetry"
        )
    half = 0.5 * design.drive.face_width if design.has_cup else 0.0
    if abs(profile.section) > half:
        raise InputError(
            f"{name}.section = {profile.section:g} is out of range: allowed -{half:g} to {half:g} "
            f"mm"
        )
