"""Figures that several gear trains have: panels above one another, means and deviations."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from swgpar.results.figure_set import panels, plot_line

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class MomentCurve:
    """Mean and standard deviation (n,), µm, at x (n,). style : of the line, as of matplotlib"""

    x: np.ndarray
    mean: np.ndarray
    deviation: np.ndarray
    label: str
    style: str = "-"


def axes(title: str, xlabel: str, *ylabels: str) -> tuple[Figure, list[Axes]]:
    """A figure with one panel for each label of a vertical axis."""
    figure, rows = panels(len(ylabels), 7.0, 2.4 + 2.2 * len(ylabels), shared=True)
    figure.suptitle(title, fontsize=11)
    for axis, label in zip(rows, ylabels, strict=True):
        axis.set_ylabel(label)
    rows[-1].set_xlabel(xlabel)
    return figure, rows


def draw_moments(title: str, xlabel: str, curves: Iterable[MomentCurve]) -> Figure:
    """Means above standard deviations."""
    figure, (upper, lower) = axes(title, xlabel, "mean (µm)", "standard deviation (µm)")
    for curve in curves:
        plot_line(upper, curve.x, curve.mean, curve.style, lw=1.0, label=curve.label)
        plot_line(lower, curve.x, curve.deviation, curve.style, lw=1.0)
    upper.legend(fontsize=8)
    return figure
