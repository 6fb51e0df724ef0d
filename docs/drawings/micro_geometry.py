"""Crowning of cam and flanks, and the sense of the cam's slope, exaggerated."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
from _drafting import CAM, INK, NOTE, SPLINE, dimension, label, leader, reference, run
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.micro_geometry import crowning


def cam_height(design: DriveDesign, z: np.ndarray, minor: bool = False) -> np.ndarray:
    """Radial height (n,) mm of the modified cam's surface over the cam curve, at the major or the
    minor axis."""
    surface = design.cam_surface()
    point = (design.minor_semi_axis, 0.0) if minor else (0.0, design.major_semi_axis)
    level, _, _ = surface.evaluate(np.column_stack([np.tile(point, (len(z), 1)), z]))
    return -level


def with_micro(design: DriveDesign, **values: float) -> DriveDesign:
    """The design with other micro-geometry."""
    base = {"wg_crowning": 0.0, "wg_slope": 0.0, "fs_crowning": 0.0}
    return design.model_copy(
        update={"micro_geometry": design.micro_geometry.model_copy(update={**base, **values})}
    )


def frame(ax: Axes, half: float, title: str) -> None:
    """Axes of one panel: z across, micrometres up."""
    ax.set_title(title, fontsize=10)
    ax.axhline(0.0, color=INK, lw=0.6, dashes=(12, 3, 2, 3))
    ax.axvline(0.0, color=INK, lw=0.6, dashes=(12, 3, 2, 3))
    ax.set_xlim(-half - 1.2, half + 1.2)
    ax.set_xlabel("z, mm  (open end on the left, closed end on the right)", fontsize=8)
    ax.set_ylabel("radial height over the cam curve, µm", fontsize=8)
    ax.tick_params(labelsize=8)


def slope() -> Figure:
    """Sense of the slope: wg_slope above and below zero, at the major and the minor axis."""
    design = reference()
    half, s = 0.5 * design.wave_generator.face_width, 0.09
    z = np.linspace(-half, half, 201)
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4.2))
    for ax, minor, title in zip(
        axes, (False, True), ("major axis, θ = 0 and 180°", "minor axis, θ = 90 and 270°")
    ):
        frame(ax, half, title)
        for sign, colour, name in ((1, CAM, "wg_slope = +0.09"), (-1, SPLINE, "wg_slope = −0.09")):
            height = 1e3 * cam_height(with_micro(design, wg_slope=sign * s), z, minor)
            ax.plot(z, height, color=colour, lw=2.2, label=name)
        cone = (
            -1e3
            * 0.5
            * design.deflection
            / (design.cup.length + half)
            * z
            * (-1.0 if minor else 1.0)
        )
        ax.plot(z, cone, color=INK, lw=1.0, ls="--", label="straight cone of the deflected cup")
        ax.set_ylim(-130, 130)
        ax.legend(fontsize=8, loc="upper center" if minor else "lower center")
    leader(
        axes[0],
        (-2.2, 112.0),
        "s > 0 raises the cam under the open end",
        (-half + 0.1, 91.0),
        fontsize=8,
    )
    leader(
        axes[1],
        (-1.6, -115.0),
        "and lowers it there at the minor axis",
        (-half + 0.1, -89.0),
        fontsize=8,
    )
    figure.suptitle(
        r"slope: radial movement $-s\,(2z/F_w)\cos 2\theta$ of the cam's surface", fontsize=11
    )
    figure.tight_layout()
    return figure


def crowned() -> Figure:
    """Crowning of the cam (parabolic and circular) and of a flank."""
    design = reference()
    half = 0.5 * design.wave_generator.face_width
    z = np.linspace(-half, half, 201)
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4.2))
    frame(axes[0], half, "cam: crowning, and crowning with slope")
    axes[0].fill_between(
        z, -260, 1e3 * cam_height(with_micro(design, wg_crowning=0.1), z), color=CAM, alpha=0.45
    )
    both = 1e3 * cam_height(with_micro(design, wg_crowning=0.1, wg_slope=0.09), z)
    axes[0].plot(
        z, both, color=NOTE, lw=1.6, label="wg_crowning = 0.1, wg_slope = 0.09, major axis"
    )
    axes[0].plot(
        z,
        1e3 * cam_height(with_micro(design, wg_crowning=0.1), z),
        color=INK,
        lw=1.4,
        label="wg_crowning = 0.1",
    )
    dimension(axes[0], (half + 0.4, 0.0), (half + 0.4, -100.0), "", at=(half, 0.0))
    label(axes[0], (half + 0.1, 22.0), "wg_crowning", ha="right")
    axes[0].set_ylim(-260, 60)
    axes[0].legend(fontsize=8, loc="lower center")
    frame(axes[1], half, "crowning of both flanks of a spline tooth")
    axes[1].set_ylabel("material removed from the flank, along its normal, µm", fontsize=8)
    for shape, colour, style in (("parabolic", SPLINE, "-"), ("circular", NOTE, "--")):
        removed = crowning(0.045, z, 2.0 * half, shape)[0]
        axes[1].plot(
            z, -1e3 * removed, color=colour, ls=style, lw=2.0, label=f'crowning_shape = "{shape}"'
        )
    dimension(axes[1], (half + 0.4, 0.0), (half + 0.4, -45.0), "", at=(half, 0.0))
    label(axes[1], (half + 0.1, 4.0), "fs_crowning", ha="right")
    axes[1].set_ylim(-60, 12)
    axes[1].legend(fontsize=8, loc="lower center")
    figure.tight_layout()
    return figure


if __name__ == "__main__":
    run({"slope": slope, "crowning": crowned})
