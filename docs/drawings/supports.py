"""What holds the gears: bolts or a clamped ring of the cup, the housing of the ring gear."""

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
    plane_with,
    reference,
    run,
)
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from swgpar.design.cup_section import Cup
from swgpar.design.drive_design import DriveDesign

CUP = {
    "thickness_coef": 0.8,
    "length": 40.0,
    "fillet_radius": 3.0,
    "inner_radius": 20.0,
    "end_thickness": 2.5,
}
BOLTED = {"attachment": "bolted", "bolts": 8, "bolt_circle": 64.0, "washer_diameter": 11.0}
CLAMPED = {"attachment": "clamped", "clamping_radius": 34.0}


def with_cup(cup: dict[str, object]) -> DriveDesign:
    """The cup reference drive with this cup."""
    return reference().model_copy(update={"cup": Cup.model_validate({**CUP, **cup})})


def closed_end(ax: Axes, design: DriveDesign, title: str) -> None:
    """The closed end, seen along the axis, with what is held."""
    cup = design.cup
    outer = design.inner_radius + cup.thickness_coef * design.flexible_spline.rim
    for radius, colour in ((outer, SPLINE), (cup.inner_radius, "white")):
        ax.fill(*arc((0.0, 0.0), radius, 0.0, 360.0, 361).T, fc=colour, ec=INK, lw=0.8)
    places = np.linspace(-outer, outer, 701)
    grid = np.stack(np.meshgrid(places, places), axis=-1)
    held = cup.is_attached(grid) & (np.hypot(*np.moveaxis(grid, -1, 0)) > cup.inner_radius)
    ax.contourf(places, places, held, levels=[0.5, 1.5], colors=[RING])
    ax.contour(places, places, held, levels=[0.5], colors=[INK], linewidths=0.8)
    axis_line(ax, (0.0, -outer - 5.0), (0.0, outer + 5.0))
    axis_line(ax, (-outer - 5.0, 0.0), (outer + 5.0, 0.0))
    at = np.array([np.cos(np.radians(-20.0)), np.sin(np.radians(-20.0))])
    dimension(ax, (0.0, 0.0), tuple(cup.inner_radius * at), "inner_radius")
    ax.set_title(title, fontsize=10)


def joint(ax: Axes, design: DriveDesign) -> None:
    """Section through a bolt: closed end between washer and flange, and what it puts on the
    flange."""
    cup, half, wide = design.cup, 0.5 * design.cup.end_thickness, 15.0
    washer, shank = 0.5 * cup.washer_diameter, 2.2
    parts = (
        ((-wide, -half - 6.0), 2.0 * wide, 6.0, RING),
        ((-wide, -half), 2.0 * wide, 2.0 * half, SPLINE),
        ((-washer, half), 2.0 * washer, 1.2, "white"),
        ((-1.7 * shank, half + 1.2), 3.4 * shank, 3.2, "white"),
        ((-shank, -half - 6.0), 2.0 * shank, 6.0 + 2.0 * half + 1.2, "white"),
    )
    for corner, width, height, colour in parts:
        ax.add_patch(Rectangle(corner, width, height, fc=colour, ec=INK, lw=0.8))
    axis_line(ax, (0.0, -half - 8.0), (0.0, half + 6.5))
    y = half + 7.5
    dimension(ax, (-washer, y), (washer, y), "washer_diameter", at=(0.0, y + 1.2))
    label(ax, (-14.6, -half - 3.0), "flange, rigid", color=INK, ha="left")
    label(ax, (-14.6, 0.0), "closed end", color=INK, ha="left")
    arrow = {"arrowstyle": "-|>", "color": NOTE, "lw": 1.4}
    ax.annotate("", (-washer - 1.2, half + 3.6), (-washer - 1.2, half), arrowprops=arrow)
    ax.annotate("", (washer + 7.0, 0.0), (washer + 1.0, 0.0), arrowprops=arrow)
    for x, text in ((-washer - 2.0, "axial_N"), (washer + 4.0, "radial_N")):
        below = text == "radial_N"
        label(ax, (x, -half - 1.2 if below else half + 4.8), text, color=NOTE)
    bend = {**arrow, "connectionstyle": "arc3,rad=-0.45"}
    ax.annotate("", (washer + 4.0, half + 0.6), (washer - 0.6, half + 4.0), arrowprops=bend)
    label(ax, (washer + 4.6, half + 4.6), "tilting_Nmm", color=NOTE)
    label(ax, (0.0, -half - 10.5), "bolt_preload presses the end on the flange,", color=INK)
    label(ax, (0.0, -half - 12.5), "with joint_friction between both", color=INK)
    ax.set_ylim(-half - 16.0, half + 14.0)
    ax.set_title("loads of a joint, on the flange", fontsize=10)


