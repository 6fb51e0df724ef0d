"""The page: keys of the design, section of the teeth, answers, jobs."""

from __future__ import annotations

import os
from collections import defaultdict
from typing import Any

from nicegui import ui

from swgpar.app.fields import FormField, form_fields
from swgpar.app.jobs import AppJob, JobQueue, JobState
from swgpar.app.key_control import KeyControl
from swgpar.app.plane_state import PlaneWorker
from swgpar.app.section_picture import section_picture
from swgpar.app.section_plot import section_figure
from swgpar.app.workspace import Variant, Workspace
from swgpar.checks.clearance import clearances
from swgpar.checks.derived_geometry import derived_geometry
from swgpar.checks.remarks import remarks
from swgpar.errors import SwgparError
from swgpar.results.atomic import write_file

LOOK = 1.0
"""Seconds between two looks at the jobs."""

PLAY = 0.2
"""Seconds between two pictures while the cam turns."""


class AppState:
    """What all windows of the app show.

    workspace : variants;  queue : jobs;  worker : of plane states
    angle_deg : of the cam
    refused : entries that were refused and their sentences, by their keys
    pages : windows that are open
    """

    def __init__(self, workspace: Workspace, queue: JobQueue, worker: PlaneWorker) -> None:
        self.workspace, self.queue, self.worker = workspace, queue, worker
        self.angle_deg, self.plays = 0.0, False
        self.refused: dict[str, tuple[Any, str]] = {}
        self.pages: list[Page] = []

    @property
    def variant(self) -> Variant:
        """The one that is shown."""
        return self.workspace.variant

    def set(self, field: FormField, entry: Any) -> None:
        """Take over an entry of the form; a refused one stays with its sentence."""
        try:
            self.variant.change({field.key: field.parsed(entry)})
        except SwgparError as error:
            self.refused[field.key] = entry, str(error)
        else:
            self.refused.clear()
            self.workspace.keep()
        self.draw()

    def draw(self) -> None:
        """Draw all that depends on the design, in all windows."""
        self.worker.want(self.variant.design)
        for page in self.pages:
            page.draw()

    def draw_jobs(self) -> None:
        """Draw the queue, in all windows."""
        for page in self.pages:
            page.jobs.refresh()


