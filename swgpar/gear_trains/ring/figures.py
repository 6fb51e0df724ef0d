"""Figures of an elastic ring, drawn from the tables of a finished run."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from swgpar.gear_trains.drawing import axes
from swgpar.gear_trains.result import TrainResult
from swgpar.gear_trains.ring.quantities import POINTS
from swgpar.results.figure_set import Drawings

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCALE = 0.15
"""Largest displacement of a drawn mode over the radius."""


def drawings(result: TrainResult) -> Drawings:
    """All figures of a run."""
    found = {"mode_shapes": partial(_shapes, result)}
    if result.summary["design"]["moving_load"] is not None:
        found |= {f"speeds_{point}": partial(_speeds, result, point) for point in POINTS}
        found |= {f"monte_carlo_{point}": partial(_monte_carlo, result, point) for point in POINTS}
        found["critical_speeds"] = partial(_critical, result)
    return found


def _shapes(result: TrainResult) -> Figure:
    from matplotlib.figure import Figure

    modes, table = result.tables["modes"], result.tables["mode_shapes"]
    count = sum(name.startswith("outward") for name in table)
    figure = Figure(figsize=(7.5, 2.6 * ((count + 2) // 3)), layout="constrained")
    angle = table["angle_rad"]
    for k, axis in enumerate(figure.subplots((count + 2) // 3, 3, squeeze=False).ravel(), start=1):
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


def _speeds(result: TrainResult, point: str) -> Figure:
    table = result.history
    figure, panels = axes(
        POINTS[point], "angle of the first load (rad)", "mean (µm)", "standard deviation (µm)"
    )
    for speed in dict.fromkeys(table["speed_rad_s"].tolist()):
        rows = table["speed_rad_s"] == speed
        for axis, kind in zip(panels, ("mean", "deviation"), strict=True):
            axis.plot(
                table["angle_rad"][rows],
                1e6 * table[f"{kind}_{point}_m"][rows],
                lw=0.9,
                label=f"{speed:g} rad/s",
            )
    panels[0].legend(fontsize=8)
    return figure


def _monte_carlo(result: TrainResult, point: str) -> Figure:
    table, simulated = result.history, result.tables["monte_carlo"]
    speed = table["speed_rad_s"][0]
    rows = table["speed_rad_s"] == speed
    title = f"{POINTS[point]}, {speed:g} rad/s"
    figure, panels = axes(
        title, "angle of the first load (rad)", "mean (µm)", "standard deviation (µm)"
    )
    for axis, kind in zip(panels, ("mean", "deviation"), strict=True):
        axis.plot(
            simulated["angle_rad"],
            1e6 * simulated[f"{kind}_{point}_m"],
            "k",
            lw=0.7,
            label="Monte Carlo",
        )
        axis.plot(
            table["angle_rad"][rows],
            1e6 * table[f"{kind}_{point}_m"][rows],
            "C0--",
            label="mean and covariance",
        )
    panels[0].legend(fontsize=8)
    return figure


def _critical(result: TrainResult) -> Figure:
    table = result.tables["critical_speeds"]
    panels = ("mean over that of the first", "deviation over that of the first")
    figure, (upper, lower) = axes(
        "largest displacements against the speed", "speed (rad/s)", *panels
    )
    for k, (point, label) in enumerate(POINTS.items()):
        mean, deviation, still = (
            table[f"{n}_{point}_m"] for n in ("mean", "deviation", "without_inertia")
        )
        upper.plot(table["speed_rad_s"], mean / mean[0], f"C{k}", lw=1.0, label=label)
        upper.plot(
            table["speed_rad_s"], still / mean[0], "k:", lw=0.9, label=None if k else "quasi-static"
        )
        lower.plot(table["speed_rad_s"], deviation / deviation[0], f"C{k}", lw=1.0)
    upper.legend(
        fontsize=8, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0)
    )  # the curves fill the panel
    return figure
