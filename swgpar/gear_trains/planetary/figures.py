"""Figures of a planetary gear train, drawn from the tables of a finished run."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from swgpar.gear_trains.drawing import MomentCurve, axes, draw_moments
from swgpar.gear_trains.planetary.monitored import MONITORED
from swgpar.gear_trains.result import TrainResult
from swgpar.results.figure_set import Drawings, plot_line

if TYPE_CHECKING:
    from matplotlib.figure import Figure

METHODS = {"monte_carlo": ("Monte Carlo", "k"), "linearised": ("linearised", "C0--")}


def drawings(result: TrainResult) -> Drawings:
    """All figures of a run."""
    figures = {name: partial(_moments, result, name) for name in MONITORED}
    figures |= {f"rims_{name}": partial(_rims, result, name) for name in MONITORED}
    return figures | {"mesh_forces": partial(_forces, result)}


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


def _rims(result: TrainResult, name: str) -> Figure:
    table, curves = result.tables["rims"], []
    for rim in dict.fromkeys(table["rim_mm"].tolist()):
        rows = table["rim_mm"] == rim
        mean, deviation = (table[f"{kind}_{name}_um"][rows] for kind in ("mean", "deviation"))
        curves.append(MomentCurve(table["time_s"][rows], mean, deviation, f"{rim:g} mm"))
    return draw_moments(f"{MONITORED[name]}, by rim thickness", "time (s)", curves)


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
