"""Figures of a cascade gearbox, drawn from the tables of a finished run."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from swgpar.gear_trains.cascade.design import PINIONS
from swgpar.gear_trains.drawing import axes
from swgpar.gear_trains.result import TrainResult
from swgpar.results.figure_set import Drawings

if TYPE_CHECKING:
    from matplotlib.figure import Figure

EACH = range(1, PINIONS + 1)
STYLES = {k: "-" if k % 2 else "--" for k in EACH}


def drawings(result: TrainResult) -> Drawings:
    """All figures of a run."""
    limit = result.summary["overload_limit"]
    found = {f"load_sharing_static_{side}": partial(_static, result, side, limit) for side in "BA"}
    return found | {
        "load_sharing_equal_units": partial(_equal, result, limit),
        "load_sharing_dynamic": partial(_in_time, result),
        "load_sharing_dynamic_force": partial(_against_force, result, limit),
        "population": partial(_population, result, limit),
        "stack_up": partial(_stack_up, result),
        "flex_unit": partial(_flex_unit, result),
    }


def _static(result: TrainResult, direction: str, limit: float) -> Figure:
    table = result.tables["static"]
    figure, (axis,) = axes(
        f"load sharing at rest, direction {direction}", "rack force (kN)", "load share"
    )
    for k in EACH:
        axis.plot(
            table["rack_force_kN"],
            table[f"{direction}_{k}"],
            STYLES[k],
            lw=1.2,
            label=f"pinion {k}",
        )
    axis.axhline(limit, color="k", ls=":", label="largest allowed")
    axis.set_ylim(0.0, 0.3)
    axis.legend(fontsize=8, ncols=3)
    return figure


def _equal(result: TrainResult, limit: float) -> Figure:
    table = result.tables["static"]
    figure, (axis,) = axes(
        "load sharing at rest, direction B, equal units", "rack force (kN)", "load share"
    )
    axis.plot(table["rack_force_kN"], table["B_equal_odd"], label="odd pinions")
    axis.plot(table["rack_force_kN"], table["B_equal_even"], "--", label="even pinions")
    axis.axhline(limit, color="k", ls=":", label="largest allowed")
    axis.set_ylim(0.0, 0.3)
    axis.legend(fontsize=8)
    return figure


def _in_time(result: TrainResult) -> Figure:
    table = result.history
    figure, (upper, lower) = axes(
        "load sharing over one period", "time (s)", "load share", "rack force (kN)"
    )
    for k in EACH:
        upper.plot(table["time_s"], table[f"share_{k}"], STYLES[k], lw=0.8, label=f"pinion {k}")
    upper.set_ylim(0.0, 0.3)
    upper.legend(fontsize=8, ncols=4)
    lower.plot(table["time_s"], table["rack_force_kN"])
    return figure


def _against_force(result: TrainResult, limit: float) -> Figure:
    table = result.history
    first = slice(0, np.argmax(table["rack_force_kN"]) + 1)
    figure, (axis,) = axes(
        "load sharing in motion, direction B, rising force", "rack force (kN)", "load share"
    )
    for k in EACH:
        axis.plot(
            table["rack_force_kN"][first],
            table[f"share_{k}"][first],
            STYLES[k],
            lw=0.8,
            label=f"pinion {k}",
        )
    axis.axhline(limit, color="k", ls=":", label="largest allowed")
    axis.set_ylim(0.0, 0.3)
    axis.legend(fontsize=8, ncols=3)
    return figure


def _population(result: TrainResult, limit: float) -> Figure:
    table = result.tables["population"]
    figure, panels = axes("load shares of the population", "load share", *2 * ["gearboxes"])
    for axis, name in zip(panels, ("static", "mean"), strict=True):
        for k in EACH:
            axis.hist(table[f"{name}_{k}"], bins=30, histtype="step", label=f"pinion {k}")
        axis.axvline(limit, color="k", ls=":")
        axis.set_title("at rest" if name == "static" else "in motion, means", fontsize=9)
    panels[0].legend(fontsize=7, ncols=2)
    return figure


def _stack_up(result: TrainResult) -> Figure:
    table = result.tables["stack_up"]
    figure, (axis,) = axes("pitch errors by kind of mesh", "error (µm)", "density (1/µm)")
    for name, samples in table.items():
        axis.hist(
            samples,
            bins=60,
            density=True,
            histtype="step",
            label=name.removesuffix("_um").replace("_", ", "),
        )
    axis.legend(fontsize=8)
    return figure


def _flex_unit(result: TrainResult) -> Figure:
    table = result.tables["flex_unit"]
    figure, (upper, lower) = axes(
        "flexible units, mean", "deformation (mm)", "torque (N·m)", "stiffness (N·m/deg)"
    )
    upper.plot(table["deformation_mm"], table["torque_Nm"])
    lower.plot(table["deformation_mm"], table["stiffness_Nm_per_deg"])
    return figure
