"""Parabolic cam (section 3.2.3) and its asymmetric kinds (section 5.7).

Each quarter is a parabola y = a - a_p x^2 up to |x| = C_p b, a connector arc r_c tangent to it, and
a lateral arc tangent to that, with its centre on the minor axis and its end at (b, 0). With n the
normal at the parabola's end P,

    c = P - r_c n (eq. 3.8),  c - (r_l - r_c) (cos alpha, sin alpha) = (b - r_l, 0)  (eqs 3.9-3.11).

The two components give r_l - r_c = c_y / sin alpha and tan(alpha / 2) = (b - r_c - c_x) / c_y: the
source's nonlinear equation for the aperture alpha of the lateral arc has this closed solution.

The lower lobe is the upper one rotated by 180 degrees. "Right" is x > 0 on the upper lobe; the cam
turns counter-clockwise, so the left side of a lobe leads.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.errors import InputError
from swgpar.geometry.cams.piecewise import Circle, Parabola, PiecewiseCam
from swgpar.input.require import require


@dataclass(frozen=True)
class Side:
    """One side of a lobe: parabola coefficient a_p (1/mm), length C_p (of b), connector r_c (mm).

    `name` is that of its section in the design file.
    """

    a_p: float
    C_p: float
    r_c: float
    name: str = "wave_generator"


@dataclass(frozen=True)
class Quarter:
    """Solved right quarter: ends of the connector arc, mm; angles of the normals there, rad."""

    start: np.ndarray
    end: np.ndarray
    alpha: float
    theta: float
    connector: Circle
    lateral: Circle


def solve_quarter(parabola: Parabola, b: float, side: Side) -> Quarter:
    """Arcs from the parabola's end at x = C_p b to (b, 0), mm; refuses when there are none."""
    name, C_p, r_c = side.name, side.C_p, side.r_c
    end, normal = parabola.at(C_p * b)
    theta = float(np.arctan2(normal[1], normal[0]))
    # alpha < theta, that is a connector of positive length, does not depend on r_c: it is a matter
    # of the end alone
    if not 0.0 < b - end[0] < end[1] * np.tan(0.5 * theta):
        raise InputError(
            f"{name}.a_p = {parabola.p:g} with {name}.C_p = {C_p:g} cannot be closed at the minor "
            "axis: allowed are a smaller a_p or another C_p, so that the parabola ends above the "
            "connector's reach and inside b"
        )
    limit = (b - end[0]) / (1.0 - np.cos(theta))
    where = "where the connector arc passes the minor semi-axis"
    require(r_c < limit, f"{name}.r_c", r_c, f"above 0 to below {limit:.6g} mm, {where}")
    center = end - r_c * normal
    alpha = float(2.0 * np.arctan2(b - r_c - center[0], center[1]))
    radius = r_c + center[1] / np.sin(alpha)
    start = center + r_c * np.array([np.cos(alpha), np.sin(alpha)])
    connector = Circle((float(center[0]), float(center[1])), r_c)
    return Quarter(start, end, alpha, theta, connector, Circle((b - radius, 0.0), radius))


def parabolic(a: float, b: float, right: Side, left: Side, tilt: float = 0.0) -> PiecewiseCam:
    """Parabolic cam with semi-axes a (along y) and b, mm; `tilt` (rad) about the apexes."""
    r = solve_quarter(Parabola(a, right.a_p, tilt), b, right)
    # the left side is the mirror image of a right side with the opposite tilt
    m = solve_quarter(Parabola(a, left.a_p, -tilt), b, left)
    mirror = np.array([-1.0, 1.0])
    connector, lateral = (
        Circle((-arc.center[0], arc.center[1]), arc.radius) for arc in (m.connector, m.lateral)
    )
    pieces = (
        r.lateral,
        r.connector,
        Parabola(a, right.a_p, tilt),
        Parabola(a, left.a_p, tilt),
        connector,
        lateral,
    )
    joints = np.array([r.start, r.end, (0.0, a), m.end * mirror, m.start * mirror])
    angles = np.array([r.alpha, r.theta, 0.5 * np.pi + tilt, np.pi - m.theta, np.pi - m.alpha])
    return PiecewiseCam(pieces, joints, np.column_stack([-np.sin(angles), np.cos(angles)]))
