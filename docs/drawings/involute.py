"""Involute profiles and the cutters that generate them: a rack for external teeth, a shaper for
internal ones."""

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
    turned,
)
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from swgpar.design.drive_design import DriveDesign
from swgpar.profiles import ToothProfile

TEETH, RADIUS, SHAPER = (40, 42), 0.2, 28
"""Teeth of both gears, so few that the cutters' motion shows; tip radius (mm) of the cutters; teeth
of the shaper."""

ROLL = np.linspace(-0.2, 0.12, 17)
"""Generating angles psi (rad) at which the cutter is drawn."""


def design() -> DriveDesign:
    """The plane reference drive with few teeth, which are involutes."""
    rack_cut = {"type": "involute", "cutter_radius": RADIUS}
    return plane_with(
        drive=dict(zip(("teeth_fs", "teeth_rg"), TEETH)),
        flexible_spline={"profile": rack_cut},
        ring_gear={"profile": {**rack_cut, "cutter_teeth": SHAPER}},
    )


def rack_flank(alpha: float, depth: float, module: float) -> np.ndarray:
    """Left flank of a rack's tooth (n, 2), mm, x from the crossing of flank and pitch line, y from
    the pitch line."""
    rise = (1.0 - np.sin(alpha)) / np.cos(alpha)
    middle = depth * np.tan(alpha) + RADIUS * rise, RADIUS - depth
    rounding = arc(middle, RADIUS, 180.0 + np.degrees(alpha), 270.0, 40)
    top = 0.75 * module
    return np.concatenate(
        [[(-top * np.tan(alpha), top)], rounding, [(0.25 * np.pi * 2.0 * module, -depth)]]
    )


def shaper_tooth(alpha: float, depth: float, module: float) -> np.ndarray:
    """Right half of a shaper's tooth (n, 2), mm, centred on +y of its own axis."""
    radius = 0.5 * SHAPER * module
    base, outside = radius * np.cos(alpha), radius + depth
    roll_p = np.tan(alpha) - alpha
    half = 0.5 * np.pi / SHAPER

    def polar(r: np.ndarray) -> np.ndarray:
        at = np.arccos(base / r)
        return half + roll_p - (np.tan(at) - at)

    r_c = outside - RADIUS
    # the rounding is tangent to the involute where the tangent to the base circle reaches its
    # centre
    at_c = np.arccos(base / r_c)
    center_angle = half + roll_p - (np.tan(at_c) - at_c) - RADIUS / base
    touch = np.hypot(base, base * np.tan(at_c) + RADIUS)
    r = np.linspace(radius - 0.75 * module, touch, 60)
    angle = polar(r)
    flank = np.column_stack([r * np.sin(angle), r * np.cos(angle)])
    center = r_c * np.array([np.sin(center_angle), np.cos(center_angle)])
    first = flank[-1] - center
    start = np.degrees(np.arctan2(first[1], first[0]))
    end = 90.0 - np.degrees(center_angle)
    return np.concatenate([flank, arc(tuple(center), RADIUS, start, end, 30), [(0.0, outside)]])


def frame(ax: Axes, profile: ToothProfile, r_pitch: float, title: str) -> None:
    """Circles and flank of one gear."""
    half = np.degrees(np.pi / profile.n_teeth)
    for radius, name in (
        (profile.r_tip_circle, "$r_A$"),
        (r_pitch, "$r_P$"),
        (profile.r_root_circle, "$r_D$"),
    ):
        line = arc((0.0, 0.0), radius, 90.0 + 0.4 * half, 90.0 - 1.6 * half)
        ax.plot(*line.T, color=INK, lw=0.6, dashes=(12, 3, 2, 3) if radius == r_pitch else (5, 2))
        label(ax, (line[-1][0] + 0.1, line[-1][1]), name, color=INK, ha="left")
    low, high = sorted((profile.r_tip_circle, profile.r_root_circle))
    axis_line(ax, (0.0, low - 0.5), (0.0, high + 0.5))
    flank = profile.point(np.linspace(0.0, profile.length, 300))
    end = np.radians(half)
    rim = profile.r_root_circle - (0.4 if profile.external else -0.4)
    corner = np.array([(rim * np.sin(end), rim * np.cos(end)), (0.0, rim)])
    root = profile.r_root_circle * np.array([(np.sin(end), np.cos(end))])
    outline = np.concatenate([[(0.0, profile.r_tip_circle)], flank, root, corner])
    ax.fill(*outline.T, fc=SPLINE if profile.external else RING, alpha=0.4, lw=0)
    s = 0.0
    for segment, colour in zip(profile.segments, ("#2f7fd0", "#d07a20")):
        points = profile.point(np.linspace(s, s + segment.length, 100))
        ax.plot(*points.T, color=colour, lw=2.8)
        s += segment.length
    ax.set_title(title, fontsize=10)


