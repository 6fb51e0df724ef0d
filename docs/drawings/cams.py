"""All wave generators with their parameters, the pushing pins and the load stages."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import matplotlib.pyplot as plt
import numpy as np
from _drafting import (
    CAM,
    INK,
    NOTE,
    SPLINE,
    angle_mark,
    arc,
    axis_line,
    canvases,
    dimension,
    label,
    leader,
    plane_with,
    run,
)
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from swgpar.geometry.cams import Cam, make_cam
from swgpar.geometry.cams.arcs import arcs
from swgpar.geometry.cams.elliptical import EllipticalCam
from swgpar.geometry.cams.harmonic import HarmonicCam
from swgpar.geometry.cams.keys import CamPoints, Polar
from swgpar.geometry.cams.parabolic import Side, parabolic, solve_quarter
from swgpar.geometry.cams.piecewise import Circle, Parabola
from swgpar.geometry.cams.rollers import RollerCam, rollers
from swgpar.geometry.cams.simplified import simplified

R_FS = 10.0
D = 4.0
A = 12.0
B = 8.0
"""Inner radius of the spline, deflection and semi-axes (mm) of the drawings: proportions are
exaggerated."""

PARTS = {"parabola": "#8c4fb0", "connector": "#2d9a57", "lateral": "#d07a20"}


def base(ax: Axes, cam: Cam, title: str) -> None:
    """Cam, axes and the undeformed inner circle of the spline."""
    outline = cam.outline(1440)
    parts = np.array_split(outline, cam.count) if isinstance(cam, RollerCam) else [outline]
    for part in parts:
        ax.fill(*part.T, fc=CAM, alpha=0.55, ec=INK, lw=1.0)
    ax.plot(*arc((0, 0), R_FS, 0, 360).T, color=SPLINE, lw=0.9, ls="--")
    axis_line(ax, (-R_FS - 1.5, 0), (R_FS + 1.5, 0))
    axis_line(ax, (0, -A - 1.2), (0, A + 1.5))
    ax.set_title(f'type = "{title}"', fontsize=10)


def semi_axes(ax: Axes, minor: str = "$b$") -> None:
    dimension(ax, (0, 0), (0, A), "$a$", at=(0.7, 0.72 * A))
    dimension(ax, (0, 0), (B, 0), minor, at=(0.7 * B, -0.9))


def draw_elliptical(ax: Axes) -> None:
    base(ax, EllipticalCam(A, B), "elliptical")
    semi_axes(ax)
    text = "dashed: inner surface of\nthe undeformed spline, $r_{fs}$"
    label(ax, (0.0, -5.0), text, color=SPLINE)


def draw_harmonic(ax: Axes, lobes: int) -> None:
    base(ax, HarmonicCam(A, B, lobes), "harmonic")
    ax.set_title(f'type = "harmonic", lobes = {lobes}', fontsize=10)
    low = np.pi / lobes  # polar angle from +y of the least radius
    dimension(ax, (0, 0), (0, A), "$a$", at=(0.7, 0.72 * A))
    dimension(
        ax,
        (0, 0),
        (B * np.sin(low), B * np.cos(low)),
        "$b$",
        at=(0.6 * B * np.sin(low), 0.6 * B * np.cos(low) - 1.0),
    )
    angle = 0.62 * low
    radius = 0.5 * (A + B) + 0.5 * (A - B) * np.cos(lobes * angle)
    ax.plot([0, radius * np.sin(angle)], [0, radius * np.cos(angle)], color=NOTE, lw=0.7)
    angle_mark(ax, (0, 0), 4.2, 90.0, 90.0 - np.degrees(angle), r"$\theta$", out=1.25)
    text = rf"$r = (a + b)/2 + (a - b)/2 \cdot \cos {lobes}\theta$"
    label(ax, (0.0, -4.6), text, color=INK)


def draw_simplified(ax: Axes) -> None:
    base(ax, simplified(A, B), "simplified")
    height = A - B
    for sign in (1, -1):
        ax.plot(0, sign * height, "+", color=NOTE, ms=9)
        ax.plot([-B, B], [sign * height] * 2, color=INK, lw=0.5, ls=":")
    label(ax, (1.3, height - 0.6), "$(0, a - b)$")
    point = (-B * np.sin(np.radians(48)), height + B * np.cos(np.radians(48)))
    dimension(ax, (0, height), point, "radius $b$", rotation=-42)
    leader(ax, (4.3, -8.3), "straight", (B, -2.0))
    semi_axes(ax)


def draw_arcs(ax: Axes) -> None:
    cam = arcs(A, B, np.radians(40.0), "beta")
    base(ax, cam, "arcs")
    side, top, _ = (piece for piece in cam.pieces if isinstance(piece, Circle))
    joint = cam.joints[0]
    for circle, name in ((top, "parabola"), (side, "lateral")):
        ax.plot(*circle.center, "+", color=PARTS[name], ms=10, mew=1.5)
        ax.plot(*np.transpose([circle.center, joint]), color=PARTS[name], lw=0.7, ls=":")
    ax.plot(*arc(top.center, top.radius, 50, 130).T, color=PARTS["parabola"], lw=2.6)
    ax.plot(*arc(side.center, side.radius, 0, 50).T, color=PARTS["lateral"], lw=2.6)
    angle_mark(ax, top.center, 2.6, 90.0, 50.0, r"$\beta$", out=1.3)
    leader(
        ax,
        (9.0, 9.0),
        "$r_1$",
        tuple(arc(top.center, top.radius, 60, 61)[0]),
        color=PARTS["parabola"],
    )
    leader(
        ax,
        (10.5, 4.5),
        "$r_2$",
        tuple(arc(side.center, side.radius, 25, 26)[0]),
        color=PARTS["lateral"],
    )
    semi_axes(ax)


def draw_parabolic(ax: Axes) -> None:
    side = Side(a_p=0.06, C_p=0.55, r_c=2.6)
    base(ax, parabolic(A, B, side, side), "parabolic")
    parabola = Parabola(A, side.a_p)
    quarter = solve_quarter(parabola, B, side)
    x = np.linspace(0, side.C_p * B, 40)
    ax.plot(x, A - side.a_p * x**2, color=PARTS["parabola"], lw=2.6)
    for circle, start, end, name in (
        (quarter.connector, quarter.alpha, quarter.theta, "connector"),
        (quarter.lateral, 0.0, quarter.alpha, "lateral"),
    ):
        points = arc(circle.center, circle.radius, np.degrees(start), np.degrees(end))
        ax.plot(*points.T, color=PARTS[name], lw=2.6)
        ax.plot(*circle.center, "+", color=PARTS[name], ms=10, mew=1.5)
        for point in (points[0], points[-1]):
            ax.plot(*np.transpose([circle.center, point]), color=PARTS[name], lw=0.7, ls=":")
    c, lateral = quarter.connector.center, quarter.lateral
    begin, end = np.degrees([quarter.alpha, quarter.theta])
    middle = arc(c, quarter.connector.radius, begin, end, 3)[1]
    dimension(ax, c, tuple(middle), "$r_c$", at=(c[0] + 1.3, c[1] + 0.25))
    label(ax, (c[0] - 0.7, c[1] - 0.4), "$c$", color=PARTS["connector"])
    angle_mark(ax, lateral.center, 3.4, 0.0, np.degrees(quarter.alpha), r"$\alpha_l$", out=1.25)
    label(
        ax,
        (lateral.center[0] + 1.0, -0.9),
        "centre of the lateral arc, $(b - r_l, 0)$",
        color=PARTS["lateral"],
    )
    ax.plot(*quarter.end, "o", color=INK, ms=4)
    label(ax, (quarter.end[0] + 0.9, quarter.end[1] + 0.7), "$P$", color=INK)
    ax.plot([quarter.end[0]] * 2, [quarter.end[1], A + 0.8], color=NOTE, lw=0.5)
    dimension(
        ax, (0, A + 0.6), (quarter.end[0], A + 0.6), "$C_p b$", at=(0.5 * quarter.end[0], A + 1.4)
    )
    label(ax, (-3.9, A + 0.3), "$y = a - a_p x^2$", color=PARTS["parabola"])
    end = arc(lateral.center, lateral.radius, 0, np.degrees(quarter.alpha), 5)[2]
    leader(ax, (9.6, 6.3), "lateral\narc $r_l$", tuple(end), color=PARTS["lateral"])
    dimension(ax, (0, -4.0), (B, -4.0), "$b$", at=(0.5 * B, -4.7))
    ax.plot([B, B], [0, -4.2], color=NOTE, lw=0.5)


def draw_asymmetric(ax: Axes) -> None:
    right, left, tilt = Side(0.06, 0.55, 2.6), Side(0.05, 0.48, 3.2), np.radians(7.0)
    base(ax, parabolic(A, B, right, left, tilt), "asymmetric_parabolic")
    parabola = Parabola(A, right.a_p, tilt)
    for side, colour, sign, bend in (
        (right, PARTS["parabola"], 1, tilt),
        (left, PARTS["connector"], -1, -tilt),
    ):
        points = np.array(
            [Parabola(A, side.a_p, bend).at(x)[0] for x in np.linspace(0, side.C_p * B, 30)]
        )
        ax.plot(*(points * (sign, 1.0)).T, color=colour, lw=2.6)
    tangent = parabola.at(0.0)[1]
    ax.plot([0, 3.6 * tangent[0]], [A, A - 3.6 * tangent[1]], color="none")
    direction = np.array([tangent[1], -tangent[0]])
    ax.plot(*np.transpose([(0, A) - 5.2 * direction, (0, A) + 1.0 * direction]), color=NOTE, lw=0.7)
    ax.plot([-5.2, 0], [A, A], color=NOTE, lw=0.5)
    at = 180.0
    angle_mark(ax, (0.0, A), 4.4, at, at + np.degrees(tilt), r"$\lambda$", out=1.16)
    label(ax, (4.6, A + 0.4), "right:\n$a_p, C_p, r_c$", color=PARTS["parabola"])
    label(ax, (-6.5, A - 2.6), "left:\n$a_p, C_p, r_c$", color=PARTS["connector"])
    label(ax, (0.0, -5.6), "the lower lobe is the upper one\nafter half a turn", color=INK)
    dimension(ax, (0, 0), (0, A), "$a$", at=(0.7, 0.5 * A))
    dimension(ax, (0, 0), (B, 0), "$b$", at=(0.7 * B, -0.9))


def draw_rollers(ax: Axes) -> None:
    beta, radius = np.radians(32.0), 3.2
    cam = rollers(A - radius, beta, radius, "r_4")
    base(ax, cam, "four_roller")
    ax.plot(*arc((0, 0), A, 20, 160).T, color=INK, lw=0.6, ls=":")
    label(ax, (-9.2, 9.6), "circle of radius $a$", color=INK)
    c = np.array(cam.center)
    unit = c / np.hypot(*c)
    ax.plot([0, A * unit[0]], [0, A * unit[1]], color=NOTE, lw=0.7)
    ax.plot(*c, "+", color=NOTE, ms=9)
    dimension(
        ax, tuple(c), tuple(c + radius * np.array([1.0, 0.0])), "$r_4$", at=(c[0] + 1.7, c[1] + 0.7)
    )
    angle_mark(ax, (0, 0), 4.2, 90.0, 90.0 - np.degrees(beta), r"$\beta$", out=1.2)
    dimension(ax, (0, 0), tuple(-A * unit), "$a$", at=tuple(-0.35 * A * unit + (0.9, 0)))
    ax.plot(*arc((0, 0), cam.reach, 0, 360).T, color=NOTE, lw=0.5, ls=":")
    on_circle = tuple(cam.reach * unit * (1, -1))
    leader(ax, (0.0, -5.6), "circle of the centres,\ncentre_radius", on_circle)


def draw_polar(ax: Axes) -> None:
    """A cam from an expression, and points of another one."""
    polynomial = "s = 2 * theta / pi; a - (a - b) * (10 * s**3 - 15 * s**4 + 6 * s**5)"
    cam = make_cam(Polar(type="polar", face_width=1.0, radius=polynomial), A, B)
    base(ax, cam, "polar")
    angle = np.radians(50.0)
    point = cam.outline(360)[50]
    ax.plot([0, point[0]], [0, point[1]], color=NOTE, lw=0.7)
    angle_mark(ax, (0, 0), 4.2, 90.0, 90.0 + np.degrees(angle), r"$\theta$", out=1.25)
    text = "radius: an expression of $\\theta$, $a$, $b$\nand parameters; here 3-4-5 polynomial"
    label(ax, (0.0, -4.6), text, color=INK)
    semi_axes(ax)


def draw_points(ax: Axes) -> None:
    points = EllipticalCam(A, B).outline(72)[:37]
    keys = CamPoints(type="points", face_width=1.0, points=points[:19].tolist())
    base(ax, make_cam(keys, A), "points")
    ax.plot(*points[:19].T, "o", color=NOTE, ms=4)
    ax.plot(*points[19:].T, "o", mfc="none", mec=NOTE, ms=4)
    label(ax, (0.0, -4.6), "points of half a lobe, of a lobe,\nor of the whole cam", color=INK)


def draw_two_rollers(ax: Axes) -> None:
    radius = 4.2
    cam = rollers(A - radius, 0.0, radius, "r_2")
    base(ax, cam, "two_roller")
    c = np.array(cam.center)
    ax.plot(*c, "+", color=NOTE, ms=9)
    dimension(
        ax, tuple(c), tuple(c + radius * np.array([1.0, 0.0])), "$r_2$", at=(c[0] + 2.2, c[1] + 0.7)
    )
    dimension(ax, (0, 0), tuple(-c), "centre_radius", at=(3.2, -0.5 * cam.reach))
    dimension(ax, (-7.5, 0), (-7.5, A), "$r_{fs} + w_0$", at=(-9.4, 0.5 * A))
    ax.plot([-7.9, 0], [A, A], color=NOTE, lw=0.5)


def draw_pins(ax: Axes) -> None:
    half, travel = np.radians(35.0), 0.5 * D
    cam = EllipticalCam(A, B)
    outline = cam.outline(720)
    for sign in (1, -1):
        part = outline[outline[:, 1] * sign >= 0.0]
        part = part[np.argsort(np.arctan2(part[:, 0], sign * part[:, 1]))] - (0.0, sign * travel)
        near = np.abs(np.arctan2(part[:, 0], sign * part[:, 1])) <= half
        ax.fill(*np.concatenate([[(0.0, 0.0)], part[near]]).T, fc=CAM, alpha=0.4, ec="none")
        ax.plot(*part[near].T, color=NOTE, lw=3.0)
        tip = sign * (A - travel)
        ax.annotate(
            "",
            xy=(-1.2, tip + sign * travel),
            xytext=(-1.2, tip),
            arrowprops={"arrowstyle": "-|>", "color": NOTE},
        )
    ax.plot(*arc((0, 0), R_FS, 0, 360).T, color=SPLINE, lw=1.6)
    axis_line(ax, (-R_FS - 1.5, 0), (R_FS + 1.5, 0))
    axis_line(ax, (0, -A - 1.2), (0, A + 1.5))
    for sign in (1, -1):
        ax.plot([0, sign * 12 * np.sin(half)], [0, 12 * np.cos(half)], color=NOTE, lw=0.6, ls="--")
    angle_mark(ax, (0, 0), 5.0, 90.0, 90.0 - np.degrees(half), "pin_half_\nangle", out=1.3)
    label(ax, (-4.0, 11.6), "$d/2$")
    label(
        ax, (0.0, -3.2), "the pins are the halves of the cam,\ndrawn in until they fit", color=INK
    )
    ax.set_title("pushing pins (start of stage 1)", fontsize=10)


def cams() -> Figure:
    """All types of wave generator, and the pins."""
    figures: tuple[Callable[[Axes], None], ...] = (
        draw_elliptical,
        draw_simplified,
        draw_arcs,
        draw_parabolic,
        draw_asymmetric,
        draw_rollers,
        draw_two_rollers,
        draw_polar,
        draw_points,
        partial(draw_harmonic, lobes=2),
        partial(draw_harmonic, lobes=3),
        draw_pins,
    )
    rows = (len(figures) + 1) // 2
    figure, axes = canvases(9.0, 14.5 / 3.0 * rows, rows, 2)
    for ax, draw in zip(axes.ravel(), figures):
        draw(ax)
        ax.set_xlim(-12.5, 12.5)
        ax.set_ylim(-14.0, 15.0)
    figure.tight_layout()
    return figure


REFERENCE: dict[str, dict[str, object]] = {
    "elliptical": {"type": "elliptical"},
    "harmonic": {"type": "harmonic"},
    "simplified, C = 0.97": {"type": "simplified", "C": 0.97},
    "arcs, beta = 45 degrees": {"type": "arcs", "beta": 45.0},
    "parabolic": {"type": "parabolic", "a_p": 0.0097, "C_p": 0.51, "r_c": 10.0},
    "asymmetric_parabolic, 0.5 degrees": {
        "type": "asymmetric_parabolic",
        "rotational_angle": 0.5,
        "right": {"a_p": 0.0097, "C_p": 0.51, "r_c": 10.0},
        "left": {"a_p": 0.0097, "C_p": 0.51, "r_c": 10.0},
    },
    "four_roller": {"type": "four_roller", "beta": 10.0, "r_4": 8.0},
    "two_roller": {"type": "two_roller", "r_2": 20.0},
}
"""Wave generators of the studies of the reference drive."""


def cam_radius() -> Figure:
    """Radius of the cams of the reference drive over the angle from the major axis, at true
    scale."""
    figure, ax = plt.subplots(figsize=(9.0, 4.4))
    for name, keys in REFERENCE.items():
        design = plane_with(wave_generator={"face_width": 10.0, **keys})
        points = design.cam().outline(7200)
        angle, radius = np.degrees(np.arctan2(-points[:, 0], points[:, 1])), np.hypot(*points.T)
        order = np.argsort(angle)
        angle, height = angle[order], radius[order] - design.inner_radius
        ax.plot(angle, np.where(height > -2.2, height, np.nan), lw=1.4, label=name)
    for level, name in ((0.5 * design.deflection, "a"), (-0.5 * design.deflection, "b for C = 1")):
        ax.axhline(level, color=INK, lw=0.6, ls="--")
        ax.text(91.0, level, name, va="center", fontsize=8)
    ax.axhline(0.0, color=SPLINE, lw=0.9)
    ax.text(91.0, 0.0, "$r_{fs}$", va="center", fontsize=8, color=SPLINE)
    ax.set_xlim(-90, 90)
    ax.set_ylim(-2.3, 1.4)
    ax.set_xticks(range(-90, 91, 30))
    ax.set_xlabel("angle from the major axis, counter-clockwise, degrees")
    ax.set_ylabel("radius of the cam − $r_{fs}$, mm")
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8, loc="lower center")
    figure.tight_layout()
    return figure


def stages() -> Figure:
    """What is active in the load stages, exaggerated."""
    figure, axes = canvases(8.5, 9.2, 2, 2)
    circle = np.linspace(0, 2 * np.pi, 361)
    titles = ("1 deflect", "2 engage", "3 load", "4, 5, … rotate")
    notes = (
        "pins push outwards by $d/2$\nteeth and cam are off",
        "pins leave, cam grows,\nteeth may touch",
        "torque on the output,\nfriction from here on",
        "wave generator turns\nin increments",
    )
    for k, (ax, title, note) in enumerate(zip(axes.ravel(), titles, notes)):
        turn = np.radians(25.0) if k == 3 else 0.0
        c, s = np.cos(turn), np.sin(turn)
        ellipse = np.column_stack([B * np.sin(circle), A * np.cos(circle)]) @ np.array(
            [[c, s], [-s, c]]
        )
        spline = np.column_stack(
            [(B + 0.5) * np.sin(circle), (A + 0.5) * np.cos(circle)]
        ) @ np.array([[c, s], [-s, c]])
        ax.plot(*spline.T, color=SPLINE, lw=3.0)
        if k == 0:
            for sign in (1, -1):
                half = np.radians(np.linspace(-15, 15, 30))
                ax.plot(B * np.sin(half) * 1.5, sign * A * np.cos(half), color=NOTE, lw=4)
                arrow = {"arrowstyle": "-|>", "color": NOTE, "lw": 1.5}
                ax.annotate(
                    "", xy=(0, sign * (A - 0.6)), xytext=(0, sign * (A - 5)), arrowprops=arrow
                )
        else:
            ax.fill(
                *ellipse.T,
                fc=CAM,
                alpha=0.25 if k == 1 else 0.7,
                ec=INK,
                lw=0.8,
                ls="--" if k == 1 else "-",
            )
        if k == 2:
            angle_mark(ax, (0, 0), A + 2.5, 55.0, 90.0, "T", out=1.12)
        if k == 3:
            angle_mark(ax, (0, 0), 5.0, 90.0, 90.0 + np.degrees(turn), "wave generator", out=1.5)
            angle_mark(ax, (0, 0), A + 2.5, 55.0, 90.0, "T", out=1.12)
            angle_mark(ax, (0, 0), A + 2.5, 45.0, 25.0, "output", out=1.18)
        ax.plot(
            *arc((0, 0), A + (1.2 if k else 1.2), 0, 360).T,
            color="#9d9d9d",
            lw=2.2,
            alpha=0.2 if k == 0 else 0.9,
        )
        ax.set_title(title, fontsize=11)
        label(ax, (0, -A - 4.2), note, color=INK)
        ax.set_xlim(-18, 18)
        ax.set_ylim(-A - 6, A + 5)
    figure.tight_layout()
    return figure


if __name__ == "__main__":
    run({"cams": cams, "cam_radius": cam_radius, "load_stages": stages})
