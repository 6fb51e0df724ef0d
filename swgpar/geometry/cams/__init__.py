"""Exact cam curves of wave generators (section 3.2).

To add a cam, see docs/developer/add_a_cam.md.
"""

from __future__ import annotations

import numpy as np
import scipy

from swgpar.geometry.arrays import as_complex
from swgpar.geometry.cams.arcs import arcs
from swgpar.geometry.cams.bearing_keys import Bearing
from swgpar.geometry.cams.curve import Cam
from swgpar.geometry.cams.elliptical import EllipticalCam
from swgpar.geometry.cams.from_expression import expression_cam
from swgpar.geometry.cams.from_points import points_cam
from swgpar.geometry.cams.harmonic import HarmonicCam
from swgpar.geometry.cams.keys import (
    Arcs,
    AsymmetricParabolic,
    CamPoints,
    Elliptical,
    FourRoller,
    Harmonic,
    Parabolic,
    Polar,
    Simplified,
    TwoRoller,
    WaveGenerator,
)
from swgpar.geometry.cams.offset import OffsetCam
from swgpar.geometry.cams.parabolic import Side, parabolic
from swgpar.geometry.cams.polar import PolarCam
from swgpar.geometry.cams.rollers import RollerCam, rollers
from swgpar.geometry.cams.semi_axes import roller_radius
from swgpar.geometry.cams.simplified import simplified

OUTLINE_POINTS = 5760
"""Of a cam: arcs and lines that join with a jump of curvature need them."""


def make_cam(
    keys: WaveGenerator, a: float, b: float | None = None, name: str = "wave_generator"
) -> Cam:
    """Curve of a cam, major axis along +y.

    keys : section [wave_generator] of the design file
    a : mm, major semi-axis (eq. 3.3)
    b : mm, minor semi-axis (eq. 3.4); of no use with rollers;  name : of the section, for messages

    Raises InputError where the keys give no closed curve, TypeError where they are those of no cam.
    """
    if keys.offset:
        curve = keys.model_copy(update={"offset": 0.0})
        within = None if b is None else b - keys.offset
        return OffsetCam(make_cam(curve, a - keys.offset, within, name), keys.offset)
    if isinstance(keys, FourRoller | TwoRoller):
        beta, key, beside = 0.0, "r_2", isinstance(keys, TwoRoller) and keys.distance > 0.0
        if isinstance(keys, FourRoller):
            beta, key = float(np.radians(keys.beta)), "r_4"
        radius, centred = roller_radius(keys), keys.centre_radius is not None
        name = f"{name}.{key}"
        return rollers(a - radius, beta, radius, name, centred=centred, beside=beside)
    if isinstance(keys, Elliptical):
        return EllipticalCam(a, b)
    if isinstance(keys, Harmonic):
        return HarmonicCam(a, b, keys.lobes)
    if isinstance(keys, Simplified):
        return simplified(a, b)
    if isinstance(keys, Arcs):
        return arcs(a, b, float(np.radians(keys.beta)), f"{name}.beta")
    if isinstance(keys, Parabolic):
        side = Side(keys.a_p, keys.C_p, keys.r_c, name)
        return parabolic(a, b, side, side)
    if isinstance(keys, AsymmetricParabolic):
        right = Side(keys.right.a_p, keys.right.C_p, keys.right.r_c, f"{name}.right")
        left = Side(keys.left.a_p, keys.left.C_p, keys.left.r_c, f"{name}.left")
        return parabolic(a, b, right, left, float(np.radians(keys.rotational_angle)))
    if isinstance(keys, Polar):
        return expression_cam(keys, a, b, name)
    if isinstance(keys, CamPoints):
        return points_cam(keys, name)
    raise TypeError(f"no curve for {type(keys).__name__}")


def cam_outlines(cam: Cam, count: int = OUTLINE_POINTS) -> list[np.ndarray]:
    """Closed curves of the cam of about `count` points in all, each (n, 2) mm without the first
    point again: one, or one for each roller."""
    parts = cam.count if isinstance(cam, RollerCam) else 1
    return list(cam.outline(count).reshape(parts, -1, 2))


STRAIGHT = 1e-9
"""Angle (rad) between sides of an outline that is round-off; the length changes by its square."""


def taut_length(cam: Cam, n: int = 7200) -> float:
    """Length of a band drawn tight around the cam, mm: the perimeter of its convex hull."""
    outline = cam.outline(n)
    side = as_complex(np.diff(outline, axis=0, append=outline[:1]))
    turned = np.angle(np.roll(side, -1) / side)
    turned *= np.sign(turned.sum())
    if (turned > -STRAIGHT).all() and turned.sum() < 3.0 * np.pi:  # it is its own hull
        return float(np.abs(side).sum())
    return float(scipy.spatial.ConvexHull(outline).area)


def pin_travel(cam: Cam, radius: float, lobes: int = 2) -> float:
    """How far the pins, each a lobe of the cam, are drawn in to fit into the circle `radius`.

    In mm; half the deflection for a cam that first touches at its tips, more when it bulges beside
    them (the pins of section 3.2 are the halves of the cam).
    """
    x, y = cam.outline(7200).T
    upper = (np.abs(np.arctan2(x, y)) < np.pi / lobes) & (np.abs(x) < radius)
    return float(np.max(y[upper] - np.sqrt(radius**2 - x[upper] ** 2)))


__all__ = [
    "Bearing",
    "Cam",
    "EllipticalCam",
    "FourRoller",
    "HarmonicCam",
    "OffsetCam",
    "PolarCam",
    "RollerCam",
    "TwoRoller",
    "WaveGenerator",
    "make_cam",
    "pin_travel",
    "taut_length",
]
