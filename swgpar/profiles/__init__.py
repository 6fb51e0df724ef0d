"""Exact tooth profiles (section 3.3).

A new profile is a module here, keys in `keys.py`, a branch in `_build` (own_cam_or_profile.md).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, replace
from functools import lru_cache, partial

import numpy as np

from swgpar.errors import InputError
from swgpar.input.quantities import show
from swgpar.input.require import require
from swgpar.profiles.advice import advise
from swgpar.profiles.common_tangent import common_tangent
from swgpar.profiles.conjugate import conjugate
from swgpar.profiles.cycloid import cycloid
from swgpar.profiles.double_arc import double_arc
from swgpar.profiles.flank import ToothProfile, check_flank
from swgpar.profiles.from_points import fitted_flank
from swgpar.profiles.involute import Cutter, involute
from swgpar.profiles.keys import (
    CommonTangent,
    Conjugate,
    Cycloid,
    DoubleArc,
    ExternalProfile,
    InternalProfile,
    Points,
    QuadrupleArc,
    RackInvolute,
    ShaperInvolute,
    SShaped,
    Trapezoid,
)
from swgpar.profiles.pitch_point import PitchPointFrame
from swgpar.profiles.quadruple_arc import quadruple_arc
from swgpar.profiles.s_shaped import RackPath, s_shaped
from swgpar.profiles.teeth import Teeth
from swgpar.profiles.tooth_motion import ToothMotion
from swgpar.profiles.trapezoid import trapezoid


@lru_cache(maxsize=32)
def make_profile(
    keys: ExternalProfile | InternalProfile,
    teeth: Teeth,
    c_P: float = 1.0,
    c_l: float = 0.5,
    gear: str = "gear",
    partner: tuple[ToothProfile, ToothMotion] | None = None,
    path: RackPath | None = None,
) -> ToothProfile:
    """Flank of a gear.

    keys : section [flexible_spline.profile] or [ring_gear.profile] of the design file
    teeth : number and sizes of the teeth
    c_P : angular tooth thickness reduction (eq. 3.22); 1 with a `thickness_key`
    c_l : share of the straight segment above the pitch point; 0.5 without one
    gear : name of the gear's section, for messages
    partner : of conjugate profiles, the other flank and the motion of the flexible spline's tooth
    path : of the flexible spline's tooth in its slot, for S-shaped profiles

    Raises InputError where the keys give no flank.
    """
    build = partial(_build, teeth=teeth, c_P=c_P, c_l=c_l, gear=gear, partner=partner, path=path)
    try:
        return build(keys)
    except InputError as error:
        if not keys.typical_lengths:
            raise
        reason = str(error)
    advice = _advice(keys, build, teeth.module, c_l, gear)
    raise InputError(f"{reason}; {advice}" if advice else reason)


def _advice(
    keys: ExternalProfile | InternalProfile,
    build: Callable[[ExternalProfile | InternalProfile], ToothProfile],
    module: float,
    c_l: float,
    gear: str,
) -> str:
    """What to change in keys that give no flank, to end a sentence; empty if the reason says it."""

    def builds(**values: float) -> bool:
        try:
            build(keys.model_copy(update=values))
        except InputError:
            return False
        return True

    name = f"{gear}.profile"
    if isinstance(keys, DoubleArc) and c_l >= 1.0:
        return ""
    if isinstance(keys, QuadrupleArc) and (
        keys.r_tip == keys.r_addendum or keys.r_root == keys.r_dedendum
    ):
        return ""  # it is another type of profile
    lengths = {key: getattr(keys, key) for key in keys.typical_lengths}
    if advice := advise(name, lengths, lambda key, value: builds(**{key: value}), module):
        return advice
    typical = {key: float(f"{value * module:.4g}") for key, value in keys.typical_lengths.items()}
    if builds(**typical):
        return f"several keys of {name} do not fit: allowed are for example " + ", ".join(
            f"{key} = {show(value)}" for key, value in typical.items()
        )
    if keys.thickness_key or hasattr(keys, "cutter_radius"):
        return ""  # the reason says what is allowed
    shares = "c_P, c_l" if keys.divides_straight else "c_P"
    return (
        f"no other lengths of {name} close it: allowed are other {shares}, pressure angles or "
        "heights of the teeth"
    )


def _build(
    keys: ExternalProfile | InternalProfile,
    teeth: Teeth,
    c_P: float,
    c_l: float,
    gear: str,
    partner: tuple[ToothProfile, ToothMotion] | None,
    path: RackPath | None,
) -> ToothProfile:
    """Flank of a gear; raises InputError with the reason where there is none."""
    name = f"{gear}.profile"
    _refuse_other_keys(keys, c_P, c_l, gear)
    frame = PitchPointFrame(**asdict(teeth), c_P=c_P)
    if isinstance(keys, QuadrupleArc | DoubleArc):
        build = quadruple_arc if isinstance(keys, QuadrupleArc) else double_arc
        profile = build(frame, c_l, **keys.model_dump(exclude={"type"}), name=name)
    elif isinstance(keys, Trapezoid):
        if keys.flank_angle is not None:
            at_pitch = np.radians(keys.flank_angle) + frame.sign * frame.half_thickness
            frame = replace(frame, pressure_angle=float(at_pitch))
        profile = trapezoid(frame, keys.r_tip, keys.r_root, name)
    elif isinstance(keys, CommonTangent):
        profile = common_tangent(keys, frame, name).thinned(c_P)
    elif isinstance(keys, Points):
        profile = fitted_flank(keys, teeth, name).profile.thinned(c_P)
    elif isinstance(keys, SShaped):
        profile = s_shaped(keys, teeth, path, name).thinned(c_P)
    elif isinstance(keys, Cycloid):
        profile = cycloid(keys, teeth, name).thinned(c_P)
    elif isinstance(keys, Conjugate):
        other, motion = partner
        profile = conjugate(keys, teeth, other, motion, name)
    else:
        profile = involute(_cutter(keys, teeth, c_P), name)
    try:
        swept = any(segment.name == "swept" for segment in profile.segments)
        check_flank(profile, corners=swept or isinstance(keys, Points))
    except InputError as error:
        given = [f"{key} = {show(value)}" for key, value in keys if isinstance(value, float)]
        values = f" with {', '.join(given)}" if given else ""
        reason = f"{name}{values} cannot be built: {error}"
        raise InputError(f"{reason}{_hint(keys, name, str(error))}") from None
    return profile


def _hint(keys: ExternalProfile | InternalProfile, name: str, reason: str) -> str:
    """What helps a flank that cannot be built for this reason; empty where nothing is known."""
    if hasattr(keys, "cutter_radius"):
        return "; allowed are cutters that stay inside the tooth"
    if isinstance(keys, Conjugate) and "land is left" in reason:
        if "root" in reason:
            return f"; make {name}.backlash larger, which makes its teeth thinner, and r_root small"
        return f"; make {name}.backlash smaller"
    return ""


def _refuse_other_keys(
    keys: ExternalProfile | InternalProfile, c_P: float, c_l: float, gear: str
) -> None:
    """Refuse values of keys of the gear that do not shape such a profile."""
    profile, thickness = f'with {gear}.profile.type = "{keys.type}"', keys.thickness_key
    allowed = f"1 {profile}, whose tooth thickness follows from {gear}.profile.{thickness}"
    require(not thickness or c_P == 1.0, f"{gear}.c_P", c_P, allowed)
    divides, allowed = keys.divides_straight, f"0.5 {profile}, which does not use it"
    require((divides and not thickness) or c_l == 0.5, f"{gear}.c_l", c_l, allowed)


def _cutter(keys: RackInvolute | ShaperInvolute, teeth: Teeth, c_P: float) -> Cutter:
    """Gear and cutter of an involute profile."""
    sizes = asdict(teeth)
    if keys.pressure_angle is not None:
        sizes["pressure_angle"] = float(np.radians(keys.pressure_angle))
    cutter_teeth = keys.cutter_teeth if isinstance(keys, ShaperInvolute) else 0
    return Cutter(
        **sizes,
        tip_radius=keys.cutter_radius,
        shift=keys.shift,
        cutter_teeth=cutter_teeth,
        c_P=c_P,
    )


__all__ = [
    "Conjugate",
    "ExternalProfile",
    "InternalProfile",
    "Points",
    "RackInvolute",
    "RackPath",
    "SShaped",
    "Teeth",
    "ToothMotion",
    "ToothProfile",
    "make_profile",
]
