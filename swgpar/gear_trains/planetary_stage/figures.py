"""Figures of a planetary stage, drawn from the tables of a finished run."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from swgpar.gear_trains.drawing import axes
from swgpar.gear_trains.planetary_parts.campbell import campbell
from swgpar.gear_trains.result import TrainResult
from swgpar.results.figure_set import Drawings, plot_line

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BINS = 40


def drawings(result: TrainResult) -> Drawings:
    """All figures of a run."""
    figures = {
        "planet_loads": partial(_planet_loads, result),
        "mesh_forces": partial(_mesh_forces, result),
        "sun_path": partial(_sun_path, result),
        "spectrum": partial(_spectrum, result),
    }
    if "response" in result.tables:
        figures["response"] = partial(_response, result)
    if "modes" in result.tables:
        figures["campbell"] = partial(campbell, result)
    if "random" in result.tables:
        figures["random_factors"] = partial(_random_factors, result)
    return figures


def _planets(result: TrainResult) -> range:
    return range(1, result.summary.design.planet.count + 1)


def _planet_loads(result: TrainResult) -> Figure:
    table, count = result.tables["planets"], len(_planets(result))
    figure, (axis,) = axes("load of each planet over the mean of all", "carrier (deg)", "")
    for k in _planets(result):
        plot_line(axis, table["carrier_deg"], count * table[f"share_{k}"], label=f"planet {k}")
    axis.legend(fontsize=8)
    return figure


def _mesh_forces(result: TrainResult) -> Figure:
    table = result.tables["planets"]
    labels = "sun and planet (kN)", "ring and planet (kN)"
    figure, panels = axes("mesh forces", "carrier (deg)", *labels)
    for axis, gear in zip(panels, ("sun", "ring"), strict=True):
        for k in _planets(result):
            values = 1e-3 * table[f"{gear}_force_{k}_N"]
            plot_line(axis, table["carrier_deg"], values, lw=0.7, label=f"planet {k}")
    panels[0].legend(fontsize=8)
    return figure


def _sun_path(result: TrainResult) -> Figure:
    figure, (axis,) = axes("path of the sun in the frame of the carrier", "x (µm)", "y (µm)")
    axis.plot(result.history["sun_x_um"], result.history["sun_y_um"], lw=0.7)
    axis.set_aspect("equal", adjustable="datalim")
    return figure


def _spectrum(result: TrainResult) -> Figure:
    table = result.tables["spectrum"]
    labels = "sun and planet 1 (N)", "ring and planet 1 (N)"
    title = "amplitudes of mesh forces"
    figure, panels = axes(title, "cycles in a revolution of the carrier", *labels)
    for axis, gear in zip(panels, ("sun", "ring"), strict=True):
        axis.vlines(table["cycles"][1:], 0.0, table[f"{gear}_force_1_N"][1:], lw=0.8)
        axis.set_ylim(bottom=0.0)
    return figure


def _response(result: TrainResult) -> Figure:
    table = result.tables["response"]
    labels = "by torque (N/(N·m))", "by transmission error (N/µm)"
    figure, panels = axes("amplitudes of the forces of sun meshes", "frequency (Hz)", *labels)
    for axis, unit in zip(panels, ("Nm", "um"), strict=True):
        for k in _planets(result):
            values, label = table[f"sun_{k}_N_by_{unit}"], f"planet {k}"
            axis.loglog(table["frequency_Hz"], values, lw=0.8, label=label)
        axis.margins(x=0.0)
    panels[0].legend(fontsize=8)
    return figure


def _random_factors(result: TrainResult) -> Figure:
    table = result.tables["random"]
    title = "load sharing factors of trains with random errors"
    figure, (axis,) = axes(title, "load sharing factor", "trains")
    for name, label in (
        ("load_sharing_factor", "at the worst place"),
        ("mean_load_sharing_factor", "of mean loads"),
    ):
        axis.hist(table[name], bins=BINS, histtype="step", label=label)
    axis.legend(fontsize=8)
    return figure
