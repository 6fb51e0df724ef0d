"""Phases of a Newton solve."""

from __future__ import annotations

import matplotlib.pyplot as plt
from _drafting import INK, NOTE, RING, SPLINE, run
from matplotlib.axes import Axes
from matplotlib.figure import Figure

Box = tuple[float, float]


def box(ax: Axes, at: Box, text: str, colour: str) -> None:
    style = {"boxstyle": "round,pad=0.5", "fc": "white", "ec": colour, "lw": 1.8}
    ax.text(*at, text, ha="center", va="center", fontsize=9, color=INK, bbox=style, zorder=3)


def arrow(
    ax: Axes, start: Box, end: Box, text: str = "", at: Box | None = None, bend: float = 0.0
) -> None:
    style = {"arrowstyle": "-|>", "color": NOTE, "lw": 1.1, "connectionstyle": f"arc3,rad={bend}"}
    ax.annotate("", xy=end, xytext=start, arrowprops={**style, "shrinkA": 0, "shrinkB": 0})
    if text:
        middle = at or (0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1]))
        ground = {"boxstyle": "square,pad=0.1", "fc": "white", "ec": "none"}
        ax.text(
            middle[0],
            middle[1],
            text,
            ha="center",
            va="center",
            fontsize=8,
            color=NOTE,
            bbox=ground,
            zorder=4,
        )


def phases() -> Figure:
    """From the start of a solve to its result."""
    figure, ax = plt.subplots(figsize=(10.0, 6.0))
    ax.axis("off")
    ax.set_xlim(-0.6, 11.2)
    ax.set_ylim(0.3, 6.7)
    box(ax, (0.6, 5.6), "start:\ncontact search", RING)
    box(ax, (3.6, 5.6), "SOFTENED\nreduced penalties", SPLINE)
    box(ax, (3.6, 3.4), "FULL\nfull penalties,\ncells placed anew", SPLINE)
    box(ax, (8.6, 5.6), "FROZEN\ncells and friction bounds\nfrozen, descending search", SPLINE)
    box(ax, (3.6, 1.0), "AUGMENTED\nmultipliers", SPLINE)
    box(ax, (9.4, 1.0), "accepted", "#2d9a57")
    box(ax, (9.4, 3.4), "failed:\nhalve the increment", NOTE)
    arrow(ax, (1.45, 5.6), (2.6, 5.6), "contact is\nestablished,\nor start of a cup", (2.02, 6.2))
    arrow(ax, (0.6, 5.15), (2.5, 3.7), "otherwise", (1.3, 4.3))
    arrow(ax, (3.6, 5.2), (3.6, 4.0), "converged")
    arrow(ax, (2.9, 4.0), (2.9, 5.2), "contact\nspreads\nslowly", (2.45, 4.75))
    arrow(ax, (4.7, 3.75), (7.0, 5.2), "active set returns,\nor residual sticks", (5.5, 4.75))
    arrow(ax, (7.6, 5.05), (4.75, 3.5), "converged: place anew", (6.7, 4.05))
    arrow(ax, (9.6, 6.15), (7.7, 6.15), "update friction bounds", (8.7, 6.55), 0.35)
    arrow(ax, (2.5, 3.15), (2.5, 3.65), "", None, -1.4)
    ax.text(
        1.35,
        3.1,
        "overlooked contact:\nsearch again",
        ha="center",
        va="center",
        fontsize=8,
        color=NOTE,
    )
    arrow(ax, (3.6, 2.8), (3.6, 1.4), "penetration\ntoo large")
    arrow(ax, (2.6, 0.8), (2.6, 1.2), "", None, -1.4)
    ax.text(1.45, 1.0, "still\ntoo large", ha="center", va="center", fontsize=8, color=NOTE)
    arrow(
        ax,
        (4.6, 1.0),
        (8.7, 1.0),
        "penetration small enough,\nor augmentation failed: state before it",
    )
    arrow(ax, (4.75, 3.1), (8.8, 1.3), "penetration small enough", (6.6, 2.25))
    arrow(ax, (4.85, 3.35), (8.3, 3.35), "no solution", (7.2, 3.35))
    figure.tight_layout()
    return figure


if __name__ == "__main__":
    run({"newton_phases": phases})