class Page:
    """One window. Its parts are drawn again in all windows when the state has changed."""

    def __init__(self, state: AppState) -> None:
        self.state = state
        self.controls: dict[str, KeyControl] = {}
        self._was_busy = False
        with ui.header().classes("items-center gap-4 q-px-md q-py-xs"):
            ui.label("swgpar").classes("text-h6")
            self.header()
        with ui.row().classes("w-full items-start no-wrap-md gap-4 swgpar-columns"):
            with ui.column().classes("swgpar-form"):
                self.form()
            with ui.column().classes("swgpar-section"):
                self.plot, self.slider = self._make_section()
            with ui.column().classes("swgpar-answers"):
                self.plane()
                self.answers()
                self.jobs()
        ui.timer(LOOK, self._look)
        ui.timer(PLAY, self._turn)
        state.pages.append(self)
        ui.context.client.on_delete(lambda: state.pages.remove(self))

    # -- header ------------------------------------------------------------------------------------

    @ui.refreshable_method
    def header(self) -> None:
        """Variants, undo, redo, save."""
        workspace = self.state.workspace
        ui.select(
            sorted(workspace.variants),
            value=workspace.shown,
            label="variant",
            on_change=lambda event: self._show(event.value),
        ).props("dense dark outlined").classes("min-w-32")
        ui.button("undo", on_click=self._undo).props("flat dense color=white")
        ui.button("redo", on_click=self._redo).props("flat dense color=white")
        ui.button("copy", on_click=self._copy).props("flat dense color=white")
        ui.button("save", on_click=self._save).props("flat dense color=white")

    def _show(self, name: str) -> None:
        self.state.workspace.shown = name
        self.state.refused.clear()
        self.state.draw()

    def _undo(self) -> None:
        if self.state.variant.undo():
            self.state.workspace.keep()
        self.state.draw()

    def _redo(self) -> None:
        if self.state.variant.redo():
            self.state.workspace.keep()
        self.state.draw()

    def _copy(self) -> None:
        workspace = self.state.workspace
        stem, number = workspace.shown[:50], 2
        while f"{stem}_{number}" in workspace.variants:
            number += 1
        workspace.add(f"{stem}_{number}", workspace.variant.design)
        workspace.keep()
        self.state.draw()

    def _save(self) -> None:
        try:
            path = self.state.workspace.save()
        except SwgparError as error:
            ui.notify(str(error), type="warning")
            return
        ui.notify(f"written {path.name}", type="positive")

    # -- form --------------------------------------------------------------------------------------

    @ui.refreshable_method
    def form(self) -> None:
        """Fields of all keys in their sections."""
        sections: dict[str, list[FormField]] = defaultdict(list)
        for field in form_fields(self.state.variant.design):
            sections[field.section].append(field)
        self.controls.clear()
        for name, fields in sections.items():
            with ui.expansion(f"[{name}]", value=name == "drive").classes("w-full"):
                for field in fields:
                    self.controls[field.key] = KeyControl(field, self.state.set)

    # -- section -----------------------------------------------------------------------------------

    def _make_section(self) -> tuple[ui.plotly, ui.slider]:
        """The picture, and the angle of the cam."""
        plot = ui.plotly(self._figure()).classes("w-full swgpar-plot")
        with ui.row().classes("w-full items-center no-wrap gap-4"):
            ui.label("angle of the cam, °")
            slider = ui.slider(min=0.0, max=360.0, step=1.0, value=self.state.angle_deg)
            slider.props('label aria-label="angle of the cam"').classes("grow")
            slider.on_value_change(lambda event: self._turned(event.value))
            ui.button("play", on_click=self._play).props("flat dense")
        self.clearance()
        return plot, slider

    @ui.refreshable_method
    def clearance(self) -> None:
        """The smallest clearance of a whole turn, with its place."""
        found = clearances(self.state.variant.design)[0]
        word = "overlap" if found.nearest.distance < 0.0 else "smallest clearance"
        text = f"{word} {abs(1e3 * found.nearest.distance):.2f} µm, {found.place}"
        ui.label(text).classes("text-negative" if found.overlaps else "").props("role=status")

    def _figure(self) -> dict[str, Any]:
        design = self.state.variant.design
        return section_figure(design, section_picture(design, self.state.angle_deg))

    def _turned(self, angle: float) -> None:
        self.state.angle_deg = float(angle)
        self.plot.update_figure(self._figure())

    def _play(self) -> None:
        self.state.plays = not self.state.plays

    def _turn(self) -> None:
        if self.state.plays:
            self.slider.value = (self.state.angle_deg + 1.0) % 360.0

    # -- answers and jobs --------------------------------------------------------------------------

    @ui.refreshable_method
    def plane(self) -> None:
        """Answers of the plane model under the torque of the design."""
        worker = self.state.worker
        state = worker.state
        with ui.row().classes("items-center"):
            ui.label("plane model, loaded").classes("text-bold")
            if worker.is_busy:
                ui.spinner(size="sm").props('aria-label="is computed"')
        if state is None:
            return
        if state.reason:
            ui.label(state.reason).classes("text-negative text-caption")
            return
        rows = [
            {
                "name": one.text,
                "value": f"{one.value:.4g} {one.unit}",
                "error": "no estimate" if one.error is None else f"± {one.error:.2g}",
            }
            for one in state.answers
        ]
        columns = [
            {"name": name, "label": label, "field": name, "align": align}
            for name, label, align in (
                ("name", "answer", "left"),
                ("value", "value", "right"),
                ("error", "error", "right"),
            )
        ]
        table = ui.table(rows=rows, columns=columns).props("dense flat wrap-cells")
        table.props["data-busy"] = str(worker.is_busy).lower()
        table.classes("w-full swgpar-plane")
        ui.label(f"computed in {state.seconds:.1f} s").classes("text-caption")

    @ui.refreshable_method
    def answers(self) -> None:
        """What follows from the design without a run."""
        design = self.state.variant.design
        for remark in remarks(design):
            ui.label(remark).classes("text-orange-9")
        rows = [
            {"name": name, "value": f"{value:.6g}"}
            for name, value in derived_geometry(design).items()
        ]
        columns = [
            {"name": "name", "label": "quantity", "field": "name", "align": "left"},
            {"name": "value", "label": "value", "field": "value", "align": "right"},
        ]
        with ui.expansion("derived geometry").classes("w-full"):
            ui.table(rows=rows, columns=columns).props("dense flat").classes("w-full")

    @ui.refreshable_method
    def jobs(self) -> None:
        """The queue, and buttons that put a job into it."""
        with ui.row().classes("items-center"):
            for name, mesh in (("run coarse", "coarse"), ("rate", "")):
                ui.button(name, on_click=lambda _, mesh=mesh: self._queue(mesh)).props("dense")
        for job in reversed(self.state.queue.jobs[-8:]):
            self._job(job)

    def _job(self, job: AppJob) -> None:
        with ui.card().tight().classes("w-full q-pa-sm"):
            ui.label(f"{job.number}: {job.state}").classes("text-bold")
            ui.label(job.typed).classes("text-caption")
            if job.reason:
                ui.label(job.reason).classes("text-negative text-caption")
            if (self.state.queue.folder / job.page).is_file():
                ui.link("report", f"/{job.page}", new_tab=True)
            if job.state == JobState.RUNS:
                ui.label(self.state.queue.last_lines(job, 3)).classes("swgpar-log")
            if job.state in (JobState.WAITS, JobState.RUNS):
                ui.button("cancel", on_click=lambda: self._cancel(job)).props("flat dense")

    def _queue(self, mesh: str) -> None:
        workspace, queue = self.state.workspace, self.state.queue
        number = queue.next_number
        design = workspace.folder / "jobs" / f"{number}.toml"
        design.parent.mkdir(exist_ok=True)
        write_file(design, workspace.variant.text.encode())
        out = f"results/{workspace.shown}_{number}"
        name = f"jobs/{number}.toml"
        command = ["run", name, "--mesh", mesh] if mesh else ["rate", name]
        ranks = min(2, os.cpu_count() or 1)
        try:
            queue.add([*command, "--out", out], out, ranks)
        except SwgparError as error:
            ui.notify(str(error), type="warning")
        self.state.draw_jobs()

    def _cancel(self, job: AppJob) -> None:
        self.state.queue.cancel(job)
        self.state.draw_jobs()

    def _look(self) -> None:
        queue = self.state.queue
        if self.state.worker.look() or self._was_busy != self.state.worker.is_busy:
            self._was_busy = self.state.worker.is_busy
            for page in self.state.pages:
                page.plane.refresh()
        if queue.step():
            self.state.draw_jobs()
        elif any(job.state == JobState.RUNS for job in queue.jobs):
            self.jobs.refresh()

    def draw(self) -> None:
        """Draw all that depends on the design."""
        self.plot.update_figure(self._figure())
        self.clearance.refresh()
        fields = {field.key: field for field in form_fields(self.state.variant.design)}
        self.header.refresh()
        if fields.keys() != self.controls.keys():
            self.form.refresh()
        for key, control in self.controls.items():
            control.show(fields[key], self.state.refused.get(key))
        self.answers.refresh()