def attachment() -> Figure:
    """Bolts, a clamped ring, and a joint."""
    figure, axes = canvases(15.0, 5.4, 1, 3)
    bolted, clamped = with_cup(BOLTED), with_cup(CLAMPED)
    closed_end(axes[0], bolted, 'attachment = "bolted": rigid where grey, under bolts')
    circle, washer = bolted.cup.bolt_circle, bolted.cup.washer_diameter
    axes[0].plot(*arc((0.0, 0.0), 0.5 * circle, 0.0, 360.0).T, color=NOTE, lw=0.6, ls="--")
    at = 0.5 * circle * np.array([np.sin(np.radians(45.0)), np.cos(np.radians(45.0))])
    dimension(axes[0], tuple(-at), tuple(at), "bolt_circle", at=tuple(-0.55 * at), rotation=45)
    x, y = 0.5 * washer, 0.5 * circle + washer
    dimension(axes[0], (-x, y), (x, y), "washer_diameter", at=(0.0, y + 4.0))
    label(axes[0], (16.0, 0.5 * circle + 2.0), "first bolt on +y", ha="left")
    closed_end(axes[1], clamped, 'attachment = "clamped": rigid where grey')
    at = clamped.cup.clamping_radius * np.array([-np.sin(0.9), np.cos(0.9)])
    dimension(axes[1], (0.0, 0.0), tuple(at), "clamping_radius", at=tuple(0.8 * at))
    joint(axes[2], bolted)
    return figure


def housing() -> Figure:
    """An eighth of the ring gear with its housing."""
    gear = {"housing": {"thickness": 3.0}}
    design = plane_with(drive={"teeth_fs": 40, "teeth_rg": 42}, ring_gear=gear)
    profile, rim = design.profile("ring_gear"), design.ring_gear.rim
    root, thickness = profile.r_root_circle, design.housing.thickness
    figure, ax = canvas(7.0, 4.6)
    half = np.pi / profile.n_teeth
    right = profile.point(np.linspace(0.0, profile.length, 60))
    one = np.concatenate([right[::-1] * (-1.0, 1.0), right]) @ (1.0, 1j)
    teeth = np.concatenate([one * np.exp(-2j * half * k) for k in range(-3, 4)])
    end = 90.0 - np.degrees(7.0 * half), 90.0 + np.degrees(7.0 * half)
    outer = arc((0.0, 0.0), root + rim, *end)
    inner = np.column_stack([teeth.real, teeth.imag])
    ax.fill(*np.concatenate([inner, outer]).T, fc=RING, ec=INK, lw=0.8)
    last = arc((0.0, 0.0), root + rim + thickness, *end)
    ax.fill(*np.concatenate([outer, last[::-1]]).T, fc="#d8c9a8", ec=INK, lw=0.8)
    middle = root + rim + 0.5 * thickness
    dimension(ax, (0.0, root), (0.0, root + rim), "ring_gear.rim", at=(2.4, root + 0.5 * rim))
    dimension(
        ax, (0.0, root + rim), (0.0, root + rim + thickness), "housing.thickness", at=(2.8, middle)
    )
    label(ax, (-6.5, middle - 0.9), "housing, bonded\nto the ring gear", color=INK)
    label(
        ax,
        (0.0, root + rim + thickness + 0.8),
        'outside = "free": the mean motion is held; "held": by a rigid frame',
        color=INK,
    )
    return figure


if __name__ == "__main__":
    run({"cup_attachment": attachment, "housing": housing})
