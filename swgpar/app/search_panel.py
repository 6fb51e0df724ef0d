"""Designs of a search: a point opens its design as a variant."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from nicegui import events, ui

from swgpar.app.jobs import AppJob
from swgpar.app.state import AppState
from swgpar.app.workspace import drive_of
from swgpar.errors import SwgparError

if TYPE_CHECKING:
    from swgpar.optimisation.tried_designs import TriedDesigns

BEST, FEASIBLE, INFEASIBLE = "#d07a20", "#2f7fb8", "#9a9a9a"


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
    """Objectives of the designs that a search has tried."""

    def __init__(self, state: AppState, job: AppJob, tried: TriedDesigns) -> None:
        self.state, self.job, self.tried = state, job, tried
        with ui.dialog() as self.dialog, ui.card().classes("swgpar-search"):
            ui.label("a click on a point opens its design as a variant").classes("text-caption")
            ui.plotly(self._figure()).classes("w-full").on("plotly_click", self._clicked)
            with ui.row():
                for one in tried.designs:
                    if one.best:
                        name = f"open evaluation {one.number}"
                        ui.button(name, on_click=partial(self._open, one.number)).props("dense")
            ui.button("close", on_click=self.dialog.close).props("flat dense")
        self.dialog.open()

    def _figure(self) -> dict[str, Any]:
        """The first objective against the second one, or against the number of the evaluation."""
        x, y = (*self.tried.objectives, "")[1], self.tried.objectives[0]
        shown = [
            one
            for one in self.tried.designs
            if y in one.quantities and (not x or x in one.quantities)
        ]
        colours = [
            BEST if one.best else FEASIBLE if one.status == "feasible" else INFEASIBLE
            for one in shown
        ]
        texts = [
            f"evaluation {one.number}, {one.status}<br>"
            + "<br>".join(f"{key} = {value}" for key, value in one.values.items())
            for one in shown
        ]
        return {
            "data": [
                {
                    "type": "scatter",
                    "mode": "markers",
                    "x": [one.quantities[x] if x else one.number for one in shown],
                    "y": [one.quantities[y] for one in shown],
                    "customdata": [one.number for one in shown],
                    "marker": {"color": colours, "size": 10},
                    "text": texts,
                    "hoverinfo": "text",
                }
            ],
            "layout": {
                "xaxis": {"title": {"text": x or "evaluation"}},
                "yaxis": {"title": {"text": y}},
                "margin": {"l": 60, "r": 10, "t": 10, "b": 50},
                "font": {"color": "#7a7a7a"},
                "paper_bgcolor": "rgba(0,0,0,0)",
                "plot_bgcolor": "rgba(0,0,0,0)",
            },
            "config": {"displaylogo": False},
        }

    async def _clicked(self, event: events.GenericEventArguments) -> None:
        await self._open(int(event.args["points"][0]["customdata"]))

    async def _open(self, number: int) -> None:
        chosen = next(one for one in self.tried.designs if one.number == number)
        workspace = self.state.workspace
        try:
            design = drive_of(self.tried.table(chosen), {})
        except SwgparError as error:
            ui.notify(str(error), type="warning")
            return
        stem = f"{self.job.arguments[1].removesuffix('.toml')}_{number}"
        workspace.add(workspace.free_name(stem), design)
        self.dialog.close()
        await self.state.draw()
