"""The double-circular-arc (DCA) flank: addendum, straight and dedendum (section 3.3.2).

The dedendum arc is the fillet: it is tangent to the dedendum circle, |O_d| - s r_d = r_D with O_d =
P - (1 - c_l) l t + r_d n(alpha*), and this gives the length l of the straight segment (eq. 3.39).
The addendum arc runs to the addendum circle and meets it at an edge. Where the straight segment
reaches that circle there is no addendum arc.
"""

from __future__ import annotations

import numpy as np

from swgpar.errors import InputError
from swgpar.input.require import require
from swgpar.profiles.flank import ToothProfile
from swgpar.profiles.pitch_point import PitchPointFrame


def straight_length(
    frame: PitchPointFrame, c_l: float, r_dedendum: float, name: str = "profile"
) -> float:
    """Length l of the straight segment, mm; refuses radii that leave none."""
    key = f"{name.rpartition('.')[0]}.c_l"
    require(c_l < 1.0, key, c_l, "0 to below 1 with a double_arc profile")
    center = frame.pitch_point + r_dedendum * frame.normal(frame.base_angle)
    depth = -frame.reach(center, frame.r_root_circle + frame.sign * r_dedendum)
    if not depth >= 0.0:
        raise InputError(
            f"{name}.r_dedendum = {r_dedendum:g} leaves no straight segment between the arcs"
        )
    return depth / (1.0 - c_l)


def double_arc(
    frame: PitchPointFrame, c_l: float, r_addendum: float, r_dedendum: float, name: str = "profile"
) -> ToothProfile:
    """Build the flank; mm, `c_l` is the share of the straight segment above the pitch point."""
    length = straight_length(frame, c_l, r_dedendum, name)
    s, star, n = frame.sign, frame.base_angle, frame.normal
    top, bottom = frame.straight(c_l, length)
    o_a, o_d = top - r_addendum * n(star), bottom + r_dedendum * n(star)
    beta_r = frame.inclination(o_d)
    root = ("dedendum", bottom, star, -1.0 / r_dedendum, r_dedendum * (beta_r - star))
    if s * (float(np.hypot(*top)) - frame.r_tip_circle) >= -1e-12 * frame.module:
        # the straight segment reaches the addendum circle, and ends there
        beyond = frame.reach(top, frame.r_tip_circle)
        edge = top + beyond * frame.towards_tip
        return frame.profile([("straight", edge, star, 0.0, length + beyond), root], name)
    beta_t = frame.tip_inclination(o_a, r_addendum, f"{name}.r_addendum")
    tip = o_a + r_addendum * n(beta_t)
    pieces = [
        ("addendum", tip, beta_t, 1.0 / r_addendum, r_addendum * (beta_t - star)),
        ("straight", top, star, 0.0, length),
        root,
    ]
    return frame.profile(pieces, name)