def rack(ax: Axes, drive: DriveDesign) -> None:
    """External tooth in the gear's frame, the rack in several positions."""
    profile, g = drive.profile("flexible_spline"), drive.drive
    r_pitch, alpha = 0.5 * g.teeth_fs * g.module, np.radians(g.pressure_angle)
    depth, half = g.dedendum_coef * g.module, 0.5 * np.pi / g.teeth_fs
    flank = rack_flank(alpha, depth, g.module)
    for k, psi in enumerate(ROLL):
        # fixed frame with the gear's axis as origin; the gear has turned clockwise by psi
        fixed = flank + (r_pitch * (half + psi), r_pitch)
        ax.plot(
            *turned(fixed, psi).T,
            color=NOTE,
            lw=1.3 if k == 10 else 0.5,
            alpha=1.0 if k == 10 else 0.6,
        )
    frame(ax, profile, r_pitch, "external tooth (flexible spline) and rack")
    label(
        ax,
        (1.95, r_pitch + 0.75),
        "rack, rolled by $r_P\\psi$\nwhile the gear turns by $\\psi$",
        fontsize=8,
    )
    involute = profile.point(0.45 * profile.segments[0].length)[0]
    fillet = profile.point(profile.segments[0].length + 0.5 * profile.segments[1].length)[0]
    leader(ax, (0.3, r_pitch + 0.25), "involute", tuple(involute), color="#2f7fd0")
    leader(
        ax,
        (0.45, r_pitch - 0.75),
        "fillet, cut by the rounded\ntip (radius cutter_radius)",
        tuple(fillet),
        color="#d07a20",
    )


def shaper(ax: Axes, drive: DriveDesign) -> None:
    """Internal tooth in the gear's frame, the shaper in several positions."""
    profile, g = drive.profile("ring_gear"), drive.drive
    r_pitch, alpha = 0.5 * g.teeth_rg * g.module, np.radians(g.pressure_angle)
    depth, r_g = g.dedendum_coef * g.module, 0.5 * SHAPER * g.module
    tooth, ratio = shaper_tooth(alpha, depth, g.module), g.teeth_rg / SHAPER
    tooth = tooth * (-1.0, 1.0)
    for k, psi in enumerate(ROLL):
        # the middle of the shaper's tooth is at pi / N_g from the middle of the gear's tooth at psi
        # = 0
        fixed = turned(tooth, -(np.pi / SHAPER + ratio * psi)) + (0.0, r_pitch - r_g)
        ax.plot(
            *turned(fixed, psi).T,
            color=NOTE,
            lw=1.3 if k == 10 else 0.5,
            alpha=1.0 if k == 10 else 0.6,
        )
    frame(ax, profile, r_pitch, "internal tooth (ring gear) and shaper")
    label(
        ax, (1.95, r_pitch - 0.85), "shaper, turned by\n$\\psi N / N_g$ about its axis", fontsize=8
    )
    involute = profile.point(0.45 * profile.segments[0].length)[0]
    fillet = profile.point(profile.segments[0].length + 0.5 * profile.segments[1].length)[0]
    leader(ax, (0.28, r_pitch - 0.2), "involute", tuple(involute), color="#2f7fd0")
    leader(ax, (0.45, r_pitch + 0.8), "fillet", tuple(fillet), color="#d07a20")


def involute() -> Figure:
    drive = design()
    figure, axes = canvases(8.0, 12.0, 2, 1)
    rack(axes[0], drive)
    shaper(axes[1], drive)
    for ax, r_pitch in zip(axes, np.divide(TEETH, 2.0)):
        ax.set_xlim(-0.7, 2.6)
        ax.set_ylim(r_pitch - 1.35, r_pitch + 1.35)
    figure.tight_layout()
    return figure


if __name__ == "__main__":
    run({"profile_involute": involute})
