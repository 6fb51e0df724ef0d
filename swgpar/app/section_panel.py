"""The section of the teeth of the variants that are shown."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from nicegui import background_tasks, ui

from swgpar.app.section_plot import moved, section_figure
from swgpar.app.slider import Slider
from swgpar.app.state import DRAWN, AppState
from swgpar.app.workspace import Variant
from swgpar.checks.clearance import smallest_clearance
from swgpar.design.drive_design import DriveDesign

if TYPE_CHECKING:
    from swgpar.presentation.loaded_outline import LoadedOutline

SHAPES = "drive", "flexible_spline", "ring_gear", "dynamic_spline", "wave_generator", "cup"
"""Sections of a design that the picture of undeformed teeth follows from."""

ONCE = "(() => { let said = false; return () => { if (!said) emit(); said = true } })()"
"""Says the first of several events, and again where the element is updated."""

VIEWS = {False: "gaps", True: "loaded"}
"""What the section shows: gaps of the rigid teeth, or stress and forces of a loaded state."""


@dataclass(frozen=True, eq=False)
class TeethPicture:
    """What a picture shows: see `section_figure`. loaded : whether it has no gaps"""

    design: DriveDesign
    angle_deg: float
    outline: LoadedOutline | None = None
    loaded: bool = False

    def figure(self) -> dict[str, Any]:
        """Figure of Plotly."""
        return section_figure(self.design, self.angle_deg, self.outline)

    def shows_the_same(self, other: TeethPicture) -> bool:
        """Whether two pictures are alike, as those of a design under another torque."""
        return (
            (self.angle_deg, self.loaded) == (other.angle_deg, other.loaded)
            and self.outline is other.outline
            and all(getattr(self.design, one) == getattr(other.design, one) for one in SHAPES)
        )


class SectionPanel:
    """Pictures of one or two variants, the angle of the cam, and clearances."""

    def __init__(self, state: AppState) -> None:
        self.state = state
        self.plots: list[ui.plotly] = []
        self.ready: set[ui.plotly] = set()  # those that the browser has drawn
        self.drawn: list[TeethPicture] = []
        self._moves = False  # whether the slider does
        self.pictures()
        with ui.row().classes("w-full items-center no-wrap gap-3"):
            self.view = ui.toggle(VIEWS, value=state.loaded, on_change=self._view)
            self.view.props("dense no-caps size=sm").classes("swgpar-toggle")
            ui.label("cam").classes("text-no-wrap")
            self.slider = Slider(0.0, 360.0, 1.0, "angle of the cam, degrees", self._turned)
            self.slider.show(state.angle_deg)
            self.angle = ui.label(f"{state.angle_deg:.0f}°").classes("swgpar-angle")
            self.play = ui.button("play", on_click=self._play).props("flat dense")
        self._show_view()
        with ui.element("div").props("role=status"):
            self.clearance()

    def draw(self) -> list[asyncio.Task[None]]:
        """Draw the pictures, others where variants come or go; tasks that end when the browser has
        drawn them."""
        self._show_view()
        self.angle.text = f"{self.state.angle_deg:.0f}°"
        if not self._moves:
            self.slider.show(self.state.angle_deg)
        if len(self.plots) != len(self.state.shown):
            self.pictures.refresh()
            return []
        tasks = []
        for k, (plot, variant) in enumerate(zip(self.plots, self.state.shown, strict=True)):
            picture = self._picture(variant)
            if picture.shows_the_same(self.drawn[k]):
                continue
            self.drawn[k], figure = picture, picture.figure()
            if plot in self.ready:
                tasks.append(background_tasks.create(_react(plot, moved(figure, plot.figure))))
                plot.figure = figure
            else:
                plot.update_figure(figure)
        return tasks

    def draw_states(self) -> None:
        """Draw loaded states."""
        if self.state.loaded:
            self.draw()

    @ui.refreshable_method
    def pictures(self) -> None:
        """A picture of each variant."""
        self.ready.clear()
        self.plots, self.drawn = [], [self._picture(one) for one in self.state.shown]
        two = len(self.state.shown) > 1
        with ui.column().classes("w-full gap-0"):
            for variant, picture in zip(self.state.shown, self.drawn, strict=True):
                if two:
                    ui.label(variant.name).classes("text-bold")
                plot = ui.plotly(picture.figure())
                plot.classes("w-full swgpar-plot" + (" swgpar-half" if two else ""))
                plot.props('role=img aria-label="section of the teeth"')
                plot.on("plotly_afterplot", partial(self._drawn, plot), [], js_handler=ONCE)
                self.plots.append(plot)

    def _drawn(self, plot: ui.plotly) -> None:
        """The browser has drawn a picture."""
        self.ready.add(plot)

    @ui.refreshable_method
    def clearance(self) -> None:
        """The smallest clearance of a whole turn in any ring gear, with its place."""
        for variant in self.state.shown:
            found = smallest_clearance(variant.design.rigid_pairs)
            word = "overlap" if found.nearest.distance < 0.0 else "smallest clearance"
            name = f"{variant.name}: " if len(self.state.shown) > 1 else ""
            text = f"{name}{word} {abs(1e3 * found.nearest.distance):.2f} µm, {found.place}"
            ui.label(text).classes("text-negative" if found.overlaps else "")

    def _picture(self, variant: Variant) -> TeethPicture:
        design, state = variant.design, self.state
        if not state.loaded:
            return TeethPicture(design, state.angle_deg)
        found = state.loaded_state(variant)
        return TeethPicture(design, 0.0, found.outline if found is not None else None, loaded=True)

    async def _turned(self, angle: float, moves: bool) -> None:
        self.state.angle_deg, self._moves = angle, moves
        self.state.draw_sections()

    def _view(self) -> None:
        if bool(self.view.value) != self.state.loaded:
            self.state.loaded = bool(self.view.value)
            self.state.draw_sections()

    def _show_view(self) -> None:
        """Show what another window may have chosen; a loaded state has one angle."""
        self.view.value = self.state.loaded
        if self.slider.props.get("disabled", False) != self.state.loaded:
            self.slider.props["disabled"] = self.state.loaded
            self.slider.update()

    def _play(self) -> None:
        self.state.plays = not self.state.plays
        self.play.text = "stop" if self.state.plays else "play"


async def _react(plot: ui.plotly, figure: dict[str, Any]) -> None:
    """Draw a figure in a plot of the browser, and wait until it has done so. An update of the
    element would draw all controls of the window anew before it."""
    content = figure["data"], figure["layout"], figure["config"]
    with suppress(TimeoutError):
        await plot.run_plot_method("react", *content, timeout=DRAWN)
