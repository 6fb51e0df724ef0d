"""Figures of a gear pair, drawn from the tables of a finished run."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from swgpar.gear_trains.drawing import axes
from swgpar.gear_trains.gear_pair.quantities import VALUES
from swgpar.gear_trains.result import TrainResult
from swgpar.results.figure_set import Drawings
from swgpar.vibration.linearisation import EQUIVALENT

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STYLES = {
    "monte_carlo": ("k-", "Monte Carlo"),
    "energy": ("C0--", "energy-based"),
    "force": ("C1:", "force-based"),
}


def drawings(result: TrainResult) -> Drawings:
    """All figures of a run."""
    load, half = result.summary["design"]["load"], result.summary["half_backlash_um"]
    figures: dict[str, Callable[[], Figure]] = {}
    for case, torque in enumerate(load["input"], start=1):
        figures |= {
            f"case_{case}_{value}": partial(_moments, result, case, torque, value)
            for value in VALUES
        }
        figures[f"case_{case}_density"] = partial(_density, result, case, torque, half)
    return figures


def _moments(result: TrainResult, case: int, torque: float, value: str) -> Figure:
    table = result.history
    rows = table["case"] == case
    title = f"{VALUES[value]}, input torque {torque:g} N·m"
    figure, panels = axes(title, "time (s)", "mean (µm)", "standard deviation (µm)")
    for axis, kind in zip(panels, ("mean", "deviation"), strict=True):
        for method, (style, name) in STYLES.items():
            axis.plot(
                table["time_s"][rows], table[f"{method}_{kind}_{value}_um"][rows], style, label=name
            )
    panels[0].legend(fontsize=8)
    return figure


def _density(result: TrainResult, case: int, torque: float, half: float) -> Figure:
    table = result.tables[f"density_{case}"]
    figure, (axis,) = axes(
        f"density of the mesh deflection at the end, input torque {torque:g} N·m",
        "mesh deflection (µm)",
        "density (1/µm)",
    )
    axis.step(
        table["mesh_deflection_um"],
        table["monte_carlo"],
        "k",
        where="mid",
        lw=1.0,
        label=STYLES["monte_carlo"][1],
    )
    for method in EQUIVALENT:
        style, name = STYLES[method]
        axis.plot(table["mesh_deflection_um"], table[method], style, label=name)
    axis.axvspan(-half, half, color="0.9", label="backlash")
    axis.set_xlim(table["mesh_deflection_um"][0], table["mesh_deflection_um"][-1])
    axis.legend(fontsize=8)
    return figure
