"""Schematics of the gear trains: bodies, springs, dampers, backlash, degrees of freedom and loads,
from the drivers."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from _drafting import (
    CAM,
    DRIVERS,
    INK,
    NOTE,
    RING,
    SPLINE,
    Point,
    angle_mark,
    arc,
    canvas,
    label,
    leader,
    run,
)
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from swgpar import load_design
from swgpar.gear_trains.cascade.design import PINIONS
from swgpar.gear_trains.gear_pair.design import GearPairDesign
from swgpar.gear_trains.planetary.design import PlanetaryDesign
from swgpar.gear_trains.ring.design import RingDesign

WIRE: dict[str, Any] = {"color": INK, "lw": 1.0, "solid_capstyle": "butt"}


def local(start: Point, end: Point) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Start, unit vector along, unit vector to the left, and length of the line between two
    points."""
    a, b = np.array(start, dtype=float), np.array(end, dtype=float)
    length = float(np.hypot(*(b - a)))
    along = (b - a) / length
    return a, along, np.array([-along[1], along[0]]), length


def path(
    ax: Axes,
    frame: tuple[np.ndarray, np.ndarray, np.ndarray, float],
    points: list[Point],
    **style: Any,
) -> None:
    """Line through points given along the frame's line (as parts of its length) and to its left."""
    a, along, left, length = frame
    xy = np.array([a + x * length * along + y * left for x, y in points])
    ax.plot(*xy.T, **{**WIRE, **style})


def spring(ax: Axes, start: Point, end: Point, width: float, coils: int = 4) -> None:
    """Spring between two points."""
    zigzag = [(0.25 + 0.5 * (k + 0.5) / (2 * coils), width * (-1.0) ** k) for k in range(2 * coils)]
    path(ax, local(start, end), [(0.0, 0.0), (0.25, 0.0), *zigzag, (0.75, 0.0), (1.0, 0.0)])


def damper(ax: Axes, start: Point, end: Point, width: float) -> None:
    """Dashpot between two points."""
    frame = local(start, end)
    path(ax, frame, [(0.0, 0.0), (0.4, 0.0)])
    path(ax, frame, [(0.65, width), (0.4, width), (0.4, -width), (0.65, -width)])
    path(ax, frame, [(0.55, 0.8 * width), (0.55, -0.8 * width)])
    path(ax, frame, [(0.55, 0.0), (1.0, 0.0)])


def backlash(ax: Axes, start: Point, end: Point, width: float) -> None:
    """Gap between two stops."""
    frame = local(start, end)
    path(ax, frame, [(0.0, 0.0), (0.35, 0.0)])
    path(ax, frame, [(0.35, width), (0.35, -width)])
    path(ax, frame, [(0.65, width), (0.65, -width)])
    path(ax, frame, [(0.65, 0.0), (1.0, 0.0)])


def mesh(ax: Axes, start: Point, end: Point, width: float) -> None:
    """Gear mesh: spring with backlash in series, and a damper parallel to both."""
    a, along, left, length = local(start, end)
    side = 1.5 * width * left
    p, q, middle = a + side, a + length * along + side, a + 0.6 * length * along + side
    spring(ax, tuple(p), tuple(middle), width, 3)
    backlash(ax, tuple(middle), tuple(q), width)
    damper(ax, tuple(a - side), tuple(a + length * along - side), width)
    for end_point in (a, a + length * along):
        ax.plot(*np.array([end_point - side, end_point + side]).T, **WIRE)


def ground(ax: Axes, at: Point, direction: float, width: float) -> None:
    """Hatched ground at a point; direction (degrees) points into the ground."""
    t = np.radians(direction)
    out, side = np.array([np.cos(t), np.sin(t)]), np.array([-np.sin(t), np.cos(t)])
    ax.plot(*np.array([at - width * side, at + width * side]).T, **{**WIRE, "lw": 1.5})
    for k in np.linspace(-0.9, 0.9, 6):
        ax.plot(
            *np.array(
                [at + k * width * side, at + (k - 0.25) * width * side + 0.35 * width * out]
            ).T,
            **WIRE,
        )


def arrow(ax: Axes, start: Point, end: Point, color: str = NOTE) -> None:
    """Force, or direction of a coordinate."""
    style = {
        "arrowstyle": "-|>",
        "color": color,
        "lw": 1.4,
        "shrinkA": 0,
        "shrinkB": 0,
        "mutation_scale": 10,
    }
    ax.annotate("", xy=end, xytext=start, arrowprops=style)


def body(ax: Axes, center: Point, radius: float, color: str) -> None:
    """Gear as a disc with its centre."""
    ax.add_patch(Circle(center, radius, fc=color, ec=INK, lw=1.2, alpha=0.35))
    ax.plot(*center, "o", color=INK, ms=3)


