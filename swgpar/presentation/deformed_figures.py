"""Figures of the deformed drive, true to scale: the whole, the loaded teeth on the cam, sections of
the cup."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Union

import numpy as np

from swgpar.geometry.disc_surface import CamSurface
from swgpar.geometry.rotation import rotated
from swgpar.meshing.drive_geometry import DriveGeometry
from swgpar.presentation.off_screen import off_screen_plotter, without_margin
from swgpar.presentation.sections import COLOURS, Box, PlaneBody, SectionView, section_of_cut
from swgpar.results.figure_set import new_figure

if TYPE_CHECKING:
    import pyvista
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PERCENTILE = 99.9
"""Of a field at the nodes, as the von Mises stress: the end of its colour range."""

CAM_COLOUR = "#d9d9d9"

PITCHES = 2.2
"""Half width of the close-up of the teeth, in pitches."""

CAM_GRID = 400
"""Points along each side of the close-up in which the distance from the cam is evaluated."""

DrawnBody = Union["pyvista.UnstructuredGrid", PlaneBody]
"""A whole body with its stress: a mesh that is not deformed yet, or a deformed one in the plane."""


def colour_limit(*stresses: np.ndarray) -> float:
    """End of the colour range (MPa) of the von Mises stress of several bodies."""
    return float(np.percentile(np.concatenate(stresses), PERCENTILE)) or 1.0


def _limit(bodies: Sequence[DrawnBody]) -> float:
    return colour_limit(
        *(one.mises if isinstance(one, PlaneBody) else one.point_data["vm"] for one in bodies)
    )


def deformed(
    grids: Sequence[pyvista.UnstructuredGrid], factor: float
) -> list[pyvista.UnstructuredGrid]:
    """The grids with their nodes moved by their displacements. factor : magnification of these"""
    moved = [grid.copy() for grid in grids]
    for grid in moved:
        grid.points = grid.points + factor * grid.point_data["displacement"]
    return moved


def draw_deformed(grids: Sequence[pyvista.UnstructuredGrid], factor: float, title: str) -> Figure:
    """Both deformed gears, seen from the open end of the cup.

    factor : magnification of the displacements;  title : where in the run this is
    """
    plotter = off_screen_plotter(1400, 1300)
    limit = _limit(grids)
    colours = {"scalars": "vm", "cmap": COLOURS, "clim": (0.0, limit), "show_scalar_bar": False}
    for grid in deformed(grids, factor):
        surface = grid.extract_surface(algorithm="dataset_surface")
        # faces that look away are hidden by others: without them drawing takes half as long
        plotter.add_mesh(surface, smooth_shading=False, culling="back", **colours)
    plotter.camera_position = [(60.0, 60.0, -170.0), (0.0, 0.0, 10.0), (0.0, 1.0, 0.0)]
    plotter.reset_camera()
    plotter.camera.zoom(1.3)
    picture = without_margin(plotter.screenshot(return_img=True))
    plotter.close()
    figure, axes = _figure(1, (9.0, 8.0))
    axes[0].imshow(picture)
    return _finish_deformed(figure, axes, title, factor, limit)


def draw_plane_deformed(bodies: Sequence[PlaneBody], factor: float, title: str) -> Figure:
    """Both deformed gears of a plane drive, see `draw_deformed`. bodies : deformed by `factor`"""
    limit = _limit(bodies)
    figure, axes = _figure(1, (9.0, 8.0))
    axes[0].margins(0.0)
    for body in bodies:
        triangles = np.concatenate([body.quads[:, [0, 1, 2]], body.quads[:, [0, 2, 3]]])
        SectionView(body.points, triangles, body.mises, np.zeros((0, 2, 2))).draw(axes[0], limit)
    return _finish_deformed(figure, axes, title, factor, limit)


def _finish_deformed(
    figure: Figure, axes: Sequence[Axes], title: str, factor: float, limit: float
) -> Figure:
    axes[0].set_axis_off()
    scale = f"displacements x {factor:g}, bodies may seem to cross"
    what = "true to scale" if factor == 1.0 else scale
    _finish(figure, axes, f"deformed drive, {title}", what, limit)
    return figure


def draw_loaded_teeth(
    bodies: Sequence[DrawnBody],
    geometry: DriveGeometry,
    cam: CamSurface | None,
    wg_angle: float,
    angle: float,
    z: float,
    title: str,
) -> Figure:
    """Close-up of the deformed teeth and of the cam below them, across the axis.

    cam : None where the spline lies on a race that the run models
    wg_angle : rad, of the wave generator;  angle : rad, of the middle of the close-up from +y,
    counter-clockwise
    z : mm, of the section;  title : where in the run this is
    """
    limit, pitch, ring_gear = _limit(bodies), np.pi * geometry.module, geometry.gears["ring_gear"]
    half, low = PITCHES * pitch, geometry.inner_radius - 0.5 * pitch
    high = ring_gear.profile.r_root_circle + min(ring_gear.rim, 0.5 * pitch)
    box = (-half, half, low, high)
    figure, (axes,) = _figure(1, (9.0, 1.6 + 7.0 * (high - low) / (2.0 * half)))
    if cam is not None:
        _draw_cam(axes, cam, wg_angle - angle, z, box)
    axes.set(xlim=box[:2], ylim=box[2:])
    for body in bodies:
        section = _across(body, angle, z, box)
        if section is not None:
            section.draw(axes, limit)
    axes.set(xlabel="mm, along the circumference", ylabel="radius (mm)")
    ring = "ring gear" if geometry.model != "pancake" or z < 0.0 else "dynamic spline"
    axes.text(0.0, high - 0.15 * pitch, ring, color="w", ha="center", va="top")
    if cam is not None:
        axes.text(0.0, low + 0.1 * pitch, "wave generator", ha="center")
    place = f"teeth at {np.degrees(angle):.1f} degrees from +y"
    where = place if geometry.model == "plane" else f"{place}, section at z {z:.2f} mm"
    _finish(figure, [axes], f"loaded teeth, {title}", f"{where}\ntrue to scale", limit)
    return figure


def _across(body: DrawnBody, angle: float, z: float, box: Box) -> SectionView | None:
    """Section of a deformed body across the axis at z (mm), in a box whose upward axis is at an
    angle (rad) from +y."""
    if isinstance(body, PlaneBody):
        return body.section(angle, box)
    (grid,) = deformed([body], 1.0)
    cut = grid.slice(normal="z", origin=(0.0, 0.0, z))
    return section_of_cut(cut, rotated(np.asarray(cut.points)[:, :2], -angle), box)


def draw_cup_section(
    grids: Sequence[pyvista.UnstructuredGrid],
    geometry: DriveGeometry,
    lobes: int,
    wg_angle: float,
    title: str,
) -> Figure:
    """Half sections of the deformed cup drive along its axis, through a lobe of the cam and between
    two lobes.

    lobes : of the cam;  wg_angle : rad, of the wave generator;  title : where in the run this is
    """
    limit, wall, bodies = _limit(grids), geometry.cup.wall, deformed(grids, 1.0)
    half = 0.5 * geometry.face_width
    length, outer = half + wall.farthest, geometry.largest_radius
    low = max(min(wall.edge, geometry.inner_radius) - 0.05 * outer, 0.0)
    height = min(8.0, max(3.0, 9.0 * (outer - low) / (2.0 * length)))
    box = (-1.6 * half, half + 1.05 * (wall.farthest - wall.back), low, 1.01 * outer)
    figure, panels = _figure(2, (9.5, 1.4 + height))
    for axes, name, turn in zip(panels, ("major axis", "minor axis"), (0.0, np.pi / lobes)):
        angle = wg_angle + turn
        axis = np.array([-np.sin(angle), np.cos(angle), 0.0])
        for grid in bodies:
            cut = grid.slice(normal=(np.cos(angle), np.sin(angle), 0.0), origin=(0.0, 0.0, 0.0))
            points = np.asarray(cut.points)
            section = section_of_cut(cut, np.column_stack([points[:, 2], points @ axis]), box)
            if section is not None:
                section.draw(axes, limit)
        axes.set(xlim=box[:2], ylim=box[2:])
        axes.set(xlabel="z (mm), open end at negative z", title=f"through the {name}")
    panels[0].set_ylabel("radius (mm)")
    _finish(figure, panels, f"sections of the cup, {title}", "true to scale", limit)
    return figure


def _figure(panels: int, size: tuple[float, float]) -> tuple[Figure, list[Axes]]:
    figure = new_figure(figsize=size, dpi=110, layout="constrained")
    axes = list(figure.subplots(1, panels, squeeze=False)[0])
    for panel in axes:
        panel.set_aspect("equal")
    return figure, axes


def _finish(figure: Figure, axes: Sequence[Axes], when: str, what: str, limit: float) -> None:
    """Add the title and the range of colours."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    ends = f"colours end at {limit:.4g} MPa ({PERCENTILE:g} % of the nodes are below)"
    figure.suptitle(f"von Mises stress of the {when}\n{what}; {ends}", fontsize=10)
    colours = ScalarMappable(Normalize(0.0, limit), COLOURS)
    label = "von Mises stress (MPa), nodal averages"
    figure.colorbar(colours, ax=list(axes), extend="max", shrink=0.8, label=label)


def _draw_cam(axes: Axes, cam: CamSurface, turn: float, z: float, box: Box) -> None:
    """Fill the cam at z (mm) where it is in the box. turn : rad, of its major axis from the middle
    of the figure"""
    x, y = np.meshgrid(np.linspace(*box[:2], CAM_GRID), np.linspace(*box[2:], CAM_GRID))
    points = rotated(np.column_stack([x.ravel(), y.ravel()]), -turn)
    distance = cam.evaluate(np.column_stack([points, np.full(len(points), z)]))[0].reshape(x.shape)
    axes.contourf(x, y, distance, levels=[-np.inf, 0.0], colors=[CAM_COLOUR])
    axes.contour(x, y, distance, levels=[0.0], colors="#222", linewidths=0.8)
