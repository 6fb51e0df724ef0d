"""S-shaped teeth: the path of a tooth in its slot at half scale [Ishikawa, US patent 4,823,638].

With a rack in place of the gears a tooth of the flexible spline moves in its slot by

    X(theta) = D / n (theta - kappa sin theta),     Y(theta) = D kappa cos theta.

theta is the angle from the major axis times the number n of lobes, D the distance of the pitch
circles, kappa = w0 / D. The face of a tooth is its mapping at half scale. In x across the tooth
from its centre line and h towards the tip from the pitch circle, for both gears,

    x = pi m / 4 - X / 2,   h = (D - Y) / 2.

A point of the face, moved by the path, lies on the face of the other gear, with the same tangent:
faces touch from where the path is steepest, cos theta_0 = kappa. Below, the flank is the envelope
of the other gear's face between there and the major axis: a point theta of that face touches it
where the path has the same direction, at

    theta_p = 2 arctan((1 - kappa cos theta) / (kappa sin theta)) - theta,

so that x = pi m / 4 + X / 2 - X(theta_p), h = (D + Y) / 2 - Y(theta_p). For kappa = 1 this is the
image of the face in the pitch point. For kappa > 1 the path has a loop.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from swgpar.geometry.arrays import Floats
from swgpar.geometry.bracketed_root import root_between
from swgpar.input.require import require
from swgpar.profiles.ends import with_ends
from swgpar.profiles.flank import ToothProfile
from swgpar.profiles.keys import SShaped
from swgpar.profiles.teeth import Teeth
from swgpar.profiles.two_curves import GAP, Derivatives, two_curves

LAST = 0.98 * np.pi
"""Angle theta (rad) at which the curves end: at pi they would turn back."""

LEAST = 0.6
"""Deflection over the distance of the pitch circles: below, the path is flatter than 34 degrees."""


@dataclass(frozen=True)
class RackPath:
    """Path of a tooth of the flexible spline in its slot, of racks in place of the gears.

    module : mm;  lobes : of the cam
    apart : mm, distance D of the pitch circles
    deflection : mm, radial, w0
    """

    module: float
    lobes: int
    apart: float
    deflection: float

    @property
    def kappa(self) -> float:
        """Deflection over the distance of the pitch circles."""
        return self.deflection / self.apart

    @property
    def steepest(self) -> float:
        """Angle theta_0 (rad) at which the path is steepest; beyond it the faces touch."""
        return float(np.arccos(self.kappa))

    def points(self, theta: Floats) -> Derivatives:
        """Path X + i Y (n,) mm at angles theta (n,) rad, and its derivatives by them."""
        across, up = self.apart / self.lobes, 1j * self.apart * self.kappa
        c, s, kappa = np.cos(theta), np.sin(theta), self.kappa
        return (
            across * (theta - kappa * s) + up * c,
            across * (1.0 - kappa * c) - up * s,
            across * kappa * s - up * c,
        )

    @property
    def _origin(self) -> complex:
        return 0.25 * np.pi * self.module + 0.5j * self.apart

    def face(self, theta: Floats) -> Derivatives:
        """Face x + i h (n,) mm of both gears at angles theta (n,) rad, and its derivatives."""
        path, first, second = self.points(theta)
        return self._origin - 0.5 * path, -0.5 * first, -0.5 * second

    def flank(self, theta: Floats) -> Derivatives:
        """Flank below the face, touched by the points theta (n,) rad of the other gear's face."""
        path, first, second = self.points(theta)
        kappa, c, s = self.kappa, np.cos(theta), np.sin(theta)
        touch = 2.0 * np.arctan2(1.0 - kappa * c, kappa * s) - theta
        # 0 where theta_0 = 0
        square = np.maximum(1.0 + kappa**2 - 2.0 * kappa * c, 1e-300)
        rate = (kappa**2 - 1.0) / square
        change = -2.0 * kappa * s * rate / square
        there, along, bend = self.points(touch)
        return (
            self._origin + 0.5 * path - there,
            0.5 * first - rate * along,
            0.5 * second - rate**2 * bend - change * along,
        )


def s_shaped(keys: SShaped, teeth: Teeth, path: RackPath, name: str = "profile") -> ToothProfile:
    """Build the flank; faces touch along `path`, of the drive, or of the deflection of `keys`.

    name : section of the design file, for messages. Raises InputError for teeth that are higher
    than the path, and for arcs that do not fit.
    """
    if keys.deflection is not None:
        path = replace(path, deflection=keys.deflection)
    key = f"{name}.deflection"
    if keys.deflection is None:
        key = "wave_generator.deflection"
    allowed = (
        f'{LEAST * path.apart:g} to {path.apart:g} mm with {name}.type = "s_shaped" (the distance '
        f"of the pitch circles); {name}.deflection may differ from it"
    )
    require(LEAST <= path.kappa <= 1.0, key, path.deflection, allowed)
    gear, module = name.rpartition(".")[0], path.module
    spans: list[tuple[float, float]] = []
    for part, side, key, height in (
        (path.face, 1.0, "addendum_coef", teeth.addendum),
        (path.flank, -1.0, "dedendum_coef", teeth.dedendum),
    ):
        begin, end = (_height(part, theta) for theta in (path.steepest, LAST))
        allowed = f'up to {side * end / module:.4g} modules with {name}.type = "s_shaped"'
        require(height <= side * end, f"{gear}.{key}", height / module, allowed)
        near = begin + side * GAP * module
        spans.append((_at_height(part, near, path.steepest), LAST))
    face, flank = (partial(_placed, each, teeth) for each in (path.face, path.flank))
    upper, lower = spans
    curve = two_curves(face, flank, upper, lower, teeth)
    return with_ends(curve, module, keys.r_tip, keys.r_root, name)


def _height(curve: Callable[[Floats], Derivatives], theta: float) -> float:
    """Height (mm) over the pitch circle, towards the tip, at theta, rad."""
    return float(curve(np.array([theta]))[0][0].imag)


def _at_height(curve: Callable[[Floats], Derivatives], height: float, low: float) -> float:
    """Angle theta (rad) above `low` at which a curve has a height, mm."""
    return root_between(lambda theta: _height(curve, theta) - height, low, LAST)


def _placed(curve: Callable[[Floats], Derivatives], teeth: Teeth, theta: Floats) -> Derivatives:
    """Curve x + i h on a tooth centred on +y, at angles theta (n,) rad."""
    z, first, second = (each if teeth.external else np.conj(each) for each in curve(theta))
    return z + 1j * teeth.r_pitch, first, second
