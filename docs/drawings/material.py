"""Axes and layers of a printed part, and its modulus by direction."""

from __future__ import annotations

import numpy as np
from _drafting import (
    INK,
    NOTE,
    SPLINE,
    angle_mark,
    axis_line,
    canvases,
    dimension,
    label,
    leader,
    reference,
    run,
)
from drive import parts
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from swgpar.materials import Isotropic, Material, TransverselyIsotropic

PRINTED = TransverselyIsotropic(E=2400.0, nu=0.35, E_z=1500.0, nu_z=0.3, G_z=600.0)
SPACING = 0.8
"""mm between the drawn layers: some 0.1 to 0.2 in a part."""


def layers(ax: Axes) -> None:
    """Section of a cup's wall and tooth with layers square to its axis."""
    outlines = parts(reference())
    bodies = [outlines["wall"], outlines["tooth"]]
    for outline in bodies:
        body = Polygon(outline, fc=SPLINE, ec=INK, lw=0.9, alpha=0.35)
        ax.add_patch(body)
        for at in np.arange(outline[:, 0].min(), outline[:, 0].max(), SPACING):
            (line,) = ax.plot([at, at], [0.0, 80.0], color=SPLINE, lw=0.9)
            line.set_clip_path(body)
    low, high = bodies[0].min(axis=0)[0], bodies[0].max(axis=0)[0]
    top = outlines["tooth"][:, 1].max()
    corner = np.array([low + 12.0, 46.0])
    for way, name in (((7.0, 0.0), "z"), ((0.0, 7.0), "y: radial")):
        tip = corner + way
        ax.annotate(
            "", xy=tuple(tip), xytext=tuple(corner), arrowprops={"arrowstyle": "-|>", "color": NOTE}
        )
        label(ax, tuple(tip + 0.25 * np.array(way)), name)
    ax.plot(*corner, "o", mfc="white", mec=NOTE, ms=8)
    ax.plot(*corner, "x", color=NOTE, ms=5)
    label(ax, tuple(corner - (0.0, 2.4)), "x: tangential, away from the eye")
    leader(ax, (low + 22.0, top + 3.5), "layers: planes xy", (low + 7.0, top - 0.6))
    ax.set_xlim(low - 2.0, high + 2.0)
    ax.set_ylim(41.0, top + 6.0)
    ax.set_title('type = "transversely_isotropic"', fontsize=10)


def modulus(material: Material, angle: np.ndarray) -> np.ndarray:
    """Modulus of elasticity (MPa) along directions at `angle` (rad) from the layers."""
    c, s, zero = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    stress = np.column_stack([c * c, zero, s * s, zero, zero, c * s])
    return 1.0 / np.einsum("ni,ij,nj->n", stress, material.compliance(), stress)


def moduli(ax: Axes) -> None:
    """Modulus over the direction, as a distance from the middle."""
    angle = np.linspace(0.0, 2.0 * np.pi, 400)
    isotropic = Isotropic(E=PRINTED.E, nu=PRINTED.nu)
    for material, colour, style in ((isotropic, INK, "--"), (PRINTED, SPLINE, "-")):
        size = modulus(material, angle)
        ax.plot(size * np.cos(angle), size * np.sin(angle), color=colour, ls=style, lw=1.8)
    axis_line(ax, (-2900.0, 0.0), (2900.0, 0.0))
    axis_line(ax, (0.0, -2900.0), (0.0, 2900.0))
    dimension(ax, (0.0, 0.0), (PRINTED.E, 0.0), "E", at=(1000.0, -170.0))
    dimension(ax, (0.0, 0.0), (0.0, PRINTED.E_z), "E_z", at=(330.0, 1100.0))
    between = np.radians(45.0)
    low = float(modulus(PRINTED, np.array([between]))[0]) * np.array([np.cos(between)] * 2)
    leader(ax, (2350.0, 2300.0), "between: G_z, nu_z", tuple(low))
    angle_mark(ax, (0.0, 0.0), 650.0, 0.0, 45.0, "", out=1.3)
    label(ax, (2650.0, -170.0), "layers", color=INK)
    label(ax, (230.0, 2750.0), "z", color=INK)
    label(ax, (-1700.0, -2450.0), 'dashed: "isotropic", E', color=INK)
    ax.set_title("modulus by direction", fontsize=10)


def material() -> Figure:
    """Layers, and what they do to the modulus."""
    figure, axes = canvases(11.0, 5.2, columns=2, layout="constrained")
    layers(axes[0])
    moduli(axes[1])
    return figure


if __name__ == "__main__":
    run({"material": material})
