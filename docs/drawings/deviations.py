"""Deviations of the gears, exaggerated."""

from __future__ import annotations

from functools import partial

import numpy as np
from _drafting import (
    INK,
    NOTE,
    RING,
    SPLINE,
    angle_mark,
    arc,
    axis_line,
    canvases,
    dimension,
    label,
    plane_with,
    run,
)
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from swgpar.profiles.flank_deviations import GearDeviations, direction

LARGE = 2.5
"""mm, of a deviation in the drawings: some micrometres in a drive."""


def moved_gear(ax: Axes, deviations: GearDeviations, title: str) -> None:
    """Centres of the teeth of a gear on its pitch circle, and where deviations move them."""
    r = deviations.r_pitch
    angle = 2.0 * np.pi * np.arange(len(deviations.pitch)) / len(deviations.pitch)
    shift = deviations.moved(np.array([[0.0, r]]), angle)[:, 0]
    turn = np.exp(1j * angle)
    ideal, moved = r * 1j * turn, (shift @ (1.0, 1j) + 1j * r) * turn
    ax.plot(*arc((0.0, 0.0), r, 0.0, 360.0).T, color=INK, lw=0.6, ls="--")
    ax.plot(ideal.real, ideal.imag, "o", color=INK, ms=2.5, mfc="white")
    around = np.append(moved, moved[0])
    ax.plot(around.real, around.imag, "o-", color=RING, ms=3.5, lw=1.2)
    axis_line(ax, (0.0, -r - 3.5), (0.0, r + 3.5))
    axis_line(ax, (-r - 3.5, 0.0), (r + 3.5, 0.0))
    ax.set_title(title, fontsize=10)


def pitch(ax: Axes) -> None:
    """Pitch errors of some teeth."""
    r, teeth = 20.0, 42
    errors = np.zeros(teeth)
    errors[[1, 39]] = [0.9, -0.8]
    moved_gear(ax, GearDeviations(r, errors), "pitch_errors")
    angle = 2.0 * np.pi * np.array([1, 39]) / teeth
    for at, error in zip(angle, (0.9, -0.8), strict=True):
        place = (r + 1.2) * direction(at + error / r)
        label(ax, tuple(place), f"{error:+g}", fontsize=8)
    label(ax, (0.0, 15.0), "above 0: counter-clockwise", fontsize=8)
    ax.set_xlim(-11.5, 11.5)
    ax.set_ylim(14.0, 22.5)


def eccentric(ax: Axes) -> None:
    """Eccentricity with its direction."""
    r, at = 20.0, np.radians(40.0)
    shift = LARGE * direction(at)
    moved_gear(ax, GearDeviations(r, np.zeros(42), shift=shift), "eccentricity, direction")
    dimension(ax, (0.0, 0.0), tuple(shift), "")
    label(ax, (-6.5, 1.0), "eccentricity")
    angle_mark(ax, (0.0, 0.0), 7.0, 90.0, 130.0, "direction", out=1.25)


def oval(ax: Axes) -> None:
    """Ovality with its direction."""
    r, at = 20.0, np.radians(30.0)
    gear = GearDeviations(r, np.zeros(42), ovality=2.0 * LARGE, oval_angle=at)
    moved_gear(ax, gear, "ovality: largest less smallest diameter")
    for turn, radius in ((at, r + 0.5 * LARGE), (at + 0.5 * np.pi, r - 0.5 * LARGE)):
        end = radius * direction(turn)
        dimension(ax, tuple(-end), tuple(end), "")
    angle_mark(ax, (0.0, 0.0), 8.0, 90.0, 120.0, "ovality_direction", out=1.3)


def tilted(ax: Axes) -> None:
    """Tilt of an axis, seen from the side."""
    for slope, colour in ((0.0, INK), (np.tan(np.radians(9.0)), NOTE)):
        ax.plot(
            [-8.0, 8.0], [-8.0 * slope, 8.0 * slope], color=colour, lw=1.0, dashes=(12, 3, 2, 3)
        )
    box = np.array([(-5.0, 6.0), (5.0, 6.0), (5.0, -6.0), (-5.0, -6.0), (-5.0, 6.0)])
    c, s = np.cos(np.radians(9.0)), np.sin(np.radians(9.0))
    ax.plot(*box.T, color=INK, lw=0.6, ls="--")
    ax.plot(*(box @ np.array([[c, s], [-s, c]])).T, color=RING, lw=1.6)
    angle_mark(ax, (0.0, 0.0), 6.8, 0.0, 9.0, "tilt", out=1.2)
    label(ax, (7.4, -0.8), "+z", color=INK)
    label(ax, (0.0, -7.6), "about the middle of the face width, here to tilt_direction = 0 (+y)")
    ax.set_xlim(-9.5, 9.5)
    ax.set_title("tilt", fontsize=10)


def profile(ax: Axes) -> None:
    """Slope and form deviation of a flank."""
    flank = plane_with().profile("flexible_spline")
    s = np.linspace(0.0, flank.length, 300)
    points, normal = flank.point(s), flank.normal(s)
    ax.plot(*points.T, color=INK, lw=0.8, ls="--", label="ideal flank")
    for name, deviations, colour in (
        ("profile_slope", partial(GearDeviations, profile_slope=0.18), SPLINE),
        ("profile_form", partial(GearDeviations, profile_form=0.12), NOTE),
    ):
        gear = deviations(60.0, np.zeros(1))
        height, _ = gear.profile_height(flank, s)
        ax.plot(*(points + height[:, None] * normal).T, color=colour, lw=1.6, label=f"{name} > 0")
    ax.legend(fontsize=8, loc="upper right", frameon=False)
    ax.set_xlim(0.2, 2.0)
    ax.set_title("profile_slope, profile_form", fontsize=10)


def deviations() -> Figure:
    """All kinds beside each other."""
    figure, axes = canvases(12.0, 8.0, 2, 3)
    for ax, draw in zip(axes.ravel(), (pitch, eccentric, oval, tilted, profile), strict=False):
        draw(ax)
    label(axes[1, 2], (0.5, 0.5), "dashed: without deviation", color=INK)
    figure.tight_layout()
    return figure


if __name__ == "__main__":
    run({"deviations": deviations})
