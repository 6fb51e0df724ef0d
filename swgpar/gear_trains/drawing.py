"""Frames of figures: panels above one another, and their files."""

from __future__ import annotations

from pathlib import Path
from typing import Any


def axes(title: str, xlabel: str, *ylabels: str) -> tuple[Any, list[Any]]:
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


def save(figure: Any, out: Path, name: str) -> Path:
    """Write a figure into out/figures."""
    path = out / "figures" / f"{name}.png"
    figure.savefig(path, dpi=150)
    return path
