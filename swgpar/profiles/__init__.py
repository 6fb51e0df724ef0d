"""Exact tooth profiles. A new profile is a new file here and an entry in `make_profile`."""

from __future__ import annotations

import numpy as np

from swgpar.errors import InputError
from swgpar.profiles.curve import ToothProfile, check_flank
from swgpar.profiles.quadruple_arc import quadruple_arc


def make_profile(design, gear: str) -> ToothProfile:
    """Flank of `gear` ("flexible_spline" or "ring_gear") of a design."""
    drive, spec = design.drive, getattr(design, gear)
    external = gear == "flexible_spline"
    p = spec.profile
    profile = quadruple_arc(
        drive.teeth_fs if external else drive.teeth_rg,
        drive.module,
        np.radians(drive.pressure_angle),
        drive.addendum_coef * drive.module,
        drive.dedendum_coef * drive.module,
        spec.c_P,
        spec.c_l,
        p.r_tip,
        p.r_addendum,
        p.straight_l,
        p.r_dedendum,
        p.r_root,
        external,
        f"{gear}.profile",
    )
    try:
        check_flank(profile)
    except InputError as error:
        raise InputError(
            f"{gear}.profile cannot be built: {error}; allowed are arcs that stay inside the tooth"
        ) from None
    return profile


__all__ = ["ToothProfile", "make_profile"]
