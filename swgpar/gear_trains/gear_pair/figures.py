"""Figures of a gear pair, drawn from the tables of a finished run."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from swgpar.gear_trains.drawing import MomentCurve, axes, draw_moments
from swgpar.gear_trains.gear_pair.design import GearPairDesign
from swgpar.gear_trains.gear_pair.quantities import VALUES
from swgpar.gear_trains.result import TrainResult
from swgpar.results.figure_set import Drawings, plot_line
from swgpar.vibration.linearisation import EQUIVALENT

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STYLES = {
    "monte_carlo": ("k-", "Monte Carlo"),
    "energy": ("C0--", "energy-based"),
    "force": ("C1:", "force-based"),
}


def drawings(result: TrainResult[GearPairDesign]) -> Drawings:
    """All figures of a run."""
    figures: dict[str, Callable[[], Figure]] = {}
    for case, torque in enumerate(result.summary.design.load.input, start=1):
        load = f"input torque {torque:g} N·m"
        figures |= {
            f"case_{case}_{value}": partial(_moments, result, case, load, value) for value in VALUES
        }
        figures[f"case_{case}_density"] = partial(_density, result, case, load)
    return figures


def _moments(result: TrainResult, case: int, load: str, value: str) -> Figure:
    table = result.history
    rows = table["case"] == case
    curves = [
        MomentCurve(
            table["time_s"][rows],
            table[f"{method}_mean_{value}_um"][rows],
            table[f"{method}_deviation_{value}_um"][rows],
            label,
            style,
        )
        for method, (style, label) in STYLES.items()
    ]
    return draw_moments(f"{VALUES[value]}, {load}", "time (s)", curves)


def _density(result: TrainResult[GearPairDesign], case: int, load: str) -> Figure:
    table, half = result.tables[f"density_{case}"], result.summary.design.mesh.half_backlash
    deflection = table["mesh_deflection_um"]
    title = f"density of the mesh deflection at the end, {load}"
    figure, (axis,) = axes(title, "mesh deflection (µm)", "density (1/µm)")
    _, label = STYLES["monte_carlo"]
    bins = table["monte_carlo"]
    plot_line(axis, deflection, bins, "k", drawstyle="steps-mid", lw=1.0, label=label)
    for method in EQUIVALENT:
        style, label = STYLES[method]
        plot_line(axis, deflection, table[method], style, label=label)
    axis.axvspan(-half, half, color="0.9", label="backlash")
    axis.set_xlim(deflection[0], deflection[-1])
    axis.legend(fontsize=8)
    return figure
