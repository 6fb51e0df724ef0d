"""Figures of a cascade gearbox, drawn from the tables of a finished run."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from swgpar.gear_trains.cascade.design import PINIONS, CascadeDesign
from swgpar.gear_trains.cascade.dynamics import natural_frequencies
from swgpar.gear_trains.drawing import axes
from swgpar.gear_trains.published import number_label
from swgpar.gear_trains.result import TrainResult
from swgpar.results.figure_set import Drawings, new_figure, plot_line

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NAMES = {f"{k}": f"pinion {k}" for k in range(1, PINIONS + 1)}
STYLES = ("-", "--")
"""Of odd and even pinions."""

LARGEST_DRAWN = 0.3


def drawings(result: TrainResult[CascadeDesign]) -> Drawings:
    """All figures of a run."""
    static, limit = result.tables["static"], result.summary.design.load.largest_share
    at_rest = {
        f"load_sharing_static_{side}": partial(
            _against_force,
            f"load sharing at rest, direction {side}",
            static["rack_force_kN"],
            {name: static[f"{side}_{k}"] for k, name in NAMES.items()},
            limit,
        )
        for side in "BA"
    }
    equal = {f"{side} pinions": static[f"B_equal_{side}"] for side in ("odd", "even")}
    force = result.history["rack_force_kN"]
    rising = slice(0, np.argmax(force) + 1)
    moving = {name: result.history[f"share_{k}"][rising] for k, name in NAMES.items()}
    further = {"load_sharing_compared": _compared, "lateral_force": _lateral, "spectrum": _spectrum}
    if "spectrum" not in result.tables:  # of an earlier version
        further = {}
    return at_rest | {
        **{name: partial(draw, result) for name, draw in further.items()},
        "load_sharing_equal_units": partial(
            _against_force,
            "load sharing at rest, direction B, equal units",
            static["rack_force_kN"],
            equal,
            limit,
        ),
        "load_sharing_dynamic": partial(_in_time, result),
        "load_sharing_dynamic_force": partial(
            _against_force,
            "load sharing in motion, direction B, rising force",
            force[rising],
            moving,
            limit,
        ),
        "population": partial(_population, result, limit),
        "stack_up": partial(_stack_up, result),
        "flex_unit": partial(_flex_unit, result),
    }


def _against_force(
    title: str, force: np.ndarray, shares: Mapping[str, np.ndarray], limit: float
) -> Figure:
    """Load shares by label against the rack force (kN)."""
    figure, (axis,) = axes(title, "rack force (kN)", "load share")
    for k, (label, values) in enumerate(shares.items()):
        plot_line(axis, force, values, STYLES[k % 2], lw=1.0, label=label)
    axis.axhline(limit, color="k", ls=":", label="largest allowed")
    axis.set_ylim(0.0, LARGEST_DRAWN)
    axis.legend(fontsize=8, ncols=3)
    return figure


def _in_time(result: TrainResult) -> Figure:
    table = result.history
    labels = "time (s)", "load share", "rack force (kN)"
    figure, (upper, lower) = axes("load sharing over one period", *labels)
    for k, name in NAMES.items():
        style = STYLES[(int(k) - 1) % 2]
        plot_line(upper, table["time_s"], table[f"share_{k}"], style, lw=0.8, label=name)
    upper.set_ylim(0.0, LARGEST_DRAWN)
    upper.legend(fontsize=8, ncols=4)
    plot_line(lower, table["time_s"], table["rack_force_kN"])
    return figure


def _compared(result: TrainResult[CascadeDesign]) -> Figure:
    """Each pinion at rest and in motion, and measured, in direction B."""
    table, history, design = result.tables["static"], result.history, result.summary.design
    rising = slice(0, np.argmax(history["rack_force_kN"]) + 1)
    measured = {
        force: design.measured[name]
        for force in design.load.forces
        if (name := f"static_B_{number_label(force)}") in design.measured
    }
    figure = new_figure(figsize=(11.0, 5.5), layout="constrained")
    figure.suptitle("load shares of the pinions, direction B", fontsize=11)
    panels = figure.subplots(2, PINIONS // 2, sharex=True, sharey=True)
    for k, axis in enumerate(panels.T.ravel()):  # odd pinions above even ones
        force = history["rack_force_kN"][rising]
        plot_line(axis, force, history[f"share_{k + 1}"][rising], "C1", lw=0.8, label="in motion")
        plot_line(axis, table["rack_force_kN"], table[f"B_{k + 1}"], "C0", lw=1.0, label="at rest")
        if measured:
            shares = [values[k] for values in measured.values()]
            plot_line(axis, list(measured), shares, "ko", ms=3.0, label="measured, extrapolated")
        axis.set_title(f"pinion {k + 1}", fontsize=9)
    panels[0, 0].set_ylim(0.0, LARGEST_DRAWN)
    panels[0, 0].legend(fontsize=8)
    figure.supxlabel("rack force (kN)", fontsize=10)
    figure.supylabel("load share", fontsize=10)
    return figure


def _lateral(result: TrainResult) -> Figure:
    table, history = result.tables["static"], result.history
    force = history["rack_force_kN"]
    title, label = "force across the rack", "force (kN)"
    figure, (axis,) = axes(title, "rack force, in direction A negative (kN)", label)
    plot_line(axis, force, history["lateral_force_kN"], "C1", lw=0.6, label="in motion, one period")
    for side, sign in (("B", 1.0), ("A", -1.0)):
        across = sign * table[f"{side}_lateral_force_kN"]
        plot_line(
            axis,
            sign * table["rack_force_kN"],
            across,
            "C0",
            label="at rest" if side == "B" else None,
        )
    axis.legend(fontsize=8)
    return figure


def _spectrum(result: TrainResult[CascadeDesign]) -> Figure:
    table = result.tables["spectrum"]
    title, labels = "amplitude spectrum of one period", ("frequency (Hz)", "amplitude (kN)")
    figure, (axis,) = axes(title, *labels)
    axis.loglog(table["frequency_Hz"], table["pinion_force_1_kN"], lw=0.7, label="pinion 1")
    axis.loglog(table["frequency_Hz"], table["rack_force_kN"], lw=0.7, label="rack")
    highest = table["frequency_Hz"][-1]
    known = natural_frequencies(result.summary.design)[1:]
    for k, frequency in enumerate(known[known < highest]):
        label = None if k else "natural frequencies"
        axis.axvline(frequency, color="k", ls=":", lw=0.7, label=label)
    axis.set_ylim(bottom=1e-6)
    axis.legend(fontsize=8)
    return figure


def _population(result: TrainResult, limit: float) -> Figure:
    table = result.tables["population"]
    figure, panels = axes("load shares of the population", "load share", *2 * ["gearboxes"])
    shown = {"static": "at rest", "mean": "in motion, means"}
    for axis, (kind, title) in zip(panels, shown.items(), strict=True):
        for k, name in NAMES.items():
            axis.hist(table[f"{kind}_{k}"], bins=30, histtype="step", label=name)
        axis.axvline(limit, color="k", ls=":")
        axis.set_title(title, fontsize=9)
    panels[0].legend(fontsize=7, ncols=2)
    return figure


def _stack_up(result: TrainResult) -> Figure:
    figure, (axis,) = axes("pitch errors by kind of mesh", "error (µm)", "density (1/µm)")
    for name, samples in result.tables["stack_up"].items():
        label = name.removesuffix("_um").replace("_", ", ")
        axis.hist(samples, bins=60, density=True, histtype="step", label=label)
    axis.legend(fontsize=8)
    return figure


def _flex_unit(result: TrainResult) -> Figure:
    table = result.tables["flex_unit"]
    labels = "deformation (mm)", "torque (N·m)", "stiffness (N·m/deg)"
    figure, (upper, lower) = axes("flexible units", *labels)
    way = table["deformation_mm"]
    for k, name in NAMES.items():
        if f"torque_{k}_Nm" not in table:  # of an earlier version
            continue
        style = STYLES[(int(k) - 1) % 2]
        plot_line(upper, way, table[f"torque_{k}_Nm"], style, lw=0.8, label=name)
        plot_line(lower, way, table[f"stiffness_{k}_Nm_per_deg"], style, lw=0.8)
    plot_line(upper, way, table["torque_Nm"], "k", lw=1.5, label="mean")
    plot_line(lower, way, table["stiffness_Nm_per_deg"], "k", lw=1.5)
    upper.legend(fontsize=8, ncols=3)
    return figure
