"""The quadruple-circular-arc (QCA) flank: tip, addendum, straight, dedendum, root (section 3.3.3).

With s = +1 for external and -1 for internal teeth, normals n and alpha* of `PitchPointFrame` at P:

    O_a = P_a - r_a n(alpha*),  O_t = O_a + (r_a - r_t) n(alpha* + alpha_a),  |O_t| + s r_t = r_A
    O_d = P_d + r_d n(alpha*),  O_r = O_d - (r_d - r_r) n(alpha* + alpha_d),  |O_r| - s r_r = r_D
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from swgpar.errors import InputError
from swgpar.geometry.bracketed_root import root_between
from swgpar.profiles.flank import ToothProfile
from swgpar.profiles.pitch_point import PitchPointFrame, PlacedSegment

Radius = Callable[[Any], Any]
"""A radius (mm) at one angle or at many (rad), of the same shape."""


def closing_angle(radius: Radius, target: float, refusal: str) -> float:
    """Smallest angle in (0, pi/2) at which `radius` (mm) is `target`; else InputError(`refusal`).

    Long arcs reach their circle twice: `radius` has one extremum in between.
    """
    angles = np.linspace(0.0, 0.5 * np.pi, 91)
    side = np.sign(radius(angles) - target)
    crossed = np.flatnonzero(side[1:] != side[:-1])
    if len(crossed) == 0:
        raise InputError(refusal)
    low, high = angles[crossed[0] : crossed[0] + 2]
    return float(root_between(lambda angle: radius(angle) - target, low, high, xtol=1e-15))


def root_arcs(
    frame: PitchPointFrame,
    bottom: np.ndarray,
    beta: float,
    r_dedendum: float,
    r_root: float,
    name: str,
) -> list[PlacedSegment]:
    """The dedendum arc, and the root arc that leads it to the dedendum circle; radii in mm.

    bottom : (2,) mm, where the dedendum arc begins;  beta : rad, inclination of the normal there
    name : section of the design file, for messages
    """
    o_d = bottom + r_dedendum * frame.normal(beta)

    def root_center(angle: Any) -> np.ndarray:
        return (o_d - (r_dedendum - r_root) * frame.normal(beta + angle).T).T

    a_d = closing_angle(
        lambda angle: np.hypot(*root_center(angle)) - frame.sign * r_root,
        frame.r_root_circle,
        f"{name}.r_root = {r_root:g} with r_dedendum = {r_dedendum:g} does not meet the dedendum "
        f"circle",
    )
    o_r, joint = root_center(a_d), beta + a_d
    lower, length = o_r - r_root * frame.normal(joint), r_root * (frame.inclination(o_r) - joint)
    return [
        ("dedendum", bottom, beta, -1.0 / r_dedendum, r_dedendum * a_d),
        ("root", lower, joint, -1.0 / r_root, length),
    ]


def quadruple_arc(
    frame: PitchPointFrame,
    c_l: float,
    r_tip: float,
    r_addendum: float,
    straight_l: float,
    r_dedendum: float,
    r_root: float,
    name: str = "profile",
) -> ToothProfile:
    """Build the flank; mm, `c_l` is the share of the straight segment above the pitch point."""
    s, star, n = frame.sign, frame.base_angle, frame.normal
    top, bottom = frame.straight(c_l, straight_l)
    o_a = top - r_addendum * n(star)

    def tip_center(angle: Any) -> np.ndarray:
        return (o_a + (r_addendum - r_tip) * n(star + angle).T).T

    ends = ("tip", "addendum", r_tip, r_addendum), ("root", "dedendum", r_root, r_dedendum)
    for end, side, last, first in ends:
        if last == first:
            raise InputError(
                f"{name}.r_{end} = {last:g} equals r_{side}, so that one arc would lead from "
                f"the straight flank to the {side} circle: allowed are two different radii, or "
                'type = "trapezoid", a straight flank with one arc at either end'
            )
    a_a = closing_angle(
        lambda t: np.hypot(*tip_center(t)) + s * r_tip,
        frame.r_tip_circle,
        f"{name}.r_tip = {r_tip:g} with r_addendum = {r_addendum:g} does not meet the addendum "
        f"circle",
    )
    o_t = tip_center(a_a)
    beta_t, upper = frame.inclination(o_t), o_a + r_addendum * n(star + a_a)
    pieces = [
        ("tip", o_t + r_tip * n(beta_t), beta_t, 1.0 / r_tip, r_tip * (beta_t - star - a_a)),
        ("addendum", upper, star + a_a, 1.0 / r_addendum, r_addendum * a_a),
        ("straight", top, star, 0.0, straight_l),
        *root_arcs(frame, bottom, star, r_dedendum, r_root, name),
    ]
    return frame.profile(pieces, name)
