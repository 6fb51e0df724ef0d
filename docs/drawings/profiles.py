"""Directly defined tooth profiles with their radii, centres and angles: quadruple and double arc,
both gears."""

from __future__ import annotations

import numpy as np
from _drafting import (
    INK,
    NOTE,
    RING,
    SPLINE,
    arc,
    axis_line,
    canvases,
    label,
    leader,
    plane_with,
    run,
)
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GEARS
from swgpar.profiles import ToothProfile
from swgpar.profiles.flank import Segment

COLOURS = {
    "tip": "#8c4fb0",
    "addendum": "#2f7fd0",
    "straight": "#111111",
    "dedendum": "#2d9a57",
    "root": "#d07a20",
}

QUADRUPLE = {"type": "quadruple_arc", "r_tip": 0.3, "r_addendum": 0.9, "straight_l": 0.3}
QUADRUPLE |= {"r_dedendum": 1.3, "r_root": 0.25}
TRAPEZOID = {"type": "trapezoid", "r_tip": 0.12, "r_root": 0.3}
CENTRES = {"type": "common_tangent", "r_addendum": 1.0, "c_addendum": 0.22, "e_addendum": 0.14}
CENTRES |= {"r_dedendum": 1.3, "c_dedendum": 0.51, "e_dedendum": 0.24, "r_root": 0.25}
DOUBLE = {"type": "double_arc", "r_addendum": 1.0, "r_dedendum": 0.45}
"""Radii that show every centre on the paper; all other sizes are those of the reference drive."""

Spot = dict[str, tuple[float, float]]
"""Where the name of a point stands, from the point, in mm."""


def design_with(profile: dict[str, object]) -> DriveDesign:
    """The plane reference drive with this profile on both gears."""
    values = {"profile": dict(profile), "c_l": 0.4 if profile["type"] == "double_arc" else 0.5}
    return plane_with(flexible_spline=values, ring_gear=values)


def center(segment: Segment) -> np.ndarray:
    """Centre (2,) mm of an arc of a flank."""
    normal = np.array([-np.sin(segment.direction), np.cos(segment.direction)])
    return np.asarray(segment.start) + normal / segment.curvature


