"""The bearing of the output: its place, and the directions of forces and moment."""

from __future__ import annotations

import numpy as np
from _drafting import (
    CAM,
    INK,
    NOTE,
    RING,
    SPLINE,
    angle_mark,
    arc,
    axis_line,
    canvases,
    dimension,
    extension,
    label,
    reference,
    run,
)
from drive import fill, parts
from matplotlib.axes import Axes
from matplotlib.figure import Figure

BEARING = "#7a9e6b"
RADIUS, SIZE, BEHIND = 38.0, 9.0, 14.0
"""Middle and width of the drawn bearing, and its distance from the closed end, mm."""


def force(ax: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Thick arrow."""
    style = {"arrowstyle": "-|>", "color": INK, "lw": 2.0, "mutation_scale": 14}
    ax.annotate("", xy=end, xytext=start, arrowprops={**style, "shrinkA": 0, "shrinkB": 0})


def section(ax: Axes) -> None:
    """The cup drive along its axis, with a bearing behind the closed end."""
    design = reference()
    outlines = parts(design)
    colours = {"wall": SPLINE, "tooth": SPLINE, "ring tooth": RING, "ring": RING, "cam": CAM}
    for name, colour in colours.items():
        for side in (1.0, -1.0):
            fill(ax, outlines[name] * (1.0, side), colour)
    end = 0.5 * design.drive.face_width + design.cup.length
    middle, half = end + BEHIND, 0.5 * SIZE
    # output shaft, from the closed end through the bearing
    box = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    inner = RADIUS - half
    shaft = (0.5 * (BEHIND + 12.0), inner)
    fill(ax, box * shaft + (end + shaft[0], 0.0), SPLINE, alpha=0.35)
    for side in (1.0, -1.0):
        centre = np.array([middle, side * RADIUS])
        fill(ax, box * half + centre, BEARING)
        for cross in ((1.0, 1.0), (1.0, -1.0)):
            ends = np.array([-1.0, 1.0])[:, None] * half * np.array(cross) + centre
            ax.plot(*ends.T, color=INK, lw=0.7)
        fill(ax, box * (half, 3.0) + (middle, side * (RADIUS + half + 3.0)), RING)
    axis_line(ax, (-20.0, 0.0), (middle + 48.0, 0.0))
    label(ax, (middle + 50.0, 0.0), "z", color=INK, fontsize=10)
    extension(ax, (0.0, -66.0), (0.0, -82.0))
    extension(ax, (middle, -RADIUS - half - 8.0), (middle, -82.0))
    dimension(ax, (0.0, -80.0), (middle, -80.0), "position")
    force(ax, (middle, RADIUS + half + 7.0), (middle, RADIUS + half + 26.0))
    label(ax, (middle, RADIUS + half + 31.0), "radial_force", color=INK)
    force(ax, (middle + 12.0, -8.0), (middle + 44.0, -8.0))
    label(ax, (middle + 46.0, -14.0), "axial_force", color=INK)
    around = arc((middle, 0.0), 26.0, -60.0, 60.0)
    ax.plot(*around.T, color=INK, lw=2.0)
    force(ax, tuple(around[-4]), tuple(around[-1]))
    label(ax, (middle + 36.0, 24.0), "tilting_moment", color=INK)
    label(ax, (0.5 * end, -88.0), "flexible spline as the output", color=INK)


def along_axis(ax: Axes) -> None:
    """Directions, seen from positive z."""
    for radius in (RADIUS - 0.5 * SIZE, RADIUS + 0.5 * SIZE):
        ax.plot(*arc((0.0, 0.0), radius, 0.0, 360.0, 361).T, color=INK, lw=0.8)
    axis_line(ax, (-52.0, 0.0), (52.0, 0.0))
    axis_line(ax, (0.0, -52.0), (0.0, 62.0))
    label(ax, (0.0, 66.0), "+y", color=INK, fontsize=10)
    label(ax, (56.0, 0.0), "+x", color=INK, fontsize=10)
    for degrees, reach, key, colour in (
        (30.0, 26.0, "radial_direction", INK),
        (75.0, 30.0, "tilting_direction", NOTE),
    ):
        at = np.array([-np.sin(np.radians(degrees)), np.cos(np.radians(degrees))])
        force(ax, (0.0, 0.0), tuple((reach + 26.0) * at))
        angle_mark(ax, (0.0, 0.0), reach, 90.0, 90.0 + degrees, "")
        label(ax, tuple((reach + 36.0) * at), key, color=colour)
    label(ax, (8.0, -62.0), "seen from positive z;\nthe axis leans to tilting_direction there")


def bearing() -> Figure:
    """Section and view along the axis."""
    figure, axes = canvases(11.0, 6.2, 1, 2, width_ratios=(1.5, 1.0))
    section(axes[0])
    along_axis(axes[1])
    return figure


if __name__ == "__main__":
    run({"output_bearing": bearing})
