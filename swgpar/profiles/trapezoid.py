"""Trapezoidal teeth: a straight flank between a tip edge and a root arc.

The line passes through the pitch point P with the normal n(alpha*) of `PitchPointFrame`. With the
tangent t towards the tip, arcs of the radius r that touch the line at P + x t have the centres

    O_t = P + x t - r_t n,  |O_t| + s r_t = r_A,     O_r = P + x t + r_r n,  |O_r| - s r_r = r_D.

Both are quadratic equations for x. With r_t = 0 the line meets the addendum circle at an edge.
"""

from __future__ import annotations

import math

from swgpar.errors import InputError
from swgpar.profiles.flank import ToothProfile
from swgpar.profiles.pitch_point import PitchPointFrame


def trapezoid(
    frame: PitchPointFrame, r_tip: float, r_root: float, name: str = "profile"
) -> ToothProfile:
    """Build the flank; radii of the tip and the root arc, mm.

    name : section of the design file, for messages. Raises InputError where no line is left
    between the arcs.
    """
    s, star, t = frame.sign, frame.base_angle, frame.towards_tip
    normal = frame.normal(star)
    top = frame.reach(frame.pitch_point - r_tip * normal, frame.r_tip_circle - s * r_tip)
    bottom = frame.reach(frame.pitch_point + r_root * normal, frame.r_root_circle + s * r_root)
    for key, place in (("r_tip", top), ("r_root", bottom)):
        if math.isnan(place):
            raise InputError(f"{name}.{key}: the straight flank does not reach its circle")
    if top <= bottom:
        raise InputError(
            f"{name}.r_tip = {r_tip:g} with r_root = {r_root:g} leaves no straight flank between "
            "the arcs"
        )
    upper, lower = frame.pitch_point + top * t, frame.pitch_point + bottom * t
    o_t, o_r = upper - r_tip * normal, lower + r_root * normal
    pieces = [
        ("straight", upper, star, 0.0, top - bottom),
        ("root", lower, star, -1.0 / r_root, r_root * (frame.inclination(o_r) - star)),
    ]
    if r_tip > 0.0:
        beta = frame.inclination(o_t)
        start = o_t + r_tip * frame.normal(beta)
        pieces.insert(0, ("tip", start, beta, 1.0 / r_tip, r_tip * (beta - star)))
    return frame.profile(pieces, name)