def gear_pair() -> Figure:
    """Gear pair of drivers/gear_pair.toml, radii to scale; the line of action is vertical."""
    design = load_design(DRIVERS / "gear_pair.toml")
    assert isinstance(design, GearPairDesign)
    total = design.gear_1.radius + design.gear_2.radius
    r1, r2, gap = 3.4 * design.gear_1.radius / total, 3.4 * design.gear_2.radius / total, 1.5
    first, second = (0.0, r1 + 0.5 * gap), (r1 + r2, -r2 - 0.5 * gap)
    figure, ax = canvas(8.5, 8.0)
    top, bottom, x = first[1], second[1], 0.0 + r1
    body(ax, first, r1, SPLINE)
    body(ax, second, r2, CAM)
    # both pitch circles touch the line of action x = r1 with their sides
    ax.plot([x, x], [top, 0.55 * gap], color=INK, lw=0.8, ls="--")
    ax.plot([x, x], [-0.55 * gap, bottom], color=INK, lw=0.8, ls="--")
    mesh(ax, (x, 0.55 * gap), (x, -0.55 * gap), 0.16)
    for (cx, cy), sign in ((first, 1.0), (second, -1.0)):
        spring(ax, (cx, cy), (cx, cy + sign * 2.6), 0.16)
        ground(ax, (cx, cy + sign * 2.6), 90.0 * sign, 0.5)
    label(ax, (first[0] + 0.75, top + 2.0), "$k_{b1}$", color=INK)
    label(ax, (second[0] + 0.75, bottom - 2.0), "$k_{b2}$", color=INK)
    label(ax, (x + 0.8, 0.28), "mesh $k(t)$, $2b$", color=INK, ha="left")
    label(ax, (x - 0.6, -0.1), "$c$", color=INK)
    arrow(ax, (first[0] - 0.3, top + 0.9), (first[0] - 0.3, top))
    label(ax, (first[0] - 0.55, top + 0.6), "$y_1$")
    arrow(ax, (second[0] - 0.3, bottom + 0.9), (second[0] - 0.3, bottom))
    label(ax, (second[0] - 0.55, bottom + 0.6), "$y_2$")
    angle_mark(ax, first, 0.8 * r1, 230.0, 130.0, "$T_1$, $\\theta_1$", 1.5)
    angle_mark(ax, second, 0.8 * r2, 60.0, -30.0, "$T_2$", 0.85)
    angle_mark(ax, second, 0.8 * r2, 120.0, 200.0, "$\\theta_2$", 0.85)
    label(ax, (first[0], top - 0.45), "gear 1: $m_1$, $I_1$, $r_1$", color=INK)
    label(ax, (second[0], bottom - 0.45), "gear 2: $m_2$, $I_2$, $r_2$", color=INK)
    text = "mesh deflection $d = y_1 - y_2 + z$\n$z = r_1\\theta_1 - r_2\\theta_2$"
    label(ax, (x + 1.9, top + 1.0), text, color=INK, ha="left")
    ax.set_xlim(-r1 - 1.2, second[0] + r2 + 0.4)
    ax.set_ylim(bottom - 3.0, top + 3.0)
    return figure


