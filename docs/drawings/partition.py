"""Tooth sectors, twofold symmetry and ownership by ranks."""

from __future__ import annotations

import matplotlib.pyplot as plt
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
    label,
    leader,
    reference,
    run,
)
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from swgpar.fem.partition import split
from swgpar.meshing import build_sector_meshes
from swgpar.meshing.recipe import load_recipe
from swgpar.meshing.sector import SectorMesh

RANKS = ("#4c78a8", "#f2a65a", "#54a24b")
N_FS, N_RG = 24, 26
"""Teeth of the schematic drawing."""


def draw_sector(ax: Axes, mesh: SectorMesh, colour: str, title: str) -> None:
    """Cross-section of one sector with the nodes that it shares with its neighbours."""
    nodes = mesh.coords[:, :2]
    quads = nodes[mesh.hexes[:, :4]]
    ax.add_collection(
        PolyCollection(quads, facecolors=colour, edgecolors=INK, linewidths=0.5, alpha=0.55)
    )
    for name, numbers, mark, shade in (
        ("cw_nodes: owned by this sector", mesh.cw_nodes, "o", "#2d9a57"),
        ("ccw_nodes: those of the next sector", mesh.ccw_nodes, "s", NOTE),
    ):
        ax.plot(*nodes[numbers].T, mark, color=shade, ms=4, label=name)
    for grid, name in zip(mesh.flanks, ("side +1", "side −1")):
        line = nodes[grid.nodes[:, 0]]
        ax.plot(*line.T, color="#8c4fb0", lw=2.2)
        middle = line[len(line) // 2]
        label(ax, (middle[0] + 0.36 * grid.side, middle[1] + 0.12), name, color="#8c4fb0")
    ax.autoscale_view()
    ax.set_title(title, fontsize=10)
    ax.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, 0.0), frameon=False)


def sectors() -> Figure:
    """One sector of both gears, plane model."""
    design = reference("plane_half_turn")
    meshes = build_sector_meshes(design.geometry, load_recipe("plane_coarse"))
    figure, axes = canvases(9.0, 5.6, 1, 2)
    draw_sector(
        axes[0], meshes["flexible_spline"], SPLINE, "sector of the flexible spline (plane_coarse)"
    )
    draw_sector(axes[1], meshes["ring_gear"], RING, "sector of the ring gear (plane_coarse)")
    figure.tight_layout()
    return figure


def ring_of_sectors(ax: Axes, n: int, inner: float, outer: float, phase: float) -> None:
    """Sectors of one body: modelled ones in the colours of three ranks, images pale."""
    starts = split(n // 2, 3)
    half = 180.0 / n
    for k in range(n):
        middle = 90.0 + np.degrees(phase) + k * 360.0 / n
        edge = np.concatenate([arc((0, 0), outer, middle - half, middle + half, 12)])
        back = arc((0, 0), inner, middle + half, middle - half, 12)
        image = k >= n // 2
        rank = int(np.searchsorted(starts, k % (n // 2), side="right")) - 1
        ax.fill(
            *np.concatenate([edge, back]).T,
            fc=RANKS[rank],
            alpha=0.18 if image else 0.85,
            ec=INK,
            lw=0.6,
        )
        at = arc((0, 0), 0.5 * (inner + outer), middle, middle, 1)[0]
        ax.text(
            at[0],
            at[1],
            str(k % (n // 2)),
            ha="center",
            va="center",
            fontsize=7,
            color="#888888" if image else INK,
        )


def ownership() -> Figure:
    """Half the drive on three ranks."""
    figure, ax = canvas(9.5, 8.2)
    ring_of_sectors(ax, N_FS, 6.2, 7.4, 0.0)
    ring_of_sectors(ax, N_RG, 8.0, 9.2, np.pi / N_RG)
    axis_line(ax, (0, -10.2), (0, 10.2))
    label(ax, (0.0, 10.6), "+y", color=INK)
    angle = 90.0 - 180.0 / N_FS
    ax.plot(
        *np.transpose([arc((0, 0), 4.6, angle, angle, 1)[0], arc((0, 0), 7.8, angle, angle, 1)[0]]),
        color=NOTE,
        lw=1.3,
    )
    ax.plot(
        *-np.transpose(
            [arc((0, 0), 4.6, angle, angle, 1)[0], arc((0, 0), 7.8, angle, angle, 1)[0]]
        ),
        color=NOTE,
        lw=1.3,
    )
    leader(
        ax,
        (-2.4, 0.8),
        "modelled half: chain of\nsectors, numbered\ncounter-clockwise",
        (-6.0, 1.2),
        color=INK,
    )
    leader(
        ax,
        (2.7, 1.0),
        "images: the modelled\nhalf turned by 180°,\nfactors (−1, −1, 1)",
        (6.0, 1.4),
        color=INK,
    )
    last = arc((0, 0), 6.1, 90.0 + 180.0 - 180.0 / N_FS, 90.0 + 180.0 - 180.0 / N_FS, 1)[0]
    leader(
        ax, (0.0, -3.3), "the sector after the last one\nis sector 0, turned by 180°", tuple(last)
    )
    for rank, colour in enumerate(RANKS):
        ax.fill([], [], fc=colour, ec=INK, label=f"rank {rank}")
    label(ax, (0.0, 3.6), "inside: flexible spline\noutside: ring gear", color=INK)
    ax.legend(fontsize=9, loc="lower right", frameon=False)
    ax.set_xlim(-10.2, 10.8)
    ax.set_ylim(-10.4, 11.0)
    figure.tight_layout()
    return figure


def chain() -> Figure:
    """Which sectors of a chain a rank sees: its own, the one before and the one after."""
    figure, ax = plt.subplots(figsize=(10.0, 2.6))
    ax.axis("off")
    starts = split(12, 3)
    for k in range(12):
        rank = int(np.searchsorted(starts, k, side="right")) - 1
        ax.fill([k, k + 1, k + 1, k], [0, 0, 1, 1], fc=RANKS[rank], alpha=0.85, ec=INK)
        ax.text(k + 0.5, 0.5, str(k), ha="center", va="center", fontsize=10)
    first, end = int(starts[1]), int(starts[2])
    for low, high, text, y in (
        (first, end, "owned by rank 1: rows of residual and tangent, stress", 1.25),
        (first - 1, end, "their elements are assembled by rank 1", 1.75),
        (first - 1, end + 1, "seen by rank 1: nodal averages of stress", 2.25),
    ):
        ax.annotate(
            "", xy=(high, y), xytext=(low, y), arrowprops={"arrowstyle": "<|-|>", "color": NOTE}
        )
        ax.text(high + 0.15, y, text, va="center", fontsize=9, color=NOTE)
    ax.set_xlim(-0.2, 16.5)
    ax.set_ylim(-0.1, 2.5)
    figure.tight_layout()
    return figure


if __name__ == "__main__":
    run({"sectors": sectors, "ownership": ownership, "ownership_chain": chain})
