"""The quadruple-circular-arc (QCA) flank: tip, addendum, straight, dedendum and root (section 3.3.3).

Tooth centred on +y, flank at x > 0; s = +1 for external, -1 for internal teeth. With the outward normal
n(beta) = (cos beta, s sin beta), the pitch point P and the pressure angle at it alpha* = alpha - s alpha_P:

    O_a = P_a - r_a n(alpha*),  O_t = O_a + (r_a - r_t) n(alpha* + alpha_a),  |O_t| + s r_t = r_A
    O_d = P_d + r_d n(alpha*),  O_r = O_d - (r_d - r_r) n(alpha* + alpha_d),  |O_r| - s r_r = r_D
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from swgpar.errors import InputError
from swgpar.profiles.curve import Segment, ToothProfile


def _close(radius, wanted: float, what: str) -> float:
    """Angle in (0, pi/2) where `radius` meets `wanted`; refuses when there is none."""
    low, high = 0.0, 0.5 * np.pi
    if (radius(low) - wanted) * (radius(high) - wanted) > 0.0:
        raise InputError(f"{what}: allowed are radii for which the arcs close on the addendum and dedendum circles")
    return float(brentq(lambda angle: radius(angle) - wanted, low, high, xtol=1e-15, rtol=1e-15))


def quadruple_arc(
    n_teeth: int,
    module: float,
    pressure_angle: float,
    addendum: float,
    dedendum: float,
    c_P: float,
    c_l: float,
    r_tip: float,
    r_addendum: float,
    straight_l: float,
    r_dedendum: float,
    r_root: float,
    external: bool,
    name: str = "profile",
) -> ToothProfile:
    """Build the flank; lengths in mm, `pressure_angle` in rad, `addendum` and `dedendum` are heights in mm."""
    s = 1.0 if external else -1.0
    r_pitch = 0.5 * n_teeth * module
    half = 0.5 * c_P * np.pi / n_teeth
    star = pressure_angle - s * half
    r_a, r_d = r_pitch + s * addendum, r_pitch - s * dedendum

    def n(beta: float) -> np.ndarray:
        return np.array([np.cos(beta), s * np.sin(beta)])

    def beta_of(direction: np.ndarray) -> float:
        return float(np.arctan2(s * direction[1], direction[0]))

    def tangent(beta: float) -> float:
        return beta - 0.5 * np.pi if external else 0.5 * np.pi - beta

    pitch = r_pitch * np.array([np.sin(half), np.cos(half)])
    up = np.array([-np.sin(star), s * np.cos(star)])
    top, bottom = pitch + c_l * straight_l * up, pitch - (1.0 - c_l) * straight_l * up
    o_a, o_d = top - r_addendum * n(star), bottom + r_dedendum * n(star)

    def tip_center(angle: float) -> np.ndarray:
        return o_a + (r_addendum - r_tip) * n(star + angle)

    def root_center(angle: float) -> np.ndarray:
        return o_d - (r_dedendum - r_root) * n(star + angle)

    a_a = _close(
        lambda t: float(np.hypot(*tip_center(t))) + s * r_tip,
        r_a,
        f"{name}.r_tip = {r_tip:g} with r_addendum = {r_addendum:g} cannot close",
    )
    a_d = _close(
        lambda t: float(np.hypot(*root_center(t))) - s * r_root,
        r_d,
        f"{name}.r_root = {r_root:g} with r_dedendum = {r_dedendum:g} cannot close",
    )
    o_t, o_r = tip_center(a_a), root_center(a_d)
    beta_t, beta_r = beta_of(s * o_t / np.hypot(*o_t)), beta_of(s * o_r / np.hypot(*o_r))
    turn = -s
    pieces = [
        ("tip", o_t + r_tip * n(beta_t), beta_t, turn / r_tip, r_tip * (beta_t - star - a_a)),
        ("addendum", o_a + r_addendum * n(star + a_a), star + a_a, turn / r_addendum, r_addendum * a_a),
        ("straight", top, star, 0.0, straight_l),
        ("dedendum", bottom, star, -turn / r_dedendum, r_dedendum * a_d),
        ("root", o_r - r_root * n(star + a_d), star + a_d, -turn / r_root, r_root * (beta_r - star - a_d)),
    ]
    for piece, *_, length in pieces:
        if length < 0.0:
            raise InputError(
                f"{name}.r_{piece}: the {piece} arc would have a negative length ({length:.3g} mm); "
                "allowed are radii for which all arcs run from tip to root"
            )
    segments = tuple(
        Segment(k, (float(p[0]), float(p[1])), tangent(b), t, float(length))
        for k, p, b, t, length in pieces
        if length > 1e-12 * module
    )
    return ToothProfile(segments, external, r_a, r_d, n_teeth)
