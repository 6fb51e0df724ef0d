"""Figures of the fatigue of a drive: Haigh's diagram, and the safety factor on a sector."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from swgpar.drive_results.summary import DriveSummary
from swgpar.presentation.off_screen import off_screen_plotter
from swgpar.results.figure_set import panels, plot_line
from swgpar.results.sector_fields import SectorFields

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHOWN = (0.5, 20.0)
"""Safety factors at the ends of the colour scale, which is logarithmic."""


def draw_haigh(
    sector: SectorFields, cycle: Mapping[str, np.ndarray], summary: DriveSummary, angle: str
) -> Figure:
    """Amplitude over mean (MPa) of all nodes by region with the lines of Goodman and of yield,
    above the worst cycle.

    summary : of a run with [fatigue];  angle : title of the axis with the angle of the wave
    generator
    """
    fatigue, strengths = summary.fatigue, summary.design.fatigue
    figure, (axes, below) = panels(2, 7.5, 7.5, height_ratios=(1.6, 1.0))
    mean, amplitude = sector.fields["mean"], sector.fields["amplitude"]
    for number, (region, content) in enumerate(fatigue.regions.items()):
        here = sector.fields["region"] == number
        mark, words = ("x", " (depends on the mesh)") if content.warning else (".", "")
        axes.plot(mean[here], amplitude[here], mark, ms=4, label=region + words)
    limit, tensile = fatigue.fatigue_limit_of_the_part_MPa, strengths.tensile_strength
    most = strengths.yield_strength
    low = min(0.0, 1.05 * float(mean.min()))
    axes.plot([low, 0.0, tensile], [limit, limit, 0.0], "k-", label="Goodman, safety 1")
    left = max(low, -most)
    axes.plot([left, 0.0, most], [most + left, most, 0.0], "k--", lw=0.8, label="yield")
    worst = fatigue.least["goodman"]
    label = f"least safety {worst.safety:.3g}"
    axes.plot(worst.mean_MPa, worst.amplitude_MPa, "r*", ms=12, label=label)
    axes.set(xlabel="mean of the normal stress (MPa)", ylabel="amplitude (MPa)")
    axes.set(xlim=(low, 1.05 * tensile), ylim=(0.0, 1.1 * max(limit, float(amplitude.max()))))
    axes.set_title("Haigh's diagram, on the critical plane of every node", fontsize=10)
    axes.legend(fontsize=7)
    of_program = "step" in cycle
    plot_line(below, cycle["step" if of_program else "wg_angle_deg"], cycle["normal_stress_MPa"])
    what = "point of the load program (step)" if of_program else angle
    below.set(xlabel=what, ylabel="normal stress (MPa)")
    below.set_title(f"cycle where the safety is the least: {worst.region}", fontsize=10)
    return figure


def sector_picture(sector: SectorFields, plane: bool) -> np.ndarray:
    """Picture (height, width, 3) of a sector coloured by Goodman's safety factor: a plane one along
    its axis."""
    import pyvista

    grid = pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: sector.cells}, sector.points)
    grid.point_data["safety"] = np.clip(sector.fields["safety_goodman"], *SHOWN)
    plotter = off_screen_plotter(1200, 900)
    surface = grid.extract_surface(algorithm="dataset_surface")
    bar = {"title": "safety by Goodman", "position_x": 0.2, "position_y": 0.02}
    colours = {"scalars": "safety", "cmap": "turbo_r", "clim": SHOWN, "log_scale": True}
    edges = {"show_edges": True, "edge_opacity": 0.2}
    plotter.add_mesh(surface, scalar_bar_args=bar, **colours, **edges)
    if plane:
        plotter.enable_parallel_projection()
        plotter.view_xy()
        plotter.camera.zoom(1.6)
    else:
        plotter.camera_position = [(1.2, 0.6, -1.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)]
        plotter.reset_camera()
        plotter.camera.zoom(1.3)
    picture = plotter.screenshot(return_img=True)
    plotter.close()
    return picture
