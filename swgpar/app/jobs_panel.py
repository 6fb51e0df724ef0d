"""The queue: runs, ratings, files of other programs, studies and searches of the folder."""

from __future__ import annotations

from functools import partial

from nicegui import ui

from swgpar.app.choices import USUAL, most_ranks
from swgpar.app.durations import durations
from swgpar.app.jobs import AppJob, JobState
from swgpar.app.search_panel import show_search
from swgpar.app.state import AppState, files_of, recipes_of
from swgpar.app.tables import live_label, say
from swgpar.app.verdict_panel import COLOURS, sheet_of, verdict_text
from swgpar.errors import SwgparError
from swgpar.results.folder import FIELD_INDEX

MESHES = (USUAL, "coarse", "forces", "medium", "full", "plane_coarse", "plane")
"""Recipes of the package that are offered; those of the folder come after them."""

ACCURACIES = {"": "of the mesh", "0.05": "5 %", "0.02": "2 %"}
"""Relative errors of the largest tension at the teeth for which meshes are refined."""

LAST = 8
"""Jobs that are shown."""

SAID = 3
"""Jobs whose states are said."""

FORMATS = ("step", "dxf", "csv", "teeth")
"""Formats of `swgpar export` that a design has."""


class JobsPanel:
    """Buttons that put jobs into the queue, and the queue."""

    def __init__(self, state: AppState) -> None:
        self.state = state
        self._logs: list[tuple[AppJob, ui.label, int]] = []
        with ui.row().classes("items-center"):
            ui.button("run", on_click=self._run)
            ui.button("rate", on_click=self._rate)
            with ui.dropdown_button("export", auto_close=True).classes("swgpar-export"):
                for name in FORMATS:
                    item = ui.item(name.upper() if name != "teeth" else "points of the teeth")
                    item.on_click(lambda name=name: self._design("export", "--format", name))
        with ui.row().classes("items-center no-wrap"):
            self.meshes = [*MESHES, *recipes_of(state.workspace.folder)]
            self.mesh = ui.select(self.meshes, value=USUAL, label="mesh")
            self.accuracy = ui.select(ACCURACIES, value="", label="accuracy")
            self.accuracy.tooltip("error of the stress at the teeth for which meshes are refined")
            self.ranks = ui.number("ranks", value=1, min=1, max=most_ranks())
            for choice, width in ((self.mesh, 24), (self.accuracy, 28), (self.ranks, 16)):
                choice.props("dense").classes(f"min-w-{width} w-{width}")
        self.lasts = live_label().classes("text-caption")
        self.draw_choices()
        for choice in (self.mesh, self.accuracy, self.ranks):
            choice.on_value_change(self._choose)
        self.files()
        self.said = live_label().classes("text-caption")
        with ui.column().classes("w-full swgpar-queue"):
            self.jobs()
        self.dialogs = ui.element("div")  # the queue is drawn anew while they are open

    def draw_choices(self) -> None:
        """Show what is chosen for the next jobs; a recipe that is gone is the usual mesh."""
        chosen = self.state.choices
        self.mesh.value = chosen.mesh if chosen.mesh in self.meshes else USUAL
        self.accuracy.value = chosen.accuracy if chosen.accuracy in ACCURACIES else ""
        self.ranks.value = chosen.ranks
        self.draw_durations()

    def _choose(self) -> None:
        self.state.choose(str(self.mesh.value), str(self.accuracy.value), self._ranks())

    def draw_durations(self) -> None:
        """Say how long commands take on the mesh that is chosen."""
        mesh = "" if self.mesh.value == USUAL else str(self.mesh.value)
        design, folder = self.state.variant.design, self.state.workspace.folder
        say(self.lasts, durations(design, mesh, folder))

    @ui.refreshable_method
    def files(self) -> None:
        """Studies and searches of the folder."""
        folder = self.state.workspace.folder
        for command, section in (("study", "study"), ("optimise", "optimise")):
            for path in files_of(folder, section):
                with ui.row().classes("items-center"):
                    ui.label(f"{command} {path.name}").classes("text-caption")
                    start = partial(self._file, command, path.name)
                    ui.button("start", on_click=start).props("flat dense")

    @ui.refreshable_method
    def jobs(self) -> None:
        """The last jobs, with their commands and states."""
        self._logs.clear()
        last = self.state.queue.jobs[-LAST:]
        say(self.said, ", ".join(f"job {job.number} {job.state}" for job in last[-SAID:]))
        for job in reversed(last):
            with ui.card().props("flat bordered").classes("w-full gap-1 q-pa-sm swgpar-job"):
                self._job(job)

    def draw_logs(self) -> None:
        """Draw what jobs that run have printed, and the pages that they have written."""
        if any(written != self._written(job) for job, _, written in self._logs):
            self.jobs.refresh()
        for job, log, _ in self._logs:
            log.text = self.state.queue.progress(job)

    def _written(self, job: AppJob) -> int:
        """When the page of a job was written, ns; 0 where it is not."""
        path = self.state.queue.folder / job.page if job.page is not None else None
        return path.stat().st_mtime_ns if path is not None and path.is_file() else 0

    def _job(self, job: AppJob) -> None:
        queue = self.state.queue
        title = ", ".join(filter(None, (f"{job.number}: {job.state}", job.variant)))
        ui.label(title).classes("text-bold")
        ui.label(job.typed).classes("text-caption")
        if job.reason:
            ui.label(job.reason).classes("text-negative text-caption")
        if job.state == JobState.RUNS:
            log = ui.label(queue.progress(job)).classes("swgpar-log")
            self._logs.append((job, log, self._written(job)))
        if job.command == "rate" and (known := sheet_of(queue.folder, job)) is not None:
            ui.label(verdict_text(job, known)).classes(f"text-{COLOURS[known.headline]} text-bold")
        with ui.row().classes("items-center"):
            if self._written(job):
                ui.link("report", f"/{job.page}", new_tab=True)
                if job.command == "run" and (queue.folder / job.out / FIELD_INDEX).exists():
                    ui.button("3D", on_click=lambda: self._view(job)).props("flat dense")
            if job.command == "optimise":
                ui.button("designs", on_click=lambda: self._designs(job)).props("flat dense")
            if job.command == "export" and job.state == JobState.FINISHED:
                for path in sorted((queue.folder / job.out).iterdir()):
                    ui.link(path.name, f"/{job.out}/{path.name}").props("download")
            if job.state in (JobState.WAITS, JobState.RUNS):
                ui.button("cancel", on_click=lambda: self._cancel(job)).props("flat dense")
            elif job.continued and job.state != JobState.FINISHED and queue.is_last(job):
                ui.button("continue", on_click=lambda: self._go_on(job)).props("flat dense")

    def _view(self, job: AppJob) -> None:
        """The view of the report: turned, cut, with values under the pointer."""
        card = "w-full h-full"
        with self.dialogs, ui.dialog().props("maximized") as dialog, ui.card().classes(card):
            ui.button("close", on_click=dialog.close).props("flat dense")
            frame = ui.element("iframe").classes("w-full grow swgpar-view")
            frame.props["src"] = f"/{job.page}#scene"
            frame.props["title"] = f"deformed drive of job {job.number}"
        dialog.open()

    def _designs(self, job: AppJob) -> None:
        with self.dialogs:
            show_search(self.state, job)

    def _run(self) -> None:
        self._choose()
        self._design("run", *self.state.choices.options)

    def _rate(self) -> None:
        self._choose()
        self._design("rate", *self.state.choices.options)

    def _ranks(self) -> int:
        return int(min(max(self.ranks.value or 1, 1), most_ranks()))

    def _design(self, command: str, *options: str) -> None:
        ranks = 1 if command == "export" else self._ranks()
        try:
            self.state.queue_design(command, options, ranks)
        except SwgparError as error:
            ui.notify(str(error), type="warning")
        self.state.draw_jobs()

    def _file(self, command: str, name: str) -> None:
        out = f"results/{name.removesuffix('.toml')}_{self.state.queue.next_number}"
        self._add([command, name, "--out", out], out)

    def _go_on(self, job: AppJob) -> None:
        self._add(job.continued, job.out, job.variant)

    def _add(self, arguments: list[str], out: str, variant: str = "") -> None:
        try:
            self.state.queue.add(arguments, out, self._ranks(), variant)
        except SwgparError as error:
            ui.notify(str(error), type="warning")
        self.state.draw_jobs()

    def _cancel(self, job: AppJob) -> None:
        self.state.queue.cancel(job)
        self.state.draw_jobs()
