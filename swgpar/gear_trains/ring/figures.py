"""Figures of an elastic ring, drawn from the tables of a finished run."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from swgpar.gear_trains.drawing import MomentCurve, axes, draw_moments
from swgpar.gear_trains.result import TrainResult
from swgpar.gear_trains.ring.design import RingDesign
from swgpar.gear_trains.ring.quantities import POINTS
from swgpar.results.figure_set import Drawings, new_figure, plot_line
from swgpar.results.table import Columns

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ANGLE = "angle of the first load (rad)"

SCALE = 0.15
"""Largest displacement of a drawn mode over the radius."""


def drawings(result: TrainResult[RingDesign]) -> Drawings:
    """All figures of a run."""
    figures = {"mode_shapes": partial(_shapes, result)}
    if result.summary.design.moving_load is not None:
        figures |= {f"speeds_{name}": partial(_speeds, result, name) for name in POINTS}
        figures |= {f"monte_carlo_{name}": partial(_monte_carlo, result, name) for name in POINTS}
        figures["critical_speeds"] = partial(_critical, result)
    return figures


def _shapes(result: TrainResult) -> Figure:
    modes, table = result.tables["modes"], result.tables["mode_shapes"]
    count = sum(name.startswith("outward") for name in table)
    rows, angle = (count + 2) // 3, table["angle_rad"]
    figure = new_figure(figsize=(7.5, 2.6 * rows), layout="constrained")
    for k, axis in enumerate(figure.subplots(rows, 3, squeeze=False).ravel(), start=1):
        axis.set_axis_off()
        if k > count:
            continue
        outward, along = SCALE * table[f"outward_{k}"], SCALE * table[f"tangential_{k}"]
        axis.plot(np.cos(angle), np.sin(angle), color="0.7", lw=1.0)
        x = (1.0 + outward) * np.cos(angle) - along * np.sin(angle)
        y = (1.0 + outward) * np.sin(angle) + along * np.cos(angle)
        axis.plot(x, y, lw=1.5)
        axis.set_aspect("equal")
        axis.set_title(f"{modes['frequency_Hz'][k - 1]:.4g} Hz", fontsize=9)
    return figure


def _at_speed(table: Columns, point: str, speed: float, label: str, style: str) -> MomentCurve:
    rows = table["speed_rad_s"] == speed
    mean, deviation = (1e6 * table[f"{kind}_{point}_m"][rows] for kind in ("mean", "deviation"))
    return MomentCurve(table["angle_rad"][rows], mean, deviation, label, style)


def _speeds(result: TrainResult, point: str) -> Figure:
    table = result.history
    curves = [
        _at_speed(table, point, speed, f"{speed:g} rad/s", "-")
        for speed in dict.fromkeys(table["speed_rad_s"].tolist())
    ]
    return draw_moments(POINTS[point], ANGLE, curves)


def _monte_carlo(result: TrainResult, point: str) -> Figure:
    table, speed = result.tables["monte_carlo"], result.history["speed_rad_s"][0]
    mean, deviation = (1e6 * table[f"{kind}_{point}_m"] for kind in ("mean", "deviation"))
    curves = [
        MomentCurve(table["angle_rad"], mean, deviation, "Monte Carlo", "k"),
        _at_speed(result.history, point, speed, "mean and covariance", "C0--"),
    ]
    return draw_moments(f"{POINTS[point]}, {speed:g} rad/s", ANGLE, curves)


def _critical(result: TrainResult) -> Figure:
    table = result.tables["critical_speeds"]
    panels = ("mean over that of the first", "deviation over that of the first")
    title, speed = "largest displacements against the speed", table["speed_rad_s"]
    figure, (upper, lower) = axes(title, "speed (rad/s)", *panels)
    for k, (point, label) in enumerate(POINTS.items()):
        mean, deviation = table[f"mean_{point}_m"], table[f"deviation_{point}_m"]
        still, label_of_still = table[f"without_inertia_{point}_m"], None if k else "quasi-static"
        plot_line(upper, speed, mean / mean[0], f"C{k}", lw=1.0, label=label)
        plot_line(upper, speed, still / mean[0], "k:", lw=0.9, label=label_of_still)
        plot_line(lower, speed, deviation / deviation[0], f"C{k}", lw=1.0)
    # the curves fill the panel
    upper.legend(fontsize=8, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    return figure
