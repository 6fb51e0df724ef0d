"""Tip relief of any flank: its upper part turned towards the centre line of the tooth.

A point at the radius r is turned about the axis by

    delta(r) = c / r_A (|r - r_b| / h)^2,  r_b = r_A -+ h,

from nothing at r_b to the relief c along the addendum circle r_A. Radii stay what they are, so that
a flank that is tangent to the addendum circle remains so.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from swgpar.errors import InputError
from swgpar.geometry.arrays import Floats, as_complex, as_points
from swgpar.geometry.bracketed_root import root_between
from swgpar.input.require import require
from swgpar.profiles.curved_segment import CurvedSegment, CurvePoints
from swgpar.profiles.fitted_curve import fitted
from swgpar.profiles.flank import FlankSegment, ToothProfile, check_flank

STEP = 1e-3
"""Share of a relief that is refused to which the largest one is found."""


def _turned(segment: FlankSegment, end: float, turn: float, base: float) -> CurvedSegment:
    """A segment as far as the local arc length `end`, mm, turned about the axis by
    turn (r - base)^2.

    turn : rad / mm^2;  base : mm
    """

    def evaluate(t: Floats) -> CurvePoints:
        point, angle, curvature = segment.at(end * t)
        z, tangent = as_complex(point), np.exp(1j * angle)
        r = np.abs(z)
        # derivatives by arc length of the radius and of the angle of rotation
        slope = (np.conj(z) * tangent).real / r
        bend = (1.0 + (np.conj(z) * 1j * curvature * tangent).real - slope**2) / r
        above = r - base
        delta = turn * above**2
        rate = 2.0 * turn * above * slope
        change = 2.0 * turn * (slope**2 + above * bend)
        # of the turned curve, over the tangent of the given one and its rotation
        stretch = 1.0 + 1j * rate * z / tangent
        growth = (1j * change * z + rate * (1j * tangent + curvature * z)) / tangent
        turned = z * np.exp(1j * delta)
        return CurvePoints(
            as_points(turned),
            angle + delta + np.angle(stretch),
            end * np.abs(stretch),
            end * (curvature + rate + (growth / stretch).imag),
        )

    return fitted(CurvedSegment("tip" if segment.name == "tip" else "relief", evaluate))


@lru_cache(maxsize=32)
def relieved(profile: ToothProfile, relief: float, height: float, gear: str) -> ToothProfile:
    """The flank with a tip relief.

    relief : mm, of one flank along the addendum circle;  height : mm, of the relieved part
    gear : name of the gear's section, for messages

    Raises InputError where the relieved part reaches into the fillet, or leaves no top land.
    """
    if relief == 0.0:
        return profile
    outwards = profile.sign
    base = profile.r_tip_circle - outwards * height
    above_fillet = outwards * (profile.r_tip_circle - _radius(profile, profile.root_start))
    allowed = f"above 0 to below {above_fillet:.4g} mm (above the root), here {height:.4g} mm"
    require(height < above_fillet, f"{gear}.tip_relief_height", height, allowed)
    end = root_between(
        lambda s: outwards * (_radius(profile, s) - base), 0.0, profile.root_start, xtol=1e-13
    )
    try:
        return _turned_flank(profile, relief, height, end)
    except InputError as error:
        fits = _largest(lambda share: _turned_flank(profile, share * relief, height, end))
        raise InputError(
            f"{gear}.tip_relief = {relief:g} is out of range: allowed 0 to about "
            f"{fits * relief:.3g} mm ({error})"
        ) from None


def _turned_flank(profile: ToothProfile, relief: float, height: float, end: float) -> ToothProfile:
    """The flank with a tip relief up to the arc length `end` (mm); raises InputError where it is
    none."""
    turn = relief / profile.r_tip_circle / height**2
    base = profile.r_tip_circle - profile.sign * height
    segments: list[FlankSegment] = []
    for begin, segment in zip(profile.breaks[:-1], profile.segments, strict=True):
        inside = min(end - begin, segment.length)
        if inside > 1e-9 * profile.length:
            segments.append(_turned(segment, inside, turn, base))
        if segment.length - max(inside, 0.0) > 1e-9 * profile.length:
            whole = inside <= 0.0
            segments.append(segment if whole else segment.part(inside, segment.length))
    changed = replace(profile, segments=tuple(segments))
    check_flank(changed, corners=profile.has_corners)
    return changed


def _largest(make: Callable[[float], ToothProfile]) -> float:
    """Largest share of a relief, in steps of `STEP`, with which the flank can be made."""
    low, high = 0.0, 1.0
    while high - low > STEP:
        middle = 0.5 * (low + high)
        try:
            make(middle)
            low = middle
        except InputError:
            high = middle
    return low


def _radius(profile: ToothProfile, s: float) -> float:
    """Distance (mm) from the axis at the arc length s, mm."""
    return float(np.hypot(*profile.point(s)[0]))
