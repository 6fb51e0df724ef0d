"""Checks and remarks on the heights of the teeth and on the rim below them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import FLANK_CROWNINGS, ExternalGear, GearName, InternalGear
from swgpar.errors import InputError
from swgpar.input.require import require
from swgpar.profiles import Points
from swgpar.profiles.flank import ToothProfile

LARGEST_DEDENDUM = 2.0
"""Largest dedendum in modules, of both sections that have the key."""

ROUND_OFF = 1e-9
"""Modules by which tips may be beyond the root circle they touch."""

THIN_RIM = 0.25
"""Rim over tooth height below which it is said: half of 0.5, below which rims of external gears are
to be avoided by ISO 6336-3 (rim thickness factor); rims of flexible splines are thin on purpose."""

CORNER = np.radians(0.1)
"""Corner between two pieces of a swept area from which it is said. Below, the flank is smooth
beside the deviations of any cutter."""


def check_teeth(design: DriveDesign) -> None:
    """Raise InputError where tips lie beyond the root circle of the other gear at the major axis,
    and for too large a crowning."""
    module = design.drive.module
    for gear in design.gears:
        _check_heights_of_points(getattr(design, gear), gear)
    for gear, faced in _faced(design):
        section = getattr(design, faced)
        own = section.dedendum_coef is not None
        key = f"{faced if own else 'drive'}.dedendum_coef"
        if isinstance(section.profile, Points):
            key = f"the dedendum of {faced}.profile.points"
        value = design.teeth(faced).dedendum / module
        least = value - _room(design, gear, faced) / module
        if least > LARGEST_DEDENDUM:
            raise InputError(
                f"{key} = {value:g} leaves no room for the tips of {gear} at the major axis with a "
                f"radial deflection of {0.5 * design.deflection / module:.4g} modules: "
                f"{least:.4g} modules would, allowed up to {LARGEST_DEDENDUM:g}; a smaller "
                f"deflection or addendum_coef of {gear} leaves room"
            )
        allowed = f"{least:.6g} to {LARGEST_DEDENDUM:g} modules (tips of {gear} at the major axis)"
        require(value >= least - ROUND_OFF, key, value, allowed)
    most = 0.25 * module
    allowed = f"0 to {most:g} mm (a quarter of the module)"
    for gear, key in FLANK_CROWNINGS.items():
        crowning = design.micro_geometry.flank_crowning(gear)
        require(crowning <= most, f"micro_geometry.{key}", crowning, allowed)
        exists = crowning == 0.0 or gear in design.gears
        require(exists, f"micro_geometry.{key}", crowning, f"only 0 without a {gear}")


def _check_heights_of_points(section: ExternalGear | InternalGear, gear: GearName) -> None:
    """Points have their own heights."""
    if isinstance(section.profile, Points):
        for key in ("addendum_coef", "dedendum_coef"):
            value = getattr(section, key)
            allowed = f"only without it, for {gear}.profile.points set the height"
            require(value is None, f"{gear}.{key}", value, allowed)


def _faced(design: DriveDesign) -> list[tuple[GearName, GearName]]:
    """Pairs of a gear and the one whose roots its tips face."""
    pairs: list[tuple[GearName, GearName]] = []
    for ring in design.gears[1:]:
        pairs += [("flexible_spline", ring), (ring, "flexible_spline")]
    return pairs


def _room(design: DriveDesign, gear: GearName, faced: GearName) -> float:
    """From the tips of a gear to the root circle of the one it faces at the major axis, mm."""
    teeth, other = design.teeth(gear), design.teeth(faced)
    between = abs(teeth.r_pitch - other.r_pitch) - 0.5 * design.deflection
    return between + other.dedendum - teeth.addendum


def _largest_corner(flank: ToothProfile) -> float:
    """Largest angle (rad) between pieces of the boundary of a swept area; 0 without any."""
    swept = [one.name == other.name == "swept" for one, other in pairwise(flank.segments)]
    return float(np.abs(flank.kinks[swept]).max(initial=0.0))


def tooth_remarks(design: DriveDesign) -> list[str]:
    """Sentences about tips that touch a root, swept areas as flanks, and a thin rim."""
    sentences = []
    for gear, faced in _faced(design):
        if _room(design, gear, faced) <= ROUND_OFF * design.drive.module:
            sentences.append(
                f"the tips of {gear} touch the root circle of {faced} at the major axis: contact "
                f"there is not computed; a larger dedendum_coef of {faced} leaves room"
            )
    for gear in design.gears:
        corner = _largest_corner(design.profile(gear))
        if corner > CORNER:
            other = "ring_gear" if gear == "flexible_spline" else "flexible_spline"
            sentences.append(
                f"{gear}.profile is the boundary of the area that the teeth of {other} sweep, with "
                f"a corner of {np.degrees(corner):.2g} degrees: the envelope of their flanks is "
                "undercut or not all that touches, and a contact at the corner has no finite "
                "pressure"
            )
    rim, teeth = design.flexible_spline.rim, design.teeth("flexible_spline")
    height = teeth.addendum + teeth.dedendum
    if rim < THIN_RIM * height:
        sentences.append(
            f"flexible_spline.rim = {rim:g} mm is {rim / height:.2g} of the height of the teeth "
            f"({height:.4g} mm): it bends in the spaces between the teeth only, where stresses are "
            "largest; rims of 0.5 and more of the height are usual"
        )
    return sentences
