"""Cycloid teeth: epicycloids outside of the pitch circle, hypocycloids inside of it.

A circle of the radius rho rolls on the pitch circle r. With the angle u of the place where they
touch, a point of it moves on

    z = c exp(i u) - (c / k) exp(i k u),   c = r + rho, k = c / rho outside,
                                           c = r - rho, k = -c / rho inside,

from r on the x-axis [F. L. Litvin, A. Fuentes, Gear Geometry and Applied Theory, Cambridge 2004].
Rolling circles of the same radius make flanks of two gears that touch while the pitch circles roll
on each other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.geometry.arrays import Floats
from swgpar.input.require import require
from swgpar.profiles.ends import with_ends
from swgpar.profiles.flank import ToothProfile
from swgpar.profiles.keys import Cycloid
from swgpar.profiles.teeth import Teeth
from swgpar.profiles.two_curves import GAP, Derivatives, two_curves

LAST = 0.98 * np.pi
"""Rotation (rad) of a rolling circle at which the curve ends: at pi it would turn back."""

REACH = 1.0 - np.cos(LAST)
"""Height of a curve over the radius of its rolling circle, of pitch circles that are not small."""


@dataclass(frozen=True)
class _Rolled:
    """Curve of a circle that rolls on the pitch circle r, from the pitch point.

    rho : mm, its radius, below 0 inside of the pitch circle
    side : +1 towards the centre line of the tooth, -1 away from it
    """

    pitch_point: complex
    rho: float
    side: float

    def __call__(self, phi: Floats) -> Derivatives:
        """By the rotation (n,) rad of the circle relative to the line of centres."""
        r = abs(self.pitch_point)
        c, rate = r + self.rho, self.side * abs(self.rho) / r
        k = c / self.rho
        one, many = np.exp(1j * rate * phi), np.exp(1j * k * rate * phi)
        first, at = 1j * rate * c / r, self.pitch_point
        return (
            at * (c * one - c / k * many) / r,
            at * first * (one - many),
            at * 1j * rate * first * (one - k * many),
        )

    def first(self, height: float) -> float:
        """Rotation (rad) of the circle at about a height (mm) over the pitch circle."""
        return float(np.arccos(1.0 - height / abs(self.rho)))


def cycloid(keys: Cycloid, teeth: Teeth, name: str = "profile") -> ToothProfile:
    """Build the flank of teeth that are as thick as the spaces at the pitch circle.

    name : section of the design file, for messages. Raises InputError for rolling circles that do
    not reach the circles of the teeth, and for arcs that do not fit.
    """
    r, gap = teeth.r_pitch, GAP * teeth.module
    pitch_point = 1j * r * np.exp(-0.5j * np.pi / teeth.n_teeth)
    curves: dict[float, _Rolled] = {}
    for side, height in ((1.0, teeth.addendum), (-1.0, teeth.dedendum)):
        outside = (side > 0.0) == teeth.external
        key = "r_epicycloid" if outside else "r_hypocycloid"
        value, least = getattr(keys, key), max(height / REACH, gap)
        if outside:
            require(value >= least, f"{name}.{key}", value, f"{least:.6g} mm and more")
        else:
            allowed = f"{least:.6g} to {0.5 * r:.6g} mm (half of the pitch radius)"
            require(least <= value <= 0.5 * r, f"{name}.{key}", value, allowed)
        curves[side] = _Rolled(pitch_point, value if outside else -value, side)
    convex, concave = curves[1.0], curves[-1.0]
    upper, lower = ((each.first(gap), LAST) for each in (convex, concave))
    curve = two_curves(convex, concave, upper, lower, teeth)
    return with_ends(curve, teeth.module, keys.r_tip, keys.r_root, name)
