"""Figures of a gear pair, drawn from the tables of a finished run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from swgpar.gear_trains.drawing import axes, save
from swgpar.gear_trains.linearisation import EQUIVALENT
from swgpar.gear_trains.result import read_table
from swgpar.results import history
from swgpar.results.table import read_columns

STYLES = {"monte_carlo": ("k-", "Monte Carlo"), "energy": ("C0--", "energy-based"), "force": ("C1:", "force-based")}
VALUES = ("y1", "y2", "z", "mesh")


def draw(out: Path, summary: dict[str, Any]) -> list[Path]:
    """All figures of a run, into out/figures."""
    load = summary["design"]["load"]
    made = []
    for case, torque in enumerate(load["input"], start=1):
        made += [_moments(out, case, torque, value) for value in VALUES]
        made.append(_density(out, case, torque, summary["half_backlash_um"]))
    return made


def _moments(out: Path, case: int, torque: float, value: str) -> Path:
    table = read_columns(out / history.NAME)
    rows = table["case"] == case
    title = f"{'way of the mesh' if value == 'mesh' else value}, input torque {torque:g} N·m"
    figure, panels = axes(title, "time (s)", "mean (µm)", "standard deviation (µm)")
    for axis, kind in zip(panels, ("mean", "deviation"), strict=True):
        for method, (style, name) in STYLES.items():
            axis.plot(table["time_s"][rows], table[f"{method}_{kind}_{value}_um"][rows], style, label=name)
    panels[0].legend(fontsize=8)
    return save(figure, out, f"case_{case}_{value}")


def _density(out: Path, case: int, torque: float, half: float) -> Path:
    table = read_table(out, f"density_{case}")
    figure, (axis,) = axes(
        f"density of the mesh's way at the end, input torque {torque:g} N·m", "way of the mesh (µm)", "density (1/µm)"
    )
    axis.step(table["mesh_way_um"], table["monte_carlo"], "k", where="mid", lw=1.0, label=STYLES["monte_carlo"][1])
    for method in EQUIVALENT:
        style, name = STYLES[method]
        axis.plot(table["mesh_way_um"], table[method], style, label=name)
    axis.axvspan(-half, half, color="0.9", label="backlash")
    axis.set_xlim(table["mesh_way_um"][0], table["mesh_way_um"][-1])
    axis.legend(fontsize=8)
    return save(figure, out, f"case_{case}_density")
