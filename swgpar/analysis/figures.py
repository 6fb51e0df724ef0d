"""Figures of a run, drawn from its files."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from swgpar.errors import OutputError
from swgpar.gear_trains.train import SECTION, train_figures
from swgpar.results import history
from swgpar.results.fields import FOLDER, MESH, increment_name
from swgpar.results.parallel_hdf5 import h5py

MAGNIFICATION = 5.0
"""Of displacements in the picture of the deformed cup drive; that of the plane model is true to scale."""


def make_figures(out: Path) -> list[Path]:
    """Draw all figures that the files in `out` allow, into out/figures; call it on one rank."""
    out = Path(out)
    for name in (history.NAME, "summary.json"):
        if not (out / name).exists():
            raise OutputError(f"{out} has no {name}: figures are drawn from the files of a finished run")
    figures = out / "figures"
    figures.mkdir(exist_ok=True)
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    if SECTION in summary["design"]:
        return train_figures(out, summary)
    rows = history.read_history(out / history.NAME)
    made = [_stress(rows, figures), _torque(rows, summary, figures)]
    if (out / "fields.h5").exists():
        last = summary.get("increments", len(rows))
        made += [_deformed(out, last, summary, figures), _pattern(out, last, summary, figures)]
    return made


def _axes(title: str, ylabel: str):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    axes = figure.add_subplot()
    axes.set(xlabel="angle of the wave generator (degrees)", ylabel=ylabel, title=title)
    axes.grid(alpha=0.3)
    return figure, axes


def _turning(rows: list[dict]) -> list[dict]:
    """Loaded increments: the last of step 3 and the rotation."""
    loaded = [r for r in rows if int(r["step"]) >= 3]
    return loaded or rows


def _stress(rows: list[dict], figures: Path) -> Path:
    rows = _turning(rows)
    figure, axes = _axes("largest stresses (nodal averages)", "stress (MPa)")
    angle = history.column(rows, "wg_angle_deg")
    labels = {
        "fs_s1": "flexible spline, tensile s1",
        "fs_s3": "flexible spline, compressive |s3|",
        "fs_vm": "flexible spline, von Mises",
        "rg_vm": "ring gear, von Mises",
    }
    for name, label in labels.items():
        axes.plot(angle, history.column(rows, name), "o-", ms=3, label=label)
    axes.set_ylim(bottom=0.0)
    axes.legend(fontsize=8)
    path = figures / "stress.png"
    figure.savefig(path, dpi=150)
    return path


def _torque(rows: list[dict], summary: dict, figures: Path) -> Path:
    from matplotlib.figure import Figure

    rows = _turning(rows)
    angle = history.column(rows, "wg_angle_deg")
    error = 3600.0 * (history.column(rows, "output_angle_deg") - angle / summary["ratio"])
    figure = Figure(figsize=(7.0, 6.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.plot(angle, history.column(rows, "wg_torque_Nmm"), "o-", ms=3, label="wave generator")
    upper.axhline(summary["wg_torque_expected_Nmm"], color="0.4", ls="--", label="energy balance, T / ratio")
    upper.set(ylabel="torque (N·mm)", title="input torque")
    lower.plot(angle, error, "o-", ms=3)
    lower.set(
        xlabel="angle of the wave generator (degrees)",
        ylabel="arc seconds",
        title="transmission error: output angle less its kinematic value",
    )
    for axes in (upper, lower):
        axes.grid(alpha=0.3)
    upper.legend(fontsize=8)
    path = figures / "torque_and_transmission_error.png"
    figure.savefig(path, dpi=150)
    return path


def _read(out: Path, index: int, body: str, name: str) -> np.ndarray:
    with h5py.File(out / FOLDER / f"{increment_name(index)}.h5", "r") as file:
        return file[f"{body}/{name}"][:]


def _mesh(out: Path, body: str) -> dict[str, np.ndarray]:
    with h5py.File(out / FOLDER / f"{MESH}.h5", "r") as file:
        return {name: file[f"{body}/{name}"][:] for name in ("points", "cells", "flank_nodes", "flank_s", "flank_z")}


def _is_plane(summary: dict) -> bool:
    return summary["design"]["drive"]["model"] == "plane"


def _flank(tooth: int, side: int) -> str:
    return f"tooth {tooth}, {'clockwise' if side == 0 else 'counter-clockwise'} flank"


def _deformed(out: Path, index: int, summary: dict, figures: Path) -> Path:
    """The deformed drive, seen from its open end, coloured by von Mises stress; the plane model seen along its axis."""
    import pyvista

    plane = _is_plane(summary)
    magnification = 1.0 if plane else MAGNIFICATION
    pyvista.OFF_SCREEN = True
    plotter = pyvista.Plotter(off_screen=True, window_size=(1400, 1100))
    copies = (1.0, -1.0) if summary["twofold_symmetry"] else (1.0,)
    limit = 0.0
    grids = []
    for body in ("flexible_spline", "ring_gear"):
        mesh, u, vm = _mesh(out, body), _read(out, index, body, "displacement"), _read(out, index, body, "vm")
        if body == "flexible_spline":
            limit = float(np.percentile(vm, 99.9))
        cells = np.hstack([np.full((len(mesh["cells"]), 1), 8), mesh["cells"]]).ravel()
        kinds = np.full(len(mesh["cells"]), pyvista.CellType.HEXAHEDRON)
        for sign in copies:
            turn = np.array([sign, sign, 1.0])
            grid = pyvista.UnstructuredGrid(cells, kinds, (mesh["points"] + magnification * u) * turn)
            grid.point_data["von Mises stress (MPa)"] = vm
            grids.append(grid.extract_surface(algorithm="dataset_surface"))
    look = {"cmap": "turbo", "clim": (0.0, limit), "smooth_shading": False}
    beside = {"title": "von Mises, MPa", "vertical": True, "position_x": 0.9, "position_y": 0.25, "height": 0.5}
    for grid in grids:
        plotter.add_mesh(grid, scalars="von Mises stress (MPa)", scalar_bar_args=beside, **look)
    plotter.add_text("true to scale" if plane else f"displacements x {magnification:g}", font_size=12)
    if plane:
        plotter.enable_parallel_projection()
        plotter.view_xy()
        plotter.camera.tight(padding=0.03, adjust_render_window=False)
    else:
        plotter.camera_position = [(60.0, 60.0, -170.0), (0.0, 0.0, 10.0), (0.0, 1.0, 0.0)]
        plotter.reset_camera()
    path = figures / "deformed_drive.png"
    plotter.screenshot(path)
    plotter.close()
    return path


def _pattern(out: Path, index: int, summary: dict, figures: Path) -> Path:
    """Pressure on the flanks with contact, over arc length and face width; in the plane over arc length."""
    from matplotlib.figure import Figure

    mesh, pressure = _mesh(out, "flexible_spline"), _read(out, index, "flexible_spline", "pressure")
    n_sectors = summary["bodies"]["flexible_spline"]["elements"] // (
        summary["bodies"]["flexible_spline"]["elements_whole"] // summary["design"]["drive"]["teeth_fs"]
    )
    n_local = len(pressure) // n_sectors
    field = pressure.reshape(n_sectors, n_local)[:, mesh["flank_nodes"]]  # sector, side, s, z
    peak = field.max(axis=(2, 3))
    chosen = [(k, side) for k, side in zip(*np.nonzero(peak > 0.02 * max(peak.max(), 1e-300)))]
    chosen = sorted(chosen, key=lambda item: -peak[item])[:12]
    figure = Figure(figsize=(10.0, 6.0), layout="constrained")
    if not chosen:
        figure.text(0.5, 0.5, "no flank is in contact", ha="center")
    if _is_plane(summary) and chosen:
        axes = figure.add_subplot()
        for k, side in sorted(chosen):
            axes.plot(mesh["flank_s"], field[k, side, :, 0], "o-", ms=3, label=_flank(k, side))
        axes.set(xlabel="arc length from the tip (mm)", ylabel="contact pressure, nodal mean (MPa)", ylim=(0.0, None))
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
        chosen = []
    columns = min(4, max(1, len(chosen)))
    for place, (k, side) in enumerate(sorted(chosen)):
        axes = figure.add_subplot(-(-len(chosen) // columns), columns, place + 1)
        image = axes.pcolormesh(
            mesh["flank_z"],
            mesh["flank_s"],
            field[k, side],
            shading="gouraud",
            vmin=0.0,
            vmax=float(peak.max()),
            cmap="magma",
        )
        axes.invert_yaxis()
        axes.set_title(_flank(k, side), fontsize=8)
        axes.set_xlabel("z (mm)", fontsize=8)
        axes.set_ylabel("from the tip (mm)", fontsize=8)
    if chosen:
        figure.colorbar(image, ax=figure.axes, label="contact pressure (MPa)")
    path = figures / "contact_pattern.png"
    figure.savefig(path, dpi=150)
    return path
