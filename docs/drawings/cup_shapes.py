"""Shapes of the flexible spline behind its teeth."""

from __future__ import annotations

from typing import Any

import numpy as np
from _drafting import INK, NOTE, RING, SPLINE, axis_line, canvases, label, leader, reference, run
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from swgpar.checks.cup_checks import check_cup
from swgpar.design.cup_section import Cup
from swgpar.design.drive_design import DriveDesign
from swgpar.meshing.cup import meridian
from swgpar.meshing.recipe import CupRecipe

CONTOUR = [
    {"distance": 6.0, "thickness": 0.8, "rounding": 30.0},
    {"distance": 12.0, "thickness": 0.6, "rounding": 30.0},
    {"distance": 26.0, "thickness": 0.6, "rounding": 60.0},
    {"distance": 36.0, "thickness": 1.6, "rounding": 10.0},
]
BOLTED = {"attachment": "bolted", "bolts": 12, "bolt_circle": 60.0, "washer_diameter": 8.0}
CLAMPED = {"attachment": "clamped", "clamping_radius": 68.0}
CASES: dict[str, dict[str, Any]] = {
    "contour": {
        "length": 40.0,
        "fillet_radius": 3.0,
        "inner_radius": 20.0,
        "end_thickness": 2.5,
        "contour": CONTOUR,
    },
    "short, bolted": {
        "length": 20.0,
        "fillet_radius": 3.0,
        "inner_radius": 20.0,
        "end_thickness": 1.5,
        **BOLTED,
    },
    "hat, clamped": {
        "shape": "hat",
        "length": 40.0,
        "fillet_radius": 3.0,
        "flange_radius": 80.0,
        "end_thickness": 2.0,
        **CLAMPED,
    },
}


def section(ax: Axes, design: DriveDesign, title: str) -> None:
    """Half section with the teeth and what is attached."""
    ends = 60 if design.cup.end_contour else 1
    lines = meridian(design.geometry.cup, CupRecipe(cylinder=60, fillet=24, closed_end=ends))
    half, profile = 0.5 * design.drive.face_width, design.profile("flexible_spline")
    wall = np.concatenate([[(design.inner_radius, -half)], lines.inner, lines.outer[::-1]])
    teeth = np.array([(profile.r_tip_circle, half), (profile.r_tip_circle, -half)])
    ax.add_patch(
        Polygon(np.concatenate([wall, teeth])[:, ::-1], fc=SPLINE, ec=INK, lw=0.8, alpha=0.85)
    )
    axis_line(ax, (-half - 4.0, 0.0), (56.0, 0.0))
    cup = design.cup
    low, high = sorted(
        {
            "bolted": (
                lambda: (
                    0.5 * (cup.bolt_circle - cup.washer_diameter),
                    0.5 * (cup.bolt_circle + cup.washer_diameter),
                )
            ),
            "clamped": lambda: (cup.clamping_radius, cup.edge),
            "edge": lambda: (cup.edge, cup.edge),
        }[cup.attachment]()
    )
    near, far = design.cup_sizes.wall.faces_at(0.5 * (low + high))
    for z in (near - 2.5, far) if high > low else ():
        ax.add_patch(Rectangle((z, low), 2.5, high - low, fc=RING, ec=INK, lw=0.6, hatch="////"))
    ax.set(xlim=(-half - 5.0, 58.0), ylim=(-4.0, 88.0), aspect="equal")
    ax.set_title(title, fontsize=10)
    ax.axis("off")


def checked(cup: dict[str, Any]) -> DriveDesign:
    """The drive of the drawings with another cup; raises InputError where it does not fit."""
    design = reference().model_copy(
        update={"cup": Cup.model_validate({"thickness_coef": 0.8, **cup})}
    )
    check_cup(design)
    return design


def shapes() -> Figure:
    """Contour, short cup, silk hat."""
    figure, axes = canvases(11.0, 5.4, columns=3)
    for ax, (title, cup) in zip(axes, CASES.items(), strict=True):
        section(ax, checked(cup), title)
    leader(axes[0], (8.0, 46.0), "cup.contour", (19.0, 58.3), color=NOTE)
    leader(axes[0], (8.0, 30.0), "cup.end_thickness", (43.5, 36.0), color=NOTE)
    leader(axes[1], (38.0, 74.0), "washer_diameter", (27.0, 31.0), color=NOTE)
    leader(axes[2], (8.0, 74.0), "flange_radius", (44.0, 80.0), color=NOTE)
    label(axes[2], (20.0, 40.0), "hatched: rigid", color=INK)
    return figure


ENDS: dict[str, dict[str, Any]] = {
    "diaphragm and hub, clamped": {
        "length": 40.0,
        "fillet_radius": 4.0,
        "inner_radius": 10.0,
        "end_thickness": 2.5,
        "end_contour": [
            {"radius": 48.0, "thickness": 1.0, "rounding": 10.0},
            {"radius": 31.0, "thickness": 1.0, "rounding": 4.0},
            {"radius": 26.0, "thickness": 6.0, "rounding": 2.0},
        ],
        "attachment": "clamped",
        "clamping_radius": 24.0,
    },
    "dished": {
        "length": 40.0,
        "fillet_radius": 4.0,
        "inner_radius": 15.0,
        "end_thickness": 1.5,
        "end_contour": [
            {"radius": 46.0, "distance": 40.0, "near_radius": 46.87, "near_distance": 38.5},
            {"radius": 41.0, "distance": 31.34, "near_radius": 41.87, "near_distance": 29.84},
        ],
    },
    "flange with a step, bolted": {
        "shape": "hat",
        "length": 40.0,
        "fillet_radius": 4.0,
        "flange_radius": 84.0,
        "end_thickness": 1.5,
        "end_contour": [
            {"radius": 69.0, "thickness": 1.5, "rounding": 2.0},
            {"radius": 72.0, "thickness": 4.5, "rounding": 1.0},
        ],
        "attachment": "bolted",
        "bolts": 12,
        "bolt_circle": 156.0,
        "washer_diameter": 8.0,
    },
}


def ends() -> Figure:
    """Contours of closed ends and of a flange."""
    figure, axes = canvases(11.0, 5.4, columns=3)
    for ax, (title, cup) in zip(axes, ENDS.items(), strict=True):
        section(ax, checked(cup), title)
    back = 0.5 * reference().drive.face_width
    leader(axes[0], (4.0, 42.0), "radius, thickness", (back + 39.0, 31.0), color=NOTE)
    leader(axes[0], (4.0, 30.0), "rounding", (back + 34.5, 25.5), color=NOTE)
    leader(axes[1], (-4.0, 30.0), "near_radius, near_distance", (back + 29.84, 41.87), color=NOTE)
    leader(axes[1], (4.0, 20.0), "distance", (back + 31.34, 28.0), color=NOTE)
    leader(axes[2], (4.0, 70.0), "near face", (back + 38.5, 67.0), color=NOTE)
    label(axes[2], (20.0, 40.0), "hatched: rigid", color=INK)
    return figure


if __name__ == "__main__":
    run({"cup_shapes": shapes, "end_contours": ends})
