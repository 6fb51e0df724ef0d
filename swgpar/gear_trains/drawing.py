"""Frames of figures: panels above one another."""

from __future__ import annotations

from typing import TYPE_CHECKING

from swgpar.results.figure_set import panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def axes(title: str, xlabel: str, *ylabels: str) -> tuple[Figure, list[Axes]]:
    """A figure with one panel for each label of a vertical axis."""
    figure, found = panels(len(ylabels), 7.0, 2.4 + 2.2 * len(ylabels), shared=True)
    figure.suptitle(title, fontsize=11)
    for axis, label in zip(found, ylabels, strict=True):
        axis.set_ylabel(label)
    found[-1].set_xlabel(xlabel)
    return figure, found
