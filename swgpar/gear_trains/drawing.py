"""Frames of figures: panels above one another."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def axes(title: str, xlabel: str, *ylabels: str) -> tuple[Figure, list[Axes]]:
    """A figure with one panel for each label of a vertical axis."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 2.4 + 2.2 * len(ylabels)), layout="constrained")
    panels = list(figure.subplots(len(ylabels), 1, sharex=True, squeeze=False)[:, 0])
    figure.suptitle(title, fontsize=11)
    for axis, label in zip(panels, ylabels, strict=True):
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
    panels[-1].set_xlabel(xlabel)
    return figure, panels
