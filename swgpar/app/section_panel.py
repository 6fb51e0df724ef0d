"""The section of the teeth of the variants that are shown."""

from __future__ import annotations

from typing import Any

from nicegui import ui

from swgpar.app.section_plot import section_figure
from swgpar.app.slider import Slider
from swgpar.app.state import AppState
from swgpar.app.workspace import Variant
from swgpar.checks.clearance import clearances

VIEWS = {False: "gaps", True: "loaded"}
"""What the section shows: gaps of the rigid teeth, or stress and forces of the plane model."""


class SectionPanel:
    """Pictures of one or two variants, the angle of the cam, and clearances."""

    def __init__(self, state: AppState) -> None:
        self.state = state
        self.plots: list[ui.plotly] = []
        self._moves = False  # whether the slider does
        self.pictures()
        with ui.row().classes("w-full items-center no-wrap gap-3"):
            self.view = ui.toggle(VIEWS, value=state.loaded, on_change=self._view)
            self.view.props("dense no-caps size=sm")
            ui.label("cam").classes("text-no-wrap")
            self.slider = Slider(0.0, 360.0, 1.0, "angle of the cam, degrees", self._turned)
            self.slider.show(state.angle_deg)
            self.angle = ui.label(f"{state.angle_deg:.0f}°").classes("swgpar-angle")
            self.play = ui.button("play", on_click=self._play).props("flat dense")
        with ui.element("div").props("role=status"):
            self.clearance()

    def draw(self) -> None:
        """Draw the pictures, others where variants come or go."""
        self.angle.text = f"{self.state.angle_deg:.0f}°"
        if not self._moves:
            self.slider.show(self.state.angle_deg)
        if len(self.plots) != len(self.state.shown):
            self.pictures.refresh()
            return
        for plot, variant in zip(self.plots, self.state.shown, strict=True):
            plot.update_figure(self._figure(variant))

    def draw_states(self) -> None:
        """Draw loaded states."""
        if self.state.loaded:
            self.draw()

    def turn(self) -> None:
        """Turn the cam on while it plays."""
        if self.state.plays and not self.state.loaded:
            self.state.angle_deg = (self.state.angle_deg + 1.0) % 360.0
            self.draw()

    @ui.refreshable_method
    def pictures(self) -> None:
        """A picture of each variant."""
        self.plots = []
        two = len(self.state.shown) > 1
        with ui.column().classes("w-full gap-0"):
            for variant in self.state.shown:
                if two:
                    ui.label(variant.name).classes("text-bold")
                plot = ui.plotly(self._figure(variant))
                plot.classes("w-full swgpar-plot" + (" swgpar-half" if two else ""))
                plot.props('role=img aria-label="section of the teeth"')
                self.plots.append(plot)

    @ui.refreshable_method
    def clearance(self) -> None:
        """The smallest clearance of a whole turn, with its place."""
        for variant in self.state.shown:
            found = clearances(variant.design.rigid_pairs)[0]
            word = "overlap" if found.nearest.distance < 0.0 else "smallest clearance"
            name = f"{variant.name}: " if len(self.state.shown) > 1 else ""
            text = f"{name}{word} {abs(1e3 * found.nearest.distance):.2f} µm, {found.place}"
            ui.label(text).classes("text-negative" if found.overlaps else "")

    def _figure(self, variant: Variant) -> dict[str, Any]:
        design, state = variant.design, self.state
        if not state.loaded:
            return section_figure(design, state.angle_deg)
        found = state.worker.state(design)
        return section_figure(design, loaded=found.outline if found is not None else None)

    async def _turned(self, angle: float, moves: bool) -> None:
        self.state.angle_deg, self._moves = angle, moves
        for window in self.state.windows:
            window.draw_section()

    def _view(self) -> None:
        self.state.loaded = bool(self.view.value)
        self.slider.props["disabled"] = self.state.loaded
        self.slider.update()
        for window in self.state.windows:
            window.draw_section()

    def _play(self) -> None:
        self.state.plays = not self.state.plays
        self.play.text = "stop" if self.state.plays else "play"
