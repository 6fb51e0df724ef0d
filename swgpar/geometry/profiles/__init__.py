"""Exact tooth profiles. A new profile is a new file here, its keys, and an entry in `make_profile`."""

from __future__ import annotations

import numpy as np

from swgpar.errors import InputError
from swgpar.geometry.profiles.curve import ToothProfile, check_flank
from swgpar.geometry.profiles.double_arc import double_arc
from swgpar.geometry.profiles.frame import FlankFrame
from swgpar.geometry.profiles.involute import Cutter, involute
from swgpar.geometry.profiles.keys import DoubleArc, ExternalProfile, InternalProfile, QuadrupleArc, RackInvolute
from swgpar.geometry.profiles.quadruple_arc import quadruple_arc
from swgpar.input.quantities import show


def _cutter(design, gear: str) -> Cutter:
    """Gear and cutter of an involute profile; refuses the keys that shape directly defined profiles only."""
    drive, spec = design.drive, getattr(design, gear)
    p, external = spec.profile, gear == "flexible_spline"
    if spec.c_P != 1.0:
        raise InputError(
            f"{gear}.c_P = {spec.c_P:g} is out of range: allowed 1 with an involute profile, whose tooth thickness "
            f"follows from {gear}.profile.shift"
        )
    if spec.c_l != 0.5:
        raise InputError(
            f"{gear}.c_l = {spec.c_l:g} is out of range: allowed 0.5 with an involute profile (no straight segment)"
        )
    angle = drive.pressure_angle if p.pressure_angle is None else p.pressure_angle
    return Cutter(
        n_teeth=drive.teeth_fs if external else drive.teeth_rg,
        module=drive.module,
        pressure_angle=float(np.radians(angle)),
        addendum=drive.addendum_coef * drive.module,
        dedendum=drive.dedendum_coef * drive.module,
        tip_radius=p.cutter_radius,
        shift=p.shift,
        external=external,
        cutter_teeth=0 if external else p.cutter_teeth,
    )


def _frame(design, gear: str) -> FlankFrame:
    drive, external = design.drive, gear == "flexible_spline"
    return FlankFrame(
        n_teeth=drive.teeth_fs if external else drive.teeth_rg,
        module=drive.module,
        pressure_angle=float(np.radians(drive.pressure_angle)),
        addendum=drive.addendum_coef * drive.module,
        dedendum=drive.dedendum_coef * drive.module,
        c_P=getattr(design, gear).c_P,
        external=external,
    )


def make_profile(design, gear: str) -> ToothProfile:
    """Flank of `gear` ("flexible_spline" or "ring_gear") of a design."""
    spec, name = getattr(design, gear), f"{gear}.profile"
    p = spec.profile
    if isinstance(p, QuadrupleArc):
        profile = quadruple_arc(
            _frame(design, gear), spec.c_l, p.r_tip, p.r_addendum, p.straight_l, p.r_dedendum, p.r_root, name
        )
    elif isinstance(p, DoubleArc):
        profile = double_arc(_frame(design, gear), spec.c_l, p.r_addendum, p.r_dedendum, name)
    else:
        profile = involute(_cutter(design, gear), name)
    try:
        check_flank(profile)
    except InputError as error:
        sizes = ", ".join(f"{key} = {show(value)}" for key, value in p if isinstance(value, float))
        raise InputError(
            f"{name} with {sizes} cannot be built: {error}; allowed are arcs and cutters that stay inside the tooth"
        ) from None
    return profile


__all__ = [
    "ExternalProfile",
    "InternalProfile",
    "RackInvolute",
    "ToothProfile",
    "make_profile",
]