def cascade() -> Figure:
    """Cascade gearbox: which gears mesh, and where the springs are; one side of two, and the common
    part."""
    figure, ax = canvas(11.5, 6.8)
    half = PINIONS // 2
    ax.add_patch(Rectangle((-1.0, -0.25), 2.2 * half + 1.3, 0.5, fc=RING, ec=INK, alpha=0.5))
    label(ax, (-0.55, 0.0), "rack", color=INK)
    arrow(ax, (-2.3, 0.0), (-1.05, 0.0))
    label(ax, (-1.9, 0.38), "force $F$, $x_0$ (direction B)")
    for k in range(half):
        x = 0.6 + 2.2 * k
        mesh(ax, (x, 0.25), (x, 1.15), 0.11)
        body(ax, (x, 1.5), 0.35, CAM)
        label(ax, (x - 0.62, 1.5), f"P{k + 1}", color=INK)
        spring(ax, (x, 1.85), (x, 2.95), 0.14)
        body(ax, (x, 3.5), 0.55, SPLINE)
        label(ax, (x, 3.85), f"G1,{k + 1}", color=INK, fontsize=7)
        if k % 2:
            mesh(ax, (x - 0.55, 3.5), (x - 1.65, 3.5), 0.11)
    leader(ax, (1.6, 2.4), "flexible unit", (0.75, 2.4), color=INK)
    leader(ax, (3.9, 2.4), "backlash of\ndirection B", (1.85, 3.25))
    g2 = (3.9, 5.0)
    g3 = (6.0, 5.0)
    g4 = (8.3, 5.0)
    wheel = (10.4, 5.0)
    for k, target in ((0, (3.45, 4.85)), (2, (4.0, 4.62))):
        mesh(
            ax, (0.6 + 2.2 * k + (0.45 if k == 0 else -0.25), 3.85 if k == 0 else 4.0), target, 0.11
        )
    for center, radius, name, color in (
        (g2, 0.4, "G2", CAM),
        (g3, 0.6, "G3", SPLINE),
        (g4, 0.4, "G4", CAM),
        (wheel, 0.85, "flywheel", RING),
    ):
        body(ax, center, radius, color)
        label(ax, (center[0], center[1] + radius + 0.22), name, color=INK)
    spring(ax, (4.3, 5.0), (5.4, 5.0), 0.14)
    mesh(ax, (6.6, 5.0), (7.9, 5.0), 0.13)
    spring(ax, (8.7, 5.0), (9.55, 5.0), 0.14)
    label(ax, (4.85, 5.4), "shaft", color=INK)
    label(ax, (9.12, 5.4), "shaft", color=INK)
    damper(ax, (10.4, 4.15), (10.4, 3.1), 0.16)
    ground(ax, (10.4, 3.1), -90.0, 0.45)
    label(ax, (11.3, 3.6), "generator", color=INK)
    mesh(ax, (8.3, 3.2), (8.3, 4.6), 0.13)
    label(ax, (8.9, 2.75), "G3 of the second side\n(pinions 5 to 8)", color=INK)
    mesh(ax, (8.9, 1.3), (8.9, 0.3), 0.12)
    label(ax, (9.3, 0.8), "mesh: stiffness $k(t)$ with backlash, damper", color=INK, ha="left")
    ax.set_xlim(-2.9, 12.6)
    ax.set_ylim(-0.5, 6.3)
    return figure


def ring() -> Figure:
    """Elastic ring of drivers/ring_moving_load.toml: elements, supports, moving loads and
    displacements."""
    design = load_design(DRIVERS / "ring_moving_load.toml")
    assert isinstance(design, RingDesign)
    elements, supports, loads = (
        design.ring.elements,
        design.supports.count,
        design.moving_load.loads,
    )
    assert design.elastic_ring().size == 3 * elements
    figure, ax = canvas(8.0, 8.0)
    radius, rim = 3.0, 0.16
    for r in (radius - rim, radius + rim):
        ax.plot(*arc((0.0, 0.0), r, 0.0, 360.0, 361).T, **WIRE)
    for k in range(elements):
        t = 2.0 * np.pi * k / elements
        e = np.array([np.cos(t), np.sin(t)])
        ax.plot(*np.array([(radius - rim) * e, (radius + rim) * e]).T, color=INK, lw=0.6)
    for k in range(supports):
        t = 2.0 * np.pi * k / supports
        e, side = np.array([np.cos(t), np.sin(t)]), np.array([-np.sin(t), np.cos(t)])
        spring(ax, tuple((radius + rim) * e), tuple((radius + 0.85) * e), 0.1, 3)
        ground(ax, tuple((radius + 0.85) * e), np.degrees(t), 0.3)
        spring(ax, tuple((radius + rim) * e), tuple((radius + rim) * e + 0.7 * side), 0.08, 3)
        ground(ax, tuple((radius + rim) * e + 0.7 * side), np.degrees(t) + 90.0, 0.16)
    alpha = np.radians(design.moving_load.pressure_angle)
    for k in range(loads):
        t = np.radians(75.0) + 2.0 * np.pi * k / loads
        e, side = np.array([np.cos(t), np.sin(t)]), np.array([-np.sin(t), np.cos(t)])
        tip = (radius - rim) * e
        arrow(ax, tuple(tip - 1.0 * (np.sin(alpha) * e + np.cos(alpha) * side)), tuple(tip))
    label(ax, (2.1, 1.6), "$F_0 + f\\sin\\omega t + b\\,W(t)$", ha="right")
    angle_mark(ax, (0.0, 0.0), 1.1, 0.0, 75.0, "$\\Omega t$", 1.2)
    ax.plot([0.0, 1.4], [0.0, 0.0], color=NOTE, lw=0.5)
    ax.plot(
        *np.array([(0.0, 0.0), arc((0.0, 0.0), radius - rim, 75.0, 75.0, 1)[0]]).T,
        color=NOTE,
        lw=0.5,
    )
    node = np.radians(-30.0)
    e, side = np.array([np.cos(node), np.sin(node)]), np.array([-np.sin(node), np.cos(node)])
    at = radius * e
    ax.plot(*at, "o", color=NOTE, ms=4)
    arrow(ax, tuple(at), tuple(at + 0.75 * e))
    arrow(ax, tuple(at), tuple(at + 0.75 * side))
    label(ax, tuple(at + 0.95 * e), "$u$")
    label(ax, tuple(at + 0.9 * side + 0.18 * e), "$w$")
    leader(ax, (0.2, -1.2), "middle node: $u$ outward, $w$ tangential, $r$ rotation", tuple(at))
    leader(
        ax,
        (-0.3, -2.2),
        f"{elements} curved-beam elements",
        tuple(arc((0.0, 0.0), radius, 250.0, 250.0, 1)[0]),
        color=INK,
    )
    leader(ax, (-1.2, 0.4), "support: $k_r$, $k_t$, $k_\\varphi$", (-radius - 0.4, 0.05), color=INK)
    ax.set_xlim(-4.4, 4.4)
    ax.set_ylim(-4.2, 4.2)
    return figure


