"""Figures of an elastic ring, drawn from the tables of a finished run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from swgpar.gear_trains.drawing import axes, save
from swgpar.gear_trains.result import read_table
from swgpar.results import history
from swgpar.results.table import read_columns

POINTS = {"moving_point": "point of the first load", "middle_node": "node between two supports"}
SCALE = 0.15
"""Largest displacement of a drawn mode over the radius."""


def draw(out: Path, summary: dict[str, Any]) -> list[Path]:
    """All figures of a run, into out/figures."""
    made = [_shapes(out)]
    if summary["design"]["moving_load"] is not None:
        made += [_speeds(out, point) for point in POINTS]
        made += [_monte_carlo(out, point) for point in POINTS]
        made.append(_critical(out))
    return made


def _shapes(out: Path) -> Path:
    from matplotlib.figure import Figure

    modes, table = read_table(out, "modes"), read_table(out, "mode_shapes")
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
    return save(figure, out, "mode_shapes")


def _speeds(out: Path, point: str) -> Path:
    table = read_columns(out / history.NAME)
    figure, panels = axes(POINTS[point], "angle of the first load (rad)", "mean (µm)", "standard deviation (µm)")
    for speed in dict.fromkeys(table["speed_rad_s"].tolist()):
        rows = table["speed_rad_s"] == speed
        for axis, kind in zip(panels, ("mean", "deviation"), strict=True):
            axis.plot(
                table["angle_rad"][rows], 1e6 * table[f"{kind}_{point}_m"][rows], lw=0.9, label=f"{speed:g} rad/s"
            )
    panels[0].legend(fontsize=8)
    return save(figure, out, f"speeds_{point}")


def _monte_carlo(out: Path, point: str) -> Path:
    table, simulated = read_columns(out / history.NAME), read_table(out, "monte_carlo")
    speed = table["speed_rad_s"][0]
    rows = table["speed_rad_s"] == speed
    title = f"{POINTS[point]}, {speed:g} rad/s"
    figure, panels = axes(title, "angle of the first load (rad)", "mean (µm)", "standard deviation (µm)")
    for axis, kind in zip(panels, ("mean", "deviation"), strict=True):
        axis.plot(simulated["angle_rad"], 1e6 * simulated[f"{kind}_{point}_m"], "k", lw=0.7, label="Monte Carlo")
        axis.plot(table["angle_rad"][rows], 1e6 * table[f"{kind}_{point}_m"][rows], "C0--", label="mean and covariance")
    panels[0].legend(fontsize=8)
    return save(figure, out, f"monte_carlo_{point}")


def _critical(out: Path) -> Path:
    table = read_table(out, "critical_speeds")
    panels = ("mean over that of the first", "deviation over that of the first")
    figure, (upper, lower) = axes("largest displacements against the speed", "speed (rad/s)", *panels)
    for k, (point, label) in enumerate(POINTS.items()):
        mean, deviation, still = (table[f"{n}_{point}_m"] for n in ("mean", "deviation", "without_inertia"))
        upper.plot(table["speed_rad_s"], mean / mean[0], f"C{k}", lw=1.0, label=label)
        upper.plot(table["speed_rad_s"], still / mean[0], "k:", lw=0.9, label=None if k else "without inertia")
        lower.plot(table["speed_rad_s"], deviation / deviation[0], f"C{k}", lw=1.0)
    upper.legend(fontsize=8, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0))  # the curves fill the panel
    return save(figure, out, "critical_speeds")
