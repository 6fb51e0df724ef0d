"""Shapes of the flexible spline behind its teeth."""

from __future__ import annotations

from typing import Any

import numpy as np
from _drafting import INK, NOTE, RING, SPLINE, axis_line, canvases, label, leader, reference, run
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from swgpar.design.cup_section import Cup
from swgpar.design.drive_design import DriveDesign
from swgpar.meshing.cup import meridian
from swgpar.meshing.recipe import CupRecipe

CONTOUR = [
    {"distance": 6.0, "thickness": 0.8, "rounding": 30.0},
    {"distance": 12.0, "thickness": 0.6, "rounding": 30.0},
    {"distance": 26.0, "thickness": 0.6, "rounding": 60.0},
    {"distance": 36.0, "thickness": 1.6, "rounding": 20.0},
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
    lines = meridian(design.geometry.cup, CupRecipe(cylinder=60, fillet=24, closed_end=1))
    half, profile = 0.5 * design.drive.face_width, design.profile("flexible_spline")
    wall = np.concatenate([[(design.inner_radius, -half)], lines.inner, lines.outer[::-1]])
    teeth = np.array([(profile.r_tip_circle, half), (profile.r_tip_circle, -half)])
    ax.add_patch(
        Polygon(np.concatenate([wall, teeth])[:, ::-1], fc=SPLINE, ec=INK, lw=0.8, alpha=0.85)
    )
    axis_line(ax, (-half - 4.0, 0.0), (56.0, 0.0))
    cup, faces = design.cup, design.cup_sizes.wall.faces
    low, high = {
        "bolted": (
            lambda: (
                0.5 * (cup.bolt_circle - cup.washer_diameter),
                0.5 * (cup.bolt_circle + cup.washer_diameter),
            )
        ),
        "clamped": lambda: (cup.clamping_radius, cup.edge),
        "edge": lambda: (cup.edge, cup.edge),
    }[cup.attachment]()
    for z in (min(faces) - 2.5, max(faces)) if high > low else ():
        ax.add_patch(Rectangle((z, low), 2.5, high - low, fc=RING, ec=INK, lw=0.6, hatch="////"))
    ax.set(xlim=(-half - 5.0, 58.0), ylim=(-4.0, 88.0), aspect="equal")
    ax.set_title(title, fontsize=10)
    ax.axis("off")


def shapes() -> Figure:
    """Contour, short cup, silk hat."""
    figure, axes = canvases(11.0, 5.4, columns=3)
    for ax, (title, cup) in zip(axes, CASES.items(), strict=True):
        design = reference().model_copy(
            update={"cup": Cup.model_validate({"thickness_coef": 0.8, **cup})}
        )
        section(ax, design, title)
    leader(axes[0], (8.0, 46.0), "cup.contour", (19.0, 58.3), color=NOTE)
    leader(axes[0], (8.0, 30.0), "cup.end_thickness", (43.5, 36.0), color=NOTE)
    leader(axes[1], (38.0, 74.0), "washer_diameter", (27.0, 31.0), color=NOTE)
    leader(axes[2], (8.0, 74.0), "flange_radius", (44.0, 80.0), color=NOTE)
    label(axes[2], (20.0, 40.0), "hatched: rigid", color=INK)
    return figure


if __name__ == "__main__":
    run({"cup_shapes": shapes})
