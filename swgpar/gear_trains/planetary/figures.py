"""Figures of a planetary gear train, drawn from the tables of a finished run."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from swgpar.gear_trains.drawing import axes
from swgpar.gear_trains.planetary.monitored import MONITORED
from swgpar.gear_trains.result import TrainResult
from swgpar.results.figure_set import Drawings

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def drawings(result: TrainResult) -> Drawings:
    """All figures of a run."""
    found = {name: partial(_moments, result, name) for name in MONITORED}
    found |= {f"rims_{name}": partial(_rims, result, name) for name in MONITORED}
    return found | {"mesh_forces": partial(_forces, result)}


def _moments(result: TrainResult, name: str) -> Figure:
    table = result.history
    figure, panels = axes(MONITORED[name], "time (s)", "mean (µm)", "standard deviation (µm)")
    for axis, kind in zip(panels, ("mean", "deviation"), strict=True):
        axis.plot(
            table["time_s"],
            table[f"monte_carlo_{kind}_{name}_um"],
            "k",
            lw=1.0,
            label="Monte Carlo",
        )
        axis.plot(
            table["time_s"],
            table[f"linearised_{kind}_{name}_um"],
            "C0--",
            lw=1.2,
            label="linearised",
        )
    panels[0].legend(fontsize=8)
    return figure


def _rims(result: TrainResult, name: str) -> Figure:
    table = result.tables["rims"]
    title = f"{MONITORED[name]}, by rim thickness"
    figure, panels = axes(title, "time (s)", "mean (µm)", "standard deviation (µm)")
    for rim in dict.fromkeys(table["rim_mm"].tolist()):
        rows = table["rim_mm"] == rim
        for axis, kind in zip(panels, ("mean", "deviation"), strict=True):
            axis.plot(
                table["time_s"][rows], table[f"{kind}_{name}_um"][rows], lw=1.0, label=f"{rim:g} mm"
            )
    panels[0].legend(fontsize=8)
    return figure


def _forces(result: TrainResult) -> Figure:
    table = result.tables["mesh_forces"]
    title, labels = (
        "linearised forces of the meshes of planet 1",
        ("mean (kN)", "mean square (kN²)"),
    )
    figure, panels = axes(
        title, "time (s)", *(f"{name}: {label}" for name in ("sun", "ring") for label in labels)
    )
    for k, name in enumerate(("sun", "ring")):
        panels[2 * k].plot(table["time_s"], 1e-3 * table[f"mean_{name}_force_N"], lw=0.6)
        panels[2 * k + 1].plot(
            table["time_s"], 1e-6 * table[f"mean_square_{name}_force_N2"], lw=0.6
        )
    return figure
