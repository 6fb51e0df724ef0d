"""Designs of a search: a point opens its design as a variant."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nicegui import events, ui

from swgpar.app.jobs import AppJob
from swgpar.app.search_plot import EVALUATION, pair_figure, parallel_figure, words
from swgpar.app.state import AppState
from swgpar.app.tables import live_label
from swgpar.app.workspace import drive_of
from swgpar.errors import SwgparError

if TYPE_CHECKING:
    from swgpar.optimisation.tried_designs import TriedDesigns

VIEWS = {False: "two quantities", True: "parallel coordinates"}


def show_search(state: AppState, job: AppJob) -> None:
    """Show the designs that a search has tried so far."""
    from swgpar.optimisation.tried_designs import read_tried

    folder = state.workspace.folder
    try:
        tried = read_tried(folder / job.arguments[1], folder / job.out)
    except SwgparError as error:
        ui.notify(str(error), type="warning")
        return
    SearchDialog(state, job, tried)


class SearchDialog:
    """Variables, objectives and constraints of the designs that a search has tried."""

    def __init__(self, state: AppState, job: AppJob, tried: TriedDesigns) -> None:
        self.state, self.job, self.tried = state, job, tried
        objectives = list(dict.fromkeys(one.name for one in tried.section.objective))
        names = [*tried.section.quantities, *(one.name for one in tried.section.variable)]
        with ui.dialog() as self.dialog, ui.card().classes("swgpar-search"):
            ui.label("a click on a point opens its design as a variant").classes("text-caption")
            with ui.row().classes("items-center"):
                self.view = ui.toggle(VIEWS, value=False, on_change=self._draw)
                self.view.props("dense no-caps size=sm")
                first, second = objectives[0], [*objectives, EVALUATION][1]
                self.x = ui.select([*names, EVALUATION], value=second, label="across")
                self.y = ui.select(names, value=first, label="up")
                for axis in (self.x, self.y):
                    axis.on_value_change(self._draw)
                    axis.bind_visibility_from(self.view, "value", value=False)
            self.plot = ui.plotly(self._figure()).classes("w-full")
            self.plot.props('role=img aria-label="designs of the search"')
            self.plot.on("plotly_click", self._clicked)
            if tried.evaluations:
                numbers = sorted(tried.evaluations, key=lambda n: (n not in tried.best, n))
                texts = {n: f"{n}: {words(tried, n)}" for n in numbers}
                with ui.row().classes("items-center"):
                    chosen = ui.select(texts, value=numbers[0], label="evaluation")
                    chosen.classes("min-w-48")
                    ui.button("open", on_click=lambda: self._open(chosen.value)).props("dense")
                reason = live_label().classes("text-caption")
                reason.bind_text_from(chosen, "value", lambda n: tried.evaluations[n].reason)
            ui.button("close", on_click=self.dialog.close).props("flat dense")
        self.dialog.open()

    def _figure(self) -> dict[str, object]:
        if self.view.value:
            return parallel_figure(self.tried)
        return pair_figure(self.tried, self.x.value, self.y.value)

    def _draw(self) -> None:
        self.plot.update_figure(self._figure())

    async def _clicked(self, event: events.GenericEventArguments) -> None:
        await self._open(int(event.args["points"][0]["customdata"]))

    async def _open(self, number: int) -> None:
        workspace = self.state.workspace
        try:
            design = drive_of(self.tried.table(number), {})
        except SwgparError as error:
            ui.notify(str(error), type="warning")
            return
        stem = f"{self.job.arguments[1].removesuffix('.toml')}_{number}"
        workspace.add(workspace.free_name(stem), design)
        self.dialog.close()
        await self.state.draw()
