"""Exact tooth profiles (section 3.3).

A new profile is a module here that returns a `ToothProfile`, its keys in `keys.py` and an entry in `make_profile`.
"""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from swgpar.errors import InputError
from swgpar.geometry.profiles.conjugate import conjugate
from swgpar.geometry.profiles.double_arc import double_arc
from swgpar.geometry.profiles.flank import ToothProfile, check_flank
from swgpar.geometry.profiles.involute import Cutter, involute
from swgpar.geometry.profiles.keys import (
    Conjugate,
    DoubleArc,
    ExternalProfile,
    InternalProfile,
    QuadrupleArc,
    RackInvolute,
    ShaperInvolute,
)
from swgpar.geometry.profiles.pitch_point import PitchPointFrame
from swgpar.geometry.profiles.quadruple_arc import quadruple_arc
from swgpar.geometry.profiles.teeth import Teeth
from swgpar.geometry.profiles.tooth_motion import ToothMotion
from swgpar.input.quantities import show


def make_profile(
    keys: ExternalProfile | InternalProfile,
    teeth: Teeth,
    c_P: float = 1.0,
    c_l: float = 0.5,
    gear: str = "gear",
    partner: tuple[ToothProfile, ToothMotion] | None = None,
) -> ToothProfile:
    """Flank of a gear.

    Parameters
    ----------
    keys : section [flexible_spline.profile] or [ring_gear.profile] of the design file
    teeth : number and sizes of the teeth
    c_P : angular tooth thickness reduction (eq. 3.22); 1 for involutes
    c_l : share of the straight segment above the pitch point; 0.5 for involutes
    gear : name of the gear's section, for messages
    partner : the other gear's flank and the motion of the flexible spline's tooth; conjugate profiles need them

    Raises InputError where the keys give no flank.
    """
    name = f"{gear}.profile"
    if isinstance(keys, QuadrupleArc):
        frame = PitchPointFrame(**asdict(teeth), c_P=c_P)
        profile = quadruple_arc(
            frame, c_l, keys.r_tip, keys.r_addendum, keys.straight_l, keys.r_dedendum, keys.r_root, name
        )
    elif isinstance(keys, DoubleArc):
        profile = double_arc(PitchPointFrame(**asdict(teeth), c_P=c_P), c_l, keys.r_addendum, keys.r_dedendum, name)
    elif isinstance(keys, Conjugate):
        _refuse_direct_keys(c_P, c_l, gear, f"a conjugate profile, whose tooth thickness follows from {name}.backlash")
        profile = conjugate(keys, teeth, *partner, name)
    else:
        _refuse_direct_keys(
            c_P, c_l, gear, f"an involute profile, whose tooth thickness follows from {gear}.profile.shift"
        )
        profile = involute(_cutter(keys, teeth), name)
    try:
        check_flank(profile)
    except InputError as error:
        sizes = ", ".join(f"{key} = {show(value)}" for key, value in keys if isinstance(value, float))
        raise InputError(
            f"{name} with {sizes} cannot be built: {error}; allowed are arcs and cutters that stay inside the tooth"
        ) from None
    return profile


def _refuse_direct_keys(c_P: float, c_l: float, gear: str, other: str) -> None:
    """Refuse values of keys that shape directly defined profiles only. other : the profile, and what replaces c_P"""
    if c_P != 1.0:
        raise InputError(f"{gear}.c_P = {c_P:g} is out of range: allowed 1 with {other}")
    if c_l != 0.5:
        raise InputError(
            f"{gear}.c_l = {c_l:g} is out of range: allowed 0.5 with {other.partition(',')[0]} (no straight segment)"
        )


def _cutter(keys: RackInvolute | ShaperInvolute, teeth: Teeth) -> Cutter:
    """Gear and cutter of an involute profile."""
    sizes = asdict(teeth)
    if keys.pressure_angle is not None:
        sizes["pressure_angle"] = float(np.radians(keys.pressure_angle))
    cutter_teeth = keys.cutter_teeth if isinstance(keys, ShaperInvolute) else 0
    return Cutter(**sizes, tip_radius=keys.cutter_radius, shift=keys.shift, cutter_teeth=cutter_teeth)


__all__ = [
    "Conjugate",
    "ExternalProfile",
    "InternalProfile",
    "RackInvolute",
    "Teeth",
    "ToothMotion",
    "ToothProfile",
    "make_profile",
]
