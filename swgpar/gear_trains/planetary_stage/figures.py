"""Figures of a planetary stage, drawn from the tables of a finished run."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from swgpar.gear_trains.drawing import axes
from swgpar.gear_trains.planetary_parts.campbell import campbell
from swgpar.gear_trains.result import TrainResult
from swgpar.results.figure_set import Drawings, plot_line

if TYPE_CHECKING:
    from matplotlib.axes import Axes
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


def _draw_planets(
    result: TrainResult, axis: Axes, name: str, column: str, factor: float = 1.0, **style: Any
) -> None:
    """A curve for each planet over the first column of the table of this name.

    column : with {} for the number of the planet;  factor : on it;  style : of the lines
    """
    table = result.tables[name]
    x = next(iter(table.values()))
    for k in range(1, result.summary.design.planet.count + 1):
        plot_line(axis, x, factor * table[column.format(k)], label=f"planet {k}", **style)


def _planet_loads(result: TrainResult) -> Figure:
    figure, (axis,) = axes("load of each planet over the mean of all", "carrier (deg)", "")
    _draw_planets(result, axis, "planets", "share_{}", result.summary.design.planet.count)
    axis.legend(fontsize=8)
    return figure


def _mesh_forces(result: TrainResult) -> Figure:
    labels = "sun and planet (kN)", "ring and planet (kN)"
    figure, panels = axes("mesh forces", "carrier (deg)", *labels)
    for axis, gear in zip(panels, ("sun", "ring"), strict=True):
        _draw_planets(result, axis, "planets", f"{gear}_force_{{}}_N", 1e-3, lw=0.7)
    panels[0].legend(fontsize=8)
    return figure


def _sun_path(result: TrainResult) -> Figure:
    figure, (axis,) = axes("path of the sun in the frame of the carrier", "x (µm)", "y (µm)")
    axis.plot(result.history["sun_x_um"], result.history["sun_y_um"], lw=0.7)
    axis.set_aspect("equal", adjustable="datalim")
    return figure


def _spectrum(result: TrainResult) -> Figure:
    """Of the planet with the largest mean load: another one may be without any."""
    table = result.tables["spectrum"]
    planets = range(1, result.summary.design.planet.count + 1)
    most = max(planets, key=lambda k: table[f"sun_force_{k}_N"][0])
    labels = f"sun and planet {most} (N)", f"ring and planet {most} (N)"
    title = "amplitudes of mesh forces"
    figure, panels = axes(title, "cycles in a revolution of the carrier", *labels)
    for axis, gear in zip(panels, ("sun", "ring"), strict=True):
        axis.vlines(table["cycles"][1:], 0.0, table[f"{gear}_force_{most}_N"][1:], lw=0.8)
        axis.set_ylim(bottom=0.0)
    return figure


def _response(result: TrainResult) -> Figure:
    labels = "by torque (N/(N·m))", "by transmission error (N/µm)"
    figure, panels = axes("amplitudes of the forces of sun meshes", "frequency (Hz)", *labels)
    for axis, unit in zip(panels, ("Nm", "um"), strict=True):
        axis.set(xscale="log", yscale="log")
        _draw_planets(result, axis, "response", f"sun_{{}}_N_by_{unit}", lw=0.8)
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
