"""The deformed drive in a window: what `swgpar view` opens."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from swgpar.errors import InputError
from swgpar.presentation.deformed_figures import PERCENTILE
from swgpar.presentation.off_screen import errors_only, has_display

if TYPE_CHECKING:
    import pyvista

    from swgpar.design.sections import GearName
    from swgpar.drive_results.drive_data import DriveData

COLOURED = {"vm": "von Mises, MPa", "s1": "s1, MPa", "s3": "s3, MPa"}
"""Fields that the keys 1, 2 and 3 show, with the titles of their colour ranges."""

MOST_MAGNIFIED = 10.0


def require_display() -> None:
    """Raise InputError where no window can be opened."""
    if not has_display():
        shown = os.environ.get("DISPLAY")
        reason = f"DISPLAY = {shown} cannot be reached" if shown else "DISPLAY is not set"
        raise InputError(
            f"view needs a display, and {reason}: report.html of the results folder shows the same "
            "drive in a browser"
        )


def view_plotter(result: DriveData, *, off_screen: bool = False) -> pyvista.Plotter:
    """Both gears with all teeth, at the last increment with fields, coloured by von Mises stress.

    Sliders choose the increment and the magnification of displacements. The keys 1, 2 and 3 colour
    by von Mises stress, s1 and s3; f and r hide the flexible spline and the ring gear.

    Raises InputError where the run kept no fields.
    """
    import pyvista

    if not result.increments:
        raise InputError("this run kept no fields: allowed with output.fields = true")
    with errors_only():
        plotter = pyvista.Plotter(off_screen=off_screen, title="swgpar", window_size=(1300, 950))
    shown: dict[str, Any] = {"increment": result.increments - 1, "factor": 1.0, "field": "vm"}

    def surface_of(body: GearName) -> pyvista.PolyData:
        grid = result.grid(shown["increment"], body, whole=True)
        return grid.extract_surface(algorithm="dataset_surface")

    surfaces = {body: surface_of(body) for body in result.gears}
    places = {body: surface.points.copy() for body, surface in surfaces.items()}
    actors = {}
    for body, surface in surfaces.items():
        surface.point_data["shown"] = surface.point_data["vm"]
        colours = {"scalars": "shown", "cmap": "turbo", "show_scalar_bar": False}
        actors[body] = plotter.add_mesh(surface, smooth_shading=False, name=body, **colours)
    mapper = actors[result.gears[0]].mapper
    plotter.add_scalar_bar(title=COLOURED["vm"], fmt="%.4g", mapper=mapper, vertical=True)

    def update() -> None:
        largest = []
        for body, surface in surfaces.items():
            fields = surface_of(body).point_data
            surface.points = places[body] + shown["factor"] * fields["displacement"]
            surface.point_data["shown"] = fields[shown["field"]]
            largest.append(np.percentile(np.abs(fields[shown["field"]]), PERCENTILE))
        limit = float(max(largest))
        for actor in actors.values():
            actor.mapper.scalar_range = (-limit, 0.0) if shown["field"] == "s3" else (0.0, limit)
        plotter.scalar_bar.SetTitle(COLOURED[shown["field"]])
        plotter.render()

    def set_value(name: str, value: float | str) -> None:
        if shown[name] != value:
            shown[name] = value
            update()

    if not off_screen:
        _add_sliders(plotter, result.increments - 1, set_value)
    for key, name in zip("123", COLOURED):
        plotter.add_key_event(key, lambda name=name: set_value("field", name))
    for body, actor in actors.items():
        plotter.add_key_event(body[0], lambda a=actor: a.SetVisibility(not a.GetVisibility()))
    keys = "   ".join(f"{body[0]} {body.replace('_', ' ')}" for body in result.gears)
    plotter.add_text(f"1 von Mises   2 s1   3 s3   {keys}   q close", font_size=9)
    if result.is_plane:
        plotter.view_xy()
    update()
    return plotter


def _add_sliders(
    plotter: pyvista.Plotter, last: int, set_value: Callable[[str, float], None]
) -> None:
    """Sliders of the increment, if there are several, and of the magnification."""
    if last > 0:
        plotter.add_slider_widget(
            lambda value: set_value("increment", round(value)),
            (0, last),
            value=last,
            title="increment",
            fmt="%.0f",
            pointa=(0.05, 0.08),
            pointb=(0.4, 0.08),
        )
    plotter.add_slider_widget(
        lambda value: set_value("factor", value),
        (0.0, MOST_MAGNIFIED),
        value=1.0,
        title="displacements x",
        pointa=(0.55, 0.08),
        pointb=(0.9, 0.08),
    )
