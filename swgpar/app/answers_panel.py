"""Answers beside the section: loaded state, rating sheet, differences of variants, geometry."""

from __future__ import annotations

from pathlib import Path

from nicegui import ui

from swgpar.answers.verdict import Judgement
from swgpar.app.jobs import AppJob, JobState
from swgpar.app.plane_state import PlaneState
from swgpar.app.state import AppState
from swgpar.app.tables import table
from swgpar.app.workspace import drive_of
from swgpar.checks.derived_geometry import derived_geometry
from swgpar.checks.remarks import remarks
from swgpar.errors import SwgparError
from swgpar.input.differences import Difference, differences
from swgpar.input.quantities import show, unit_of_key
from swgpar.input.toml_file import read_toml
from swgpar.rating.stored_sheet import StoredRow, StoredSheet, read_sheet

COLOURS = {
    Judgement.PASSES: "positive",
    Judgement.NOT_JUDGED: "grey",
    Judgement.WITHIN_ERROR: "warning",
    Judgement.FAILS: "negative",
}


class AnswersPanel:
    """Answers of the variants that are shown."""

    def __init__(self, state: AppState) -> None:
        self.state = state
        self._sheet: tuple[Path, StoredSheet] | None = None
        self.plane()
        self.verdict()
        self.changes()
        with ui.expansion("derived geometry", on_value_change=self._opened) as self.folded:
            self.geometry()
        self.folded.classes("w-full")

    def draw(self) -> None:
        """Draw what depends on designs."""
        self.plane.refresh()
        self.verdict.refresh()
        self.changes.refresh()
        if self.folded.value:
            self.geometry.refresh()

    @ui.refreshable_method
    def plane(self) -> None:
        """Answers of the plane model under the torque of the design."""
        worker, shown = self.state.worker, self.state.shown
        title = ui.row().classes("items-center")
        title.props["data-plane-state"] = "busy" if worker.is_busy else "computed"
        with title:
            ui.label("plane model, loaded").classes("text-bold")
            if worker.is_busy:
                ui.spinner(size="sm").props('aria-label="is computed"')
        states = [worker.state(variant.design) for variant in shown]
        for found in states:
            if found is not None and found.reason:
                ui.label(found.reason).classes("text-negative text-caption")
        texts = [_texts(found) for found in states]
        names = list(dict.fromkeys(name for one in texts for name in one))
        if names:
            headings = [variant.name for variant in shown] if len(shown) > 1 else ["value"]
            rows = [[name, *(one.get(name, "") for one in texts)] for name in names]
            table(["answer", *headings], rows, "plane model").classes("swgpar-plane")
        seconds = [found.seconds for found in states if found is not None]
        if seconds:
            text = f"computed in {seconds[0]:.1f} s; no estimate of errors by the mesh"
            ui.label(text).classes("text-caption")

    @ui.refreshable_method
    def verdict(self) -> None:
        """The sheet of the last rating of the variant, and what has changed since then."""
        for remark in remarks(self.state.variant.design):
            ui.label(remark).classes("text-orange-9")
        ui.label("rating sheet").classes("text-bold")
        job = self._rating()
        sheet = self._read(job) if job is not None else None
        if job is None or sheet is None:
            text = "not rated yet: press rate" if self._can_rate() else "add [rating], then rate"
            ui.label(text).classes("text-caption")
            return
        label = ui.label(f"{sheet.headline}: {sheet.title}").props("role=status")
        label.classes(f"text-{COLOURS[sheet.headline]} text-bold")
        for row in sheet.rows:
            _gauge(row)
        changed = self._since(job)
        if changed:
            keys = ", ".join(one.key for one in changed)
            ui.label(f"changed since this rating: {keys}").classes("text-orange-9 text-caption")

    @ui.refreshable_method
    def changes(self) -> None:
        """Keys in which the variants differ."""
        if len(self.state.shown) < 2:
            return
        first, second = (variant.design for variant in self.state.shown)
        ui.label("keys that differ").classes("text-bold")
        rows = [
            [f"{one.key} {_unit(unit_of_key(first, one.key))}", *map(_value, _pair(one))]
            for one in differences(first, second)
        ]
        names = [variant.name for variant in self.state.shown]
        if not rows:
            ui.label("none").classes("text-caption")
            return
        table(["key", *names], rows, "keys that differ").classes("swgpar-changes")

    @ui.refreshable_method
    def geometry(self) -> None:
        """What follows from the design without a run; slower than the section, so folded."""
        if self.folded.value:
            values = derived_geometry(self.state.variant.design)
            rows = [[name, f"{value:.6g}"] for name, value in values.items()]
            table(["quantity", "value"], rows, "derived geometry")

    def _opened(self) -> None:
        self.geometry.refresh()

    def _can_rate(self) -> bool:
        return self.state.variant.design.rating is not None

    def _rating(self) -> AppJob | None:
        """The last rating of the variant that has ended."""
        jobs = [
            job
            for job in self.state.queue.jobs
            if job.command == "rate"
            and job.variant == self.state.variant.name
            and job.state == JobState.FINISHED
        ]
        return jobs[-1] if jobs else None

    def _read(self, job: AppJob) -> StoredSheet | None:
        folder = self.state.queue.folder / job.out
        if self._sheet is None or self._sheet[0] != folder:
            try:
                self._sheet = folder, read_sheet(folder)
            except SwgparError:
                return None
        return self._sheet[1]

    def _since(self, job: AppJob) -> list[Difference]:
        """Keys that have changed since a job."""
        try:
            table = read_toml(self.state.queue.folder / job.arguments[1])
            return differences(drive_of(table, {}), self.state.variant.design)
        except SwgparError:
            return []


def _texts(state: PlaneState | None) -> dict[str, str]:
    """Values of answers by their texts."""
    if state is None:
        return {}
    return {
        one.text: f"{one.value:.4g} {one.unit}"
        + ("" if one.error is None else f" ± {one.error:.2g}")
        for one in state.answers
    }


def _gauge(row: StoredRow) -> None:
    """A row of the sheet with the share of its limit."""
    judgement = Judgement(row.verdict)
    with ui.element("div").classes("w-full swgpar-gauge"):
        value = "—" if row.value is None else f"{row.value:.4g} {row.unit}"
        error = "" if row.error is None else f" ± {row.error:.2g}"
        limit = "" if row.limit is None else f", {row.sense} {row.limit:.4g}"
        ui.label(f"{row.row}: {value}{error}{limit}").classes("text-caption")
        if row.used is not None:
            bar = ui.linear_progress(min(row.used, 1.0), show_value=False, size="8px")
            bar.props(f"color={COLOURS[judgement]}")
            bar.props["aria-label"] = f"{row.row}: {100.0 * row.used:.0f} % of the limit"
        text = f"{judgement}: {row.reason}" if row.reason else str(judgement)
        ui.label(text).classes(f"text-{COLOURS[judgement]} text-caption")


def _pair(one: Difference) -> tuple[object, object]:
    return one.first, one.second


def _value(value: object) -> str:
    return "—" if value is None else show(value)


def _unit(unit: str) -> str:
    return f"({unit})" if unit else ""
