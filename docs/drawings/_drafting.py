"""What the drawings have in common: colours, dimension lines, arcs, and files."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import matplotlib

from swgpar.checks.design_file import make_drive

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from swgpar.design.drive_design import DriveDesign
from swgpar.input.toml_file import read_toml

ROOT = Path(__file__).resolve().parents[2]
DRIVERS = ROOT / "drivers"

SPLINE = "#4c78a8"
RING = "#9d9d9d"
CAM = "#f2a65a"
INK = "#222222"
NOTE = "#b03030"
"""Colours of flexible spline, ring gear, wave generator, lines and dimensions."""

Point = tuple[float, float]


def canvas(width: float, height: float) -> tuple[Figure, Axes]:
    """Figure (inches) with axes of equal scale and no frame."""
    figure, axes = canvases(width, height)
    return figure, axes[0]


def canvases(
    width: float, height: float, rows: int = 1, columns: int = 1, **options: Any
) -> tuple[Figure, np.ndarray]:
    """Figure (inches) with several axes of equal scale and no frame: (columns,) in one row,
    (rows,) in one column, else (rows, columns)."""
    figure, every = plt.subplots(rows, columns, figsize=(width, height), **options)
    axes = np.atleast_1d(every)
    for ax in axes.ravel():
        ax.set_aspect("equal")
        ax.axis("off")
    return figure, axes


def dimension(
    ax: Axes, start: Point, end: Point, text: str, at: Point | None = None, **style: Any
) -> None:
    """Double arrow between two points with a text in its middle, or at another point."""
    arrow = {
        "arrowstyle": "<|-|>",
        "color": NOTE,
        "lw": 0.9,
        "shrinkA": 0,
        "shrinkB": 0,
        "mutation_scale": 7,
    }
    ax.annotate("", xy=end, xytext=start, arrowprops=arrow)
    middle = at or (0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1]))
    label(ax, middle, text, **style)


def label(ax: Axes, at: Point, text: str, **style: Any) -> None:
    """Text on a white ground."""
    box = {"boxstyle": "square,pad=0.12", "fc": "white", "ec": "none", "alpha": 0.85}
    ax.text(
        *at,
        text,
        **{"ha": "center", "va": "center", "fontsize": 8, "color": NOTE, "bbox": box, **style},
    )


def leader(ax: Axes, at: Point, text: str, to: Point, **style: Any) -> None:
    """Text at one point with a thin arrow to another one."""
    box = {"boxstyle": "square,pad=0.12", "fc": "white", "ec": "none", "alpha": 0.85}
    arrow = {
        "arrowstyle": "-|>",
        "color": NOTE,
        "lw": 0.7,
        "shrinkA": 0,
        "shrinkB": 0,
        "mutation_scale": 6,
    }
    style = {"ha": "center", "va": "center", "fontsize": 8, "color": NOTE, "bbox": box, **style}
    ax.annotate(text, xy=to, xytext=at, arrowprops=arrow, **style)


def extension(ax: Axes, *points: Point, **style: Any) -> None:
    """Thin line through points, such as an extension line of a dimension."""
    ax.plot(*np.transpose(points), **{"color": NOTE, "lw": 0.5, **style})


def axis_line(ax: Axes, start: Point, end: Point) -> None:
    """Chain-dotted centre line."""
    ax.plot(*np.transpose([start, end]), color=INK, lw=0.7, dashes=(12, 3, 2, 3))


def arc(center: Point, radius: float, start: float, end: float, n: int = 100) -> np.ndarray:
    """Points (n, 2) of an arc; angles (degrees) from +x, counter-clockwise."""
    angle = np.radians(np.linspace(start, end, n))
    return np.column_stack([center[0] + radius * np.cos(angle), center[1] + radius * np.sin(angle)])


def angle_mark(
    ax: Axes, center: Point, radius: float, start: float, end: float, text: str, out: float = 1.12
) -> None:
    """Arc with an arrow at its end and a text beside its middle; degrees from +x."""
    points = arc(center, radius, start, end)
    ax.plot(*points.T, color=NOTE, lw=0.9)
    arrow = {
        "arrowstyle": "-|>",
        "color": NOTE,
        "lw": 0.9,
        "shrinkA": 0,
        "shrinkB": 0,
        "mutation_scale": 7,
    }
    ax.annotate("", xy=points[-1], xytext=points[-4], arrowprops=arrow)
    label(ax, tuple(arc(center, out * radius, start, end, 3)[1]), text)


def turned(points: np.ndarray, angle: float) -> np.ndarray:
    """Points (n, 2) turned counter-clockwise about the origin by `angle` (rad)."""
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


def reference(name: str = "cup_45deg") -> DriveDesign:
    """The design of a file in drivers/."""
    return make_drive(read_toml(DRIVERS / f"{name}.toml"))


def plane_with(**sections: Mapping[str, object]) -> DriveDesign:
    """The plane reference drive with other values of some sections; a profile or a cam is replaced
    as a whole."""
    table = read_toml(DRIVERS / "plane_half_turn.toml")
    for name, values in sections.items():
        table[name] = dict(values) if name == "wave_generator" else {**table[name], **values}
    return make_drive(table)


def run(drawings: Mapping[str, Callable[[], Figure]]) -> None:
    """Write all drawings as PNG files into the folder of the command line, or else into
    docs/_generated."""
    options = argparse.ArgumentParser(description=f"Draw {', '.join(drawings)}.")
    options.add_argument("folder", type=Path, nargs="?", default=ROOT / "docs" / "_generated")
    folder: Path = options.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    for name, draw in drawings.items():
        figure = draw()
        figure.savefig(folder / f"{name}.png", dpi=120, bbox_inches="tight", pad_inches=0.1)
        plt.close(figure)
