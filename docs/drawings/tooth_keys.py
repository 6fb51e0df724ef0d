"""Conjugate teeth with the swept area, teeth from points, and tip relief."""

from __future__ import annotations

import numpy as np
from _drafting import (
    INK,
    NOTE,
    RING,
    SPLINE,
    arc,
    axis_line,
    canvas,
    canvases,
    dimension,
    label,
    leader,
    plane_with,
    reference,
    run,
)
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from swgpar.profiles import Points, ToothProfile

COLOURS = ("#2f7fd0", "#8c4fb0", "#2d9a57", "#c2a11a", "#d07a20")


def slot(profile: ToothProfile) -> np.ndarray:
    """Flank (n, 2) mm of an internal gear, x across the slot from its centre line."""
    points = profile.point(np.linspace(0.0, profile.length, 400)) @ (1.0, 1j)
    turned = -np.conj(points * np.exp(1j * np.pi / profile.n_teeth))
    return np.column_stack([turned.real, turned.imag])


def moving(ax: Axes, pressure_angle: float, title: str) -> None:
    """A slot of a conjugate ring gear and the tooth that passes."""
    conjugate = {"type": "conjugate", "r_root": 0.2, "r_tip": 0.1, "backlash": 0.06}
    gear = {"c_P": 1.0, "c_l": 0.5, "profile": conjugate}
    design = plane_with(drive={"pressure_angle": pressure_angle}, ring_gear=gear)
    spline, ring = design.profile("flexible_spline"), design.profile("ring_gear")
    flank = spline.point(np.linspace(0.0, spline.length, 200)) @ (1.0, 1j)
    pose = design.tooth_motion().pose(np.radians(np.arange(-76.0, 77.0, 4.0)))
    for k in range(len(pose.c)):
        moved = pose.c[k] + np.exp(1j * pose.angle[k]) * flank
        ax.plot(moved.real, moved.imag, color=SPLINE, lw=0.5)
    wall = slot(ring)
    edge = np.array([(1.9, wall[-1, 1]), (1.9, wall[0, 1])])
    ax.fill(*np.concatenate([wall, edge]).T, fc=RING, alpha=0.5, lw=0)
    begins = (ring.breaks / ring.length * 399.0).astype(int)
    for name, first, last, colour in zip(
        (segment.name for segment in ring.segments), begins, begins[1:], COLOURS * 2
    ):
        part = wall[first : last + 1]
        ax.plot(*part.T, color=colour, lw=2.4)
        key = {"tip": "tip: r_tip", "root": "root: r_root"}.get(name, name)
        ax.text(1.35, float(part[:, 1].mean()), key, color=colour, fontsize=8, va="center")
    ax.set_xlim(-0.2, 2.1)
    ax.set_ylim(wall[:, 1].min() - 0.15, wall[:, 1].max() + 0.15)
    ax.set_title(title, fontsize=10)


def conjugate() -> Figure:
    """The envelope of the flank, and the boundary of the swept area where it is undercut."""
    figure, axes = canvases(9.5, 5.2, 1, 2)
    moving(axes[0], 20.0, "envelope, pressure angle of the spline 20°")
    moving(axes[1], 8.0, "swept area, pressure angle 8°")
    return figure


def points() -> Figure:
    """Points of a flank, the curve through them, and its joints."""
    design = reference("teeth/from_points").with_values(["ring_gear.c_P=1.0"])
    profile, keys = design.profile("ring_gear"), design.ring_gear.profile
    assert isinstance(keys, Points)
    figure, ax = canvas(6.5, 5.6)
    for begin, end, colour in zip(profile.breaks, profile.breaks[1:], COLOURS * 2):
        ax.plot(*profile.point(np.linspace(begin, end, 80)).T, color=colour, lw=2.4)
    given = np.abs(np.array(keys.points))
    half = np.pi / profile.n_teeth
    inside = given[np.arctan2(given[:, 0], given[:, 1]) < half]
    ax.plot(*inside.T, "o", color=INK, ms=3.5, mfc="white")
    for radius in keys.joints:
        line = arc(
            (0.0, 0.0), radius, 90.0 - np.degrees(0.15 * half), 90.0 - np.degrees(0.95 * half)
        )
        ax.plot(*line.T, color=NOTE, lw=0.6, ls="--")
    label(ax, (0.9, keys.joints[0] + 0.04), "joints: radii", ha="left")
    axis_line(ax, (0.0, profile.r_tip_circle - 0.1), (0.0, profile.r_root_circle + 0.1))
    middle = profile.point(0.5 * profile.length)[0]
    leader(ax, (1.2, middle[1] - 0.25), "points, or those of a file", tuple(middle))
    return figure


def relief() -> Figure:
    """A flank with and without tip relief, exaggerated."""
    amount, height = 0.15, 0.45
    plain, cut = (
        plane_with(flexible_spline={"tip_relief": each, "tip_relief_height": height}).profile(
            "flexible_spline"
        )
        for each in (0.0, amount)
    )
    figure, ax = canvas(5.6, 5.6)
    s = np.linspace(0.0, 1.0, 400)
    before, after = (each.point(s * each.length) for each in (plain, cut))
    ax.fill(
        *np.concatenate([[(0.0, after[0, 1])], after, [(0.0, after[-1, 1])]]).T,
        fc=SPLINE,
        alpha=0.35,
        lw=0,
    )
    ax.plot(*after.T, color=SPLINE, lw=2.2)
    ax.plot(*before.T, color=INK, lw=0.8, ls="--")
    top, base = plain.r_tip_circle, plain.r_tip_circle - height
    axis_line(ax, (0.0, before[-1, 1] - 0.1), (0.0, top + 0.2))
    for radius in (top, base):
        ax.plot([0.0, 1.25], [radius, radius], color=NOTE, lw=0.5)
    dimension(ax, (1.15, base), (1.15, top), "tip_relief_height\n(over the module)")
    tips = cut.point(0.0)[0][0], plain.point(0.0)[0][0]
    dimension(ax, (tips[0], top + 0.06), (tips[1], top + 0.06), "tip_relief", at=(0.45, top + 0.16))
    return figure


if __name__ == "__main__":
    run({"profile_conjugate": conjugate, "profile_points": points, "tip_relief": relief})
