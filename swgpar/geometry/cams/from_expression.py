"""Cams whose radius is an expression of the polar angle."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from swgpar.errors import InputError
from swgpar.geometry.cams.expression import FUNCTIONS, PolarExpression
from swgpar.geometry.cams.keys import Polar
from swgpar.geometry.cams.polar import PolarCam, mirrored_lobe
from swgpar.input.quantities import show
from swgpar.input.require import require

STEPS = 2048
"""Intervals of the curve in half a lobe."""

NAMES = ("theta", "pi", "a", "b", *FUNCTIONS)
"""Names that parameters may not have."""

OFF_TIP = 1e-6
"""Largest difference of the radius at the tip from the major semi-axis, over it."""

JUMP, KINK = 1e-6, 2e-3
"""Largest jump of the radius over it, and of the direction (rad)."""


@lru_cache(maxsize=16)
def expression_cam(keys: Polar, a: float, b: float, name: str = "wave_generator") -> PolarCam:
    """Curve of the section [wave_generator]; semi-axes in mm.

    Raises InputError where the expression is not in its language, or its curve is not smooth.
    """
    for parameter, value in keys.parameters.items():
        allowed = f"other names than {', '.join(NAMES)}, of letters, digits and underscores"
        fits = parameter.isidentifier() and parameter not in NAMES
        require(fits, f"{name}.parameters.{parameter}", value, allowed)
    key = f"{name}.radius"
    expression = PolarExpression(keys.radius, {"a": a, "b": b, **keys.parameters}, key)
    theta = np.linspace(0.0, np.pi / keys.lobes, STEPS + 1)
    half = np.stack(expression(theta))
    good = np.isfinite(half).all(axis=0) & (half[0] > 0.0)
    if not good.all():
        at = int(np.argmin(good))
        raise InputError(
            f"{key} gives the radius {half[0, at]:.4g} mm with the slope {half[1, at]:.4g} at "
            f"{np.degrees(theta[at]):.4g} degrees: allowed are finite values above 0"
        )
    if abs(half[0, 0] - a) > OFF_TIP * a:
        raise InputError(
            f"{key} gives {half[0, 0]:.7g} mm at the tip of a lobe, where the major semi-axis is "
            f"{a:.7g} mm: allowed are expressions with a = {a:.7g}, or another "
            f"{name}.major_axis, {2.0 * half[0, 0]:.7g}"
        )
    _require_smooth(half, theta, key)
    half[1, [0, -1]] = 0.0
    cam = PolarCam(mirrored_lobe(half), keys.lobes, 0.0)
    middle = 0.5 * (theta[1:] + theta[:-1])
    deviation = float(np.abs(cam.radius(middle)[0] - expression(middle).value).max())
    return PolarCam(cam.values, keys.lobes, deviation)


def _require_smooth(half: np.ndarray, theta: np.ndarray, key: str) -> None:
    """Refuse steps and kinks between the angles, and at both ends, where the mirror image
    follows."""
    step, mean = theta[1] - theta[0], half[0].mean()
    jump = np.abs(np.diff(half[0]) - 0.5 * step * (half[1, 1:] + half[1, :-1]))
    kink = np.abs(np.diff(half[1]) - 0.5 * step * (half[2, 1:] + half[2, :-1]))
    kink = np.concatenate([2.0 * np.abs(half[1, :1]), kink, 2.0 * np.abs(half[1, -1:])])
    if jump.max() > JUMP * mean:
        at = np.degrees(theta[jump.argmax()])
        raise InputError(
            f"{key} has a step of {jump.max():.3g} mm at {at:.4g} degrees: allowed are smooth "
            "curves"
        )
    if kink.max() > KINK * mean:
        at = np.degrees(theta[min(int(kink.argmax()), len(theta) - 1)])
        raise InputError(
            f"{key} has a kink of {np.degrees(kink.max() / mean):.3g} degrees at {at:.4g} degrees "
            f"from the tip of a lobe: allowed are smooth curves, {show('theta')} from the tip to "
            "midway between two lobes, with mirror images at both ends"
        )
