"""Figures of a planetary gear train, drawn from the tables of a finished run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from swgpar.gear_trains.drawing import axes, save
from swgpar.gear_trains.result import read_table
from swgpar.results import history
from swgpar.results.table import read_columns

TITLES = {
    "sun_u": "turn of the sun",
    "carrier_u": "turn of the carrier",
    "planet_eta": "planet 1 along its circle",
    "node_w": "node 3 of the ring along the motion",
    "contact_v": "ring outward at planet 1",
    "sun_mesh": "way of the mesh of sun and planet 1",
    "ring_mesh": "way of the mesh of ring and planet 1",
}


def draw(out: Path, summary: dict[str, Any]) -> list[Path]:
    """All figures of a run, into out/figures."""
    return [*(_moments(out, name) for name in TITLES), *(_rims(out, name) for name in TITLES), _forces(out)]


def _moments(out: Path, name: str) -> Path:
    table = read_columns(out / history.NAME)
    figure, panels = axes(TITLES[name], "time (s)", "mean (µm)", "standard deviation (µm)")
    for axis, kind in zip(panels, ("mean", "deviation"), strict=True):
        axis.plot(table["time_s"], table[f"monte_carlo_{kind}_{name}_um"], "k", lw=1.0, label="Monte Carlo")
        axis.plot(table["time_s"], table[f"linearised_{kind}_{name}_um"], "C0--", lw=1.2, label="linearised")
    panels[0].legend(fontsize=8)
    return save(figure, out, name)


def _rims(out: Path, name: str) -> Path:
    table = read_table(out, "rims")
    title = f"{TITLES[name]}, by the rim of the ring"
    figure, panels = axes(title, "time (s)", "mean (µm)", "standard deviation (µm)")
    for rim in dict.fromkeys(table["rim_mm"].tolist()):
        rows = table["rim_mm"] == rim
        for axis, kind in zip(panels, ("mean", "deviation"), strict=True):
            axis.plot(table["time_s"][rows], table[f"{kind}_{name}_um"][rows], lw=1.0, label=f"{rim:g} mm")
    panels[0].legend(fontsize=8)
    return save(figure, out, f"rims_{name}")


def _forces(out: Path) -> Path:
    table = read_table(out, "mesh_forces")
    title, labels = "linearised forces of the meshes of planet 1", ("mean (kN)", "mean square (kN²)")
    figure, panels = axes(title, "time (s)", *(f"{name}: {label}" for name in ("sun", "ring") for label in labels))
    for k, name in enumerate(("sun", "ring")):
        panels[2 * k].plot(table["time_s"], 1e-3 * table[f"mean_{name}_force_N"], lw=0.6)
        panels[2 * k + 1].plot(table["time_s"], 1e-6 * table[f"mean_square_{name}_force_N2"], lw=0.6)
    return save(figure, out, "mesh_forces")
