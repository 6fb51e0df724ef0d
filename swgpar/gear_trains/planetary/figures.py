"""Figures of a planetary gear train, drawn from the tables of a finished run."""

from __future__ import annotations

from functools import partial
from textwrap import wrap
from typing import TYPE_CHECKING

from swgpar.gear_trains.drawing import MomentCurve, axes, draw_moments
from swgpar.gear_trains.planetary.monitored import MONITORED, PARTS, RECORDED
from swgpar.gear_trains.planetary_parts.campbell import campbell
from swgpar.gear_trains.result import TrainResult
from swgpar.results.figure_set import Drawings, new_figure, plot_line

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ROUND_OFF = 1e-4
"""Displacements in µm that are none: round-off of the covariance reaches 1e-5."""

METHODS = {"monte_carlo": ("Monte Carlo", "k"), "linearised": ("linearised", "C0--")}


def drawings(result: TrainResult) -> Drawings:
    """All figures of a run."""
    figures = {name: partial(_moments, result, name) for name in MONITORED}
    figures |= {f"rims_{name}": partial(_rims, result, name) for name in MONITORED}
    figures["mesh_forces"] = partial(_forces, result)
    if "modes" in result.tables:  # an earlier version has neither modes nor all coordinates
        figures |= {f"part_{part}": partial(_part, result, part) for part in PARTS}
        figures["rims_sun_x"] = partial(_rims, result, "sun_x")
        figures["campbell"] = partial(campbell, result)
    return figures


def _moments(result: TrainResult, name: str) -> Figure:
    table = result.history
    curves = [
        MomentCurve(
            table["time_s"],
            table[f"{method}_mean_{name}_um"],
            table[f"{method}_deviation_{name}_um"],
            *label_and_style,
        )
        for method, label_and_style in METHODS.items()
    ]
    return draw_moments(MONITORED[name], "time (s)", curves)


def _part(result: TrainResult, part: str) -> Figure:
    """All coordinates of a part."""
    table = result.history
    figure = new_figure(figsize=(11.0, 5.0), layout="constrained")
    figure.suptitle(part.replace("_", " "), fontsize=11)
    panels = figure.subplots(2, len(PARTS[part]), sharex=True)
    for column, name in zip(panels.T, PARTS[part], strict=True):
        column[0].set_title("\n".join(wrap(RECORDED[name], 40)), fontsize=8)
        for axis, kind in zip(column, ("mean", "deviation"), strict=True):
            for method, (label, style) in METHODS.items():
                values = table[f"{method}_{kind}_{name}_um"]
                plot_line(axis, table["time_s"], values, style, lw=0.8, label=label)
            _open_zero(axis)
    panels[0, 0].set_ylabel("mean (µm)")
    panels[1, 0].set_ylabel("standard deviation (µm)")
    panels[0, 0].legend(fontsize=8)
    figure.supxlabel("time (s)", fontsize=10)
    return figure


def _open_zero(axis: Axes) -> None:
    """Draw what is zero to round-off as a line at zero."""
    low, high = axis.get_ylim()
    if max(abs(low), abs(high)) < ROUND_OFF:
        axis.set_ylim(-ROUND_OFF, ROUND_OFF)


def _rims(result: TrainResult, name: str) -> Figure:
    table, curves = result.tables["rims"], []
    for rim in dict.fromkeys(table["rim_mm"].tolist()):
        rows = table["rim_mm"] == rim
        mean, deviation = (table[f"{kind}_{name}_um"][rows] for kind in ("mean", "deviation"))
        curves.append(MomentCurve(table["time_s"][rows], mean, deviation, f"{rim:g} mm"))
    figure = draw_moments(f"{RECORDED[name]}, by rim thickness", "time (s)", curves)
    for axis in figure.axes:
        _open_zero(axis)
    return figure


def _forces(result: TrainResult) -> Figure:
    table = result.tables["mesh_forces"]
    columns = {
        "sun: mean (kN)": 1e-3 * table["mean_sun_force_N"],
        "sun: mean square (kN²)": 1e-6 * table["mean_square_sun_force_N2"],
        "ring: mean (kN)": 1e-3 * table["mean_ring_force_N"],
        "ring: mean square (kN²)": 1e-6 * table["mean_square_ring_force_N2"],
    }
    figure, panels = axes("linearised forces of the meshes of planet 1", "time (s)", *columns)
    for axis, values in zip(panels, columns.values(), strict=True):
        plot_line(axis, table["time_s"], values, lw=0.6)
    return figure
