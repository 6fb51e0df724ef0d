"""Double arcs with a common tangent, given by the centres of their arcs.

In the frame with its origin on the pitch circle, x across the tooth from its centre line and y
towards its tip, the convex arc r_a has the centre O_1 = (-c_a, -e_a), the concave arc r_d the
centre O_2 = (pi m / 2 + c_d, e_d). Their common tangent with the normal n = (cos beta, sin beta)
out of the tooth touches them at O_1 + r_a n and O_2 - r_d n, so that

    (O_2 - O_1) . n = r_a + r_d.

Of its two solutions the one counts whose line leads from the convex arc down to the concave one.
"""

from __future__ import annotations

import numpy as np

from swgpar.errors import InputError
from swgpar.profiles.flank import ToothProfile
from swgpar.profiles.keys import CommonTangent
from swgpar.profiles.pitch_point import PitchPointFrame
from swgpar.profiles.quadruple_arc import root_arcs


def common_tangent(
    keys: CommonTangent, frame: PitchPointFrame, name: str = "profile"
) -> ToothProfile:
    """Build the flank: arc, tangent, arc, and the root arc down to the dedendum circle.

    name : section of the design file, for messages. Raises InputError where circles overlap, so
    that they have no such tangent, and where an arc does not reach its circle.
    """
    s, n = frame.sign, frame.normal
    r_a, r_d, r_r = keys.r_addendum, keys.r_dedendum, keys.r_root
    o_a = np.array([-keys.c_addendum, frame.r_pitch - s * keys.e_addendum])
    half_pitch = 0.5 * np.pi * frame.module
    o_d = np.array([half_pitch + keys.c_dedendum, frame.r_pitch + s * keys.e_dedendum])
    across, up = o_d[0] - o_a[0], s * (o_d[1] - o_a[1])
    apart = float(np.hypot(across, up))
    if apart < r_a + r_d:
        raise InputError(
            f"{name}.r_addendum = {r_a:g} with r_dedendum = {r_d:g}: the arcs have no common "
            f"tangent: allowed are radii whose sum is up to {apart:.6g} mm, the distance of the "
            "centres"
        )
    beta = float(np.arctan2(up, across) + np.arccos((r_a + r_d) / apart))
    top, bottom = o_a + r_a * n(beta), o_d - r_d * n(beta)
    length = float(np.sqrt(apart**2 - (r_a + r_d) ** 2))
    beta_t = frame.tip_inclination(o_a, r_a, f"{name}.r_addendum")
    pieces = [
        ("addendum", o_a + r_a * n(beta_t), beta_t, 1.0 / r_a, r_a * (beta_t - beta)),
        ("straight", top, beta, 0.0, length),
        *root_arcs(frame, bottom, beta, r_d, r_r, name),
    ]
    return frame.profile(pieces, name)
