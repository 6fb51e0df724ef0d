"""Stress of the flexible spline around its circumference: the largest of every tooth's sector, by
part."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from swgpar.meshing.drive_geometry import DriveGeometry
from swgpar.results.figure_set import panels, plot_line

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIELDS = {"s1": "tension s1 (MPa)", "vm": "von Mises stress (MPa)"}


def parts(geometry: DriveGeometry, points: np.ndarray) -> dict[str, np.ndarray]:
    """Whether nodes of the undeformed flexible spline at points (n, 3) mm belong to a part, by the
    name of the part."""
    radius, z = np.hypot(points[:, 0], points[:, 1]), points[:, 2]
    toothed = np.abs(z) <= 0.5 * geometry.face_width * (1.0 + 1e-9)
    inner = radius < geometry.inner_radius + 0.5 * geometry.gears["flexible_spline"].rim
    masks = {"teeth": toothed & ~inner, "inside of the rim": toothed & inner}
    return masks if toothed.all() else masks | {"cup behind the teeth": ~toothed}


def largest_by_tooth(values: np.ndarray, chosen: np.ndarray, teeth: int) -> np.ndarray:
    """Largest of the chosen nodes of every sector (teeth,). values, chosen : (n,), nodes sector by
    sector"""
    return np.where(chosen, values, -np.inf).reshape(teeth, -1).max(axis=1)


def draw_circumference(
    geometry: DriveGeometry,
    points: np.ndarray,
    fields: Mapping[str, np.ndarray],
    teeth: int,
    wg_angle: float,
    title: str,
) -> Figure:
    """Largest s1 and von Mises stress of every modelled tooth, over its angle from the major axis.

    points : (n, 3) mm, undeformed, sector by sector;  fields : name -> (n,) MPa;  teeth : that are
    modelled
    wg_angle : rad, of the wave generator;  title : where in the run this is
    """
    middle = points.reshape(teeth, -1, 3).mean(axis=1)
    angle = np.degrees(np.arctan2(-middle[:, 0], middle[:, 1]) - wg_angle)
    # the other half of a symmetric drive is alike
    copies = geometry.gears["flexible_spline"].profile.n_teeth // teeth
    angle = np.concatenate([angle + 360.0 * k / copies for k in range(copies)])
    angle = (angle + 180.0) % 360.0 - 180.0
    order = np.argsort(angle)
    figure, rows = panels(len(FIELDS), 7.0, 6.0, shared=True)
    for axes, (name, label) in zip(rows, FIELDS.items()):
        for part, chosen in parts(geometry, points).items():
            values = np.tile(largest_by_tooth(fields[name], chosen, teeth), copies)
            plot_line(axes, angle[order], values[order], lw=1.2, label=part)
        axes.set(ylabel=label, xlim=(-180.0, 180.0), xticks=range(-180, 181, 45))
    figure.suptitle(f"flexible spline, largest of every tooth's sector\n{title}", fontsize=10)
    handles, labels = rows[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize=8)
    rows[-1].set_xlabel("tooth, from the major axis (degrees)")
    return figure