def draw_profile(ax: Axes, profile: ToothProfile, r_pitch: float, spots: Spot) -> None:
    """One flank with the circles, the centres of its arcs and the points between them."""
    half = np.degrees(np.pi / profile.n_teeth)
    flank = profile.point(np.linspace(0.0, profile.length, 400))
    low, high = sorted((profile.r_tip_circle, profile.r_root_circle))
    # material: of the tooth, closed along its centre line, with some rim
    rim = profile.r_root_circle - (0.35 if profile.external else -0.35)
    end = np.radians(half)
    edge = np.array([(0.0, rim), (rim * np.sin(end), rim * np.cos(end))])
    root = profile.r_root_circle * np.array([np.sin(end), np.cos(end)])
    outline = np.concatenate([[(0.0, profile.r_tip_circle)], flank, [root], edge[::-1]])
    ax.fill(*outline.T, fc=SPLINE if profile.external else RING, alpha=0.35, lw=0)
    axis_line(ax, (0.0, low - 0.5), (0.0, high + 0.5))
    for radius, name in (
        (profile.r_tip_circle, "$r_A$, addendum circle"),
        (r_pitch, "$r_P$, pitch circle"),
        (profile.r_root_circle, "$r_D$, dedendum circle"),
    ):
        line = arc((0.0, 0.0), radius, 90.0 + 0.35 * half, 90.0 - 1.25 * half)
        ax.plot(*line.T, color=INK, lw=0.6, dashes=(12, 3, 2, 3) if radius == r_pitch else (5, 2))
        label(ax, (line[-1][0] + 0.06, line[-1][1]), name, color=INK, ha="left")
    names = [segment.name for segment in profile.segments]
    for segment in profile.segments:
        points = segment.at(np.linspace(0.0, segment.length, 60)).point
        ax.plot(*points.T, color=COLOURS[segment.name], lw=2.6, solid_capstyle="butt")
        if isinstance(segment, Segment) and segment.curvature:
            middle, at = points[len(points) // 2], center(segment)
            ax.plot(*at, "+", color=COLOURS[segment.name], ms=9, mew=1.5)
            for point in (points[0], points[-1]):
                ax.plot(*np.transpose([at, point]), color=COLOURS[segment.name], lw=0.5, ls=":")
            short = segment.name[0]
            arrow = {
                "arrowstyle": "-|>",
                "color": COLOURS[segment.name],
                "lw": 0.9,
                "shrinkA": 0,
                "shrinkB": 0,
            }
            ax.annotate("", xy=middle, xytext=tuple(at), arrowprops=arrow)
            text = at + (0.62 if segment.name in ("dedendum", "addendum") else 0.5) * (middle - at)
            label(ax, tuple(text), f"$r_{short}$", color=COLOURS[segment.name], fontsize=9)
            name = f"O{short}"
            if segment.name in ("addendum", "dedendum") and "tip" in names:
                radius, colour = 0.3 / abs(segment.curvature), COLOURS[segment.name]
                angles = np.degrees(np.arctan2(*(np.array([points[0], points[-1]]) - at).T[::-1]))
                swept = (angles[1] - angles[0] + 180.0) % 360.0 - 180.0
                mark = arc(tuple(at), radius, angles[0], angles[0] + swept)
                ax.plot(*mark.T, color=colour, lw=0.9)
                beside = arc(tuple(at), 1.25 * radius, angles[0], angles[0] + swept, 5)[
                    3 if segment.name == "addendum" else 1
                ]
                label(ax, tuple(beside), rf"$\alpha_{short}$", color=colour, fontsize=9)
            label(
                ax,
                tuple(at + spots.get(name, (0.0, -0.09))),
                f"$O_{short}$",
                color=COLOURS[segment.name],
                fontsize=9,
            )
    named = {"T": profile.point(0.0)[0], "R": profile.point(profile.length)[0]}
    s = 0.0
    for segment in profile.segments:
        if segment.name == "straight":
            named["Pa"], named["Pd"] = profile.point([s, s + segment.length])
        s += segment.length
    for name, point in named.items():
        ax.plot(*point, "o", color=INK, ms=3)
        text = f"${name[0]}_{name[1]}$" if len(name) > 1 else name
        label(ax, tuple(point + spots.get(name, (0.11, 0.07))), text, color=INK, fontsize=9)


def pitch_point(
    ax: Axes, profile: ToothProfile, r_pitch: float, pressure_angle: float, spots: Spot
) -> None:
    """The pitch point with its normal and the angles alpha_P, alpha and alpha*."""
    side = 1.0 if profile.external else -1.0
    alpha_p = 0.5 * np.pi / profile.n_teeth
    point = r_pitch * np.array([np.sin(alpha_p), np.cos(alpha_p)])
    star = pressure_angle - side * alpha_p
    normal = np.array([np.cos(star), side * np.sin(star)])
    ax.plot(*point, "o", color=NOTE, ms=4)
    leader(ax, tuple(point + spots["P"]), "P", tuple(point), fontsize=9)
    ax.annotate(
        "",
        xy=tuple(point + 0.62 * normal),
        xytext=tuple(point),
        arrowprops={"arrowstyle": "-|>", "color": NOTE, "lw": 1.1},
    )
    label(ax, tuple(point + spots["n"]), r"$n(\alpha^*)$", fontsize=9)
    ax.plot([point[0], point[0] + 0.55], [point[1], point[1]], color=NOTE, lw=0.5)
    mark = arc(tuple(point), 0.42, 0.0, side * np.degrees(star))
    ax.plot(*mark.T, color=NOTE, lw=0.9)
    label(ax, tuple(point + spots["star"]), r"$\alpha^*$", fontsize=9)
    # alpha_P is drawn between the centre line and the pitch point
    ax.annotate(
        "",
        xy=tuple(point),
        xytext=(0.0, r_pitch),
        arrowprops={"arrowstyle": "<|-|>", "color": NOTE, "lw": 0.8, "shrinkA": 0},
    )
    label(ax, (0.68 * point[0], r_pitch + 0.05), r"$\alpha_P r_P$", fontsize=8)


def pair(profile: dict[str, object], spots: tuple[Spot, Spot], title: str) -> Figure:
    """Both gears' flanks beside each other."""
    design = design_with(profile)
    figure, axes = canvases(8.0, 11.0, 2, 1)
    angle = np.radians(design.drive.pressure_angle)
    for ax, gear, teeth, spot, name in zip(
        axes,
        GEARS,
        (design.drive.teeth_fs, design.drive.teeth_rg),
        spots,
        ("external tooth (flexible spline), s = +1", "internal tooth (ring gear), s = −1"),
    ):
        flank, r_pitch = design.profile(gear), 0.5 * teeth * design.drive.module
        draw_profile(ax, flank, r_pitch, spot)
        pitch_point(ax, flank, r_pitch, angle, spot)
        ax.set_title(f"{title}, {name}", fontsize=10)
    figure.tight_layout()
    return figure


OUTSIDE = {"P": (-0.2, -0.17), "n": (0.72, 0.2), "star": (0.52, 0.07)}
OUTSIDE |= {"Or": (0.12, 0.02), "Ot": (-0.12, 0.0)}
INSIDE = {
    "P": (-0.2, 0.17),
    "n": (0.72, -0.2),
    "star": (0.52, -0.07),
    "T": (0.04, -0.11),
    "Ot": (-0.13, 0.02),
}
INSIDE |= {"R": (0.11, 0.1), "Pd": (0.13, -0.04), "Pa": (0.12, -0.03)}


def quadruple_arc() -> Figure:
    return pair(QUADRUPLE, (OUTSIDE, INSIDE), "quadruple arc")


def double_arc() -> Figure:
    return pair(DOUBLE, (OUTSIDE, INSIDE), "double arc")


def trapezoid() -> Figure:
    return pair(TRAPEZOID, (OUTSIDE, INSIDE), "trapezoid")


def common_tangent() -> Figure:
    return pair(CENTRES, (OUTSIDE, INSIDE), "arcs by their centres")


if __name__ == "__main__":
    run(
        {
            "profile_quadruple_arc": quadruple_arc,
            "profile_double_arc": double_arc,
            "profile_trapezoid": trapezoid,
            "profile_common_tangent": common_tangent,
        }
    )