def planetary() -> Figure:
    """Planetary train of drivers/planetary.toml, pitch circles to scale."""
    design = load_design(DRIVERS / "planetary.toml")
    assert isinstance(design, PlanetaryDesign)
    scale = 3.6 / design.ring.root_radius
    sun, planet = (
        0.5 * scale * design.sun.pitch_diameter,
        0.5 * scale * design.planet.pitch_diameter,
    )
    rim, centres = scale * design.ring.rim, sun + planet
    gap = 0.2  # the gears are drawn apart, for the mesh springs between them
    figure, ax = canvas(9.0, 9.0)
    for r in (3.75, 3.75 + rim):
        ax.plot(*arc((0.0, 0.0), r, 0.0, 360.0, 361).T, **WIRE)
    for k in range(design.ring.supports):
        t = 2.0 * np.pi * k / design.ring.supports
        e = np.array([np.cos(t), np.sin(t)])
        spring(ax, tuple((3.75 + rim) * e), tuple((4.4 + rim) * e), 0.1, 3)
        ground(ax, tuple((4.4 + rim) * e), np.degrees(t), 0.28)
    body(ax, (0.0, 0.0), sun - gap, CAM)
    for k in range(design.planet.count):
        psi = np.radians(90.0) + 2.0 * np.pi * k / design.planet.count
        e = np.array([np.cos(psi), np.sin(psi)])
        center = centres * e
        body(ax, tuple(center), planet - gap, SPLINE)
        mesh(ax, tuple((sun - gap) * e), tuple((centres - planet + gap) * e), 0.07)
        mesh(ax, tuple((centres + planet - gap) * e), tuple(3.75 * e), 0.07)
        ax.plot(*np.array([0.45 * e, center]).T, color=RING, lw=5.0, alpha=0.5)
    top = (0.0, centres)
    arrow(ax, top, (0.0, centres + 0.8))
    arrow(ax, top, (-0.8, centres))
    label(ax, (0.22, centres + 0.75), "$\\xi$")
    label(ax, (-0.85, centres + 0.2), "$\\eta$")
    angle_mark(ax, top, 0.45 * planet, -60.0, 40.0, "$u_p$", 1.35)
    angle_mark(ax, (0.0, 0.0), 0.6 * sun, 120.0, 240.0, "$u_s$", 1.5)
    angle_mark(
        ax, (0.0, 0.0), 1.75, 20.0, 70.0, "$\\Omega$, wind torque $T$\non the carrier, $u_c$", 1.55
    )
    contact = np.array([0.0, 3.75 + 0.5 * rim])
    arrow(ax, tuple(contact), tuple(contact + np.array([0.0, 0.95])))
    arrow(ax, tuple(contact), tuple(contact + np.array([-0.95, 0.0])))
    label(ax, (0.25, contact[1] + 0.85), "$v$")
    label(ax, (-1.05, contact[1] + 0.25), "$w$")
    leader(ax, (4.2, 4.5), "elastic ring of curved beams", (2.87, 2.87), color=INK)
    leader(
        ax, (1.35, -2.7), "planet on the carrier:\n$\\xi$, $\\eta$, $u_p$", (1.5, -1.9), color=INK
    )
    leader(ax, (-2.6, 1.2), "sun: $x$, $y$, $u_s$", (-0.3, 0.2), color=INK)
    ring_mesh = 3.65 * np.array([-np.cos(np.pi / 6), -0.5])
    leader(
        ax, (-1.0, -2.6), "mesh: $k(t)$ with\nbacklash $2b$, damper", tuple(ring_mesh), color=INK
    )
    ax.set_xlim(-5.3, 5.3)
    ax.set_ylim(-5.3, 5.3)
    return figure


if __name__ == "__main__":
    plt.rcParams["mathtext.fontset"] = "cm"
    names = {"cascade": cascade, "gear_pair": gear_pair, "ring": ring, "planetary": planetary}
    run({f"schematic_{name}": draw for name, draw in names.items()})
