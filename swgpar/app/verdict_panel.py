"""The rating sheet of the variant that is shown, and what has changed since another one."""

from __future__ import annotations

from pathlib import Path

from nicegui import ui

from swgpar.answers.verdict import Judgement
from swgpar.app.jobs import AppJob, JobState
from swgpar.app.state import AppState
from swgpar.app.tables import heading, live_label, say, table
from swgpar.app.workspace import drive_of
from swgpar.checks.clearance import clearances
from swgpar.checks.remarks import remarks
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import SwgparError
from swgpar.input.differences import Difference, differences
from swgpar.input.toml_file import read_toml
from swgpar.presentation.answer_text import plus_minus, value_text
from swgpar.rating import sheet
from swgpar.rating.sheet_differences import RowDifference, sheet_differences
from swgpar.rating.stored_sheet import StoredRow, StoredSheet, read_sheet
from swgpar.results.quantity import with_unit

COLOURS = {
    Judgement.PASSES: "positive",
    Judgement.NOT_JUDGED: "grey",
    Judgement.WITHIN_ERROR: "warning",
    Judgement.FAILS: "negative",
}


class VerdictPanel:
    """The sheet of the last rating of the variant that is shown, also of one that still runs."""

    def __init__(self, state: AppState) -> None:
        self.state = state
        self._seen = 0  # when the sheet that is shown was written
        self._remarks: tuple[DriveDesign, list[str]] | None = None
        self.remarks()
        heading("rating sheet")
        self.headline = live_label().classes("text-bold")
        self.verdict()
        self.since()

    def draw(self) -> None:
        """Draw what depends on designs and on ratings."""
        self.remarks.refresh()
        self.verdict.refresh()
        self.since.refresh()

    @ui.refreshable_method
    def remarks(self) -> None:
        """What deserves a word, but for overlaps of teeth, which the section and the loaded state
        say."""
        design = self.state.variant.design
        if self._remarks is None or self._remarks[0] is not design:
            said = {one.remark for one in clearances(design.rigid_pairs)}
            self._remarks = design, [one for one in remarks(design) if one not in said]
        for remark in self._remarks[1]:
            ui.label(remark).classes("text-orange-9")

    @ui.refreshable_method
    def verdict(self) -> None:
        """The sheet, and the keys that have changed since then."""
        job = self._last(self.state.variant.name)
        known = sheet_of(self.state.queue.folder, job)
        if job is None or known is None:
            can_rate = self.state.variant.design.rating is not None
            text = "not rated yet: press rate" if can_rate else "add [rating], then rate"
            say(self.headline, "")
            ui.label(text).classes("text-caption")
            return
        self._seen = self._written(job)
        say(self.headline, verdict_text(job, known))
        self.headline.classes(replace=f"text-{COLOURS[known.headline]} text-bold")
        ui.label("bars: share of the limit that is used").classes("text-caption")
        others = [row for row in known.rows if row.limit is None]
        for row in known.rows:
            if row.limit is not None:
                _gauge(row)
        with ui.expansion(f"{len(others)} rows without a limit").classes("w-full"):
            for row in others:
                _gauge(row)
        changed = self._changed_keys(job)
        if changed:
            keys = ", ".join(one.key for one in changed)
            ui.label(f"changed since this rating: {keys}").classes("text-orange-9 text-caption")

    @ui.refreshable_method
    def since(self) -> None:
        """Answers that differ from those of the variant beside, or of the rating before."""
        variant, other = self.state.variant.name, self.state.workspace.other
        last, before = self._last(variant), self._last(variant, 1)
        names = ("before", "last")
        if other is not None and other.name != variant:
            before, names = self._last(other.name), (other.name, variant)
        folder = self.state.queue.folder
        first, second = sheet_of(folder, before), sheet_of(folder, last)
        if first is None or second is None:
            return
        heading("answers that differ")
        rows = [_difference(one) for one in sheet_differences(first, second)]
        if not rows:
            ui.label("none").classes("text-caption")
            return
        table(["answer", *names, "change"], rows, "answers that differ").classes("swgpar-since")
        ui.label("± is the sum of both errors").classes("text-caption")

    def look(self) -> None:
        """Draw a sheet that has been written since."""
        job = self._last(self.state.variant.name)
        if job is not None and self._written(job) != self._seen:
            self.draw()

    def _last(self, variant: str, before: int = 0) -> AppJob | None:
        """The last rating of a variant that has written a sheet, or one before it; a job that
        continues another one is the same rating."""
        found = {
            job.out: job
            for job in self.state.queue.jobs
            if job.command == "rate" and job.variant == variant and self._written(job)
        }
        jobs = list(found.values())
        return jobs[-1 - before] if len(jobs) > before else None

    def _written(self, job: AppJob) -> int:
        """When the sheet of a rating was written, ns; 0 where it is not."""
        try:
            return (self.state.queue.folder / job.out / sheet.JSON).stat().st_mtime_ns
        except OSError:
            return 0

    def _changed_keys(self, job: AppJob) -> list[Difference]:
        """Keys that have changed since a job."""
        try:
            table = read_toml(self.state.queue.folder / job.arguments[1])
            return differences(drive_of(table, {}), self.state.variant.design)
        except SwgparError:
            return []


def sheet_of(folder: Path, job: AppJob | None) -> StoredSheet | None:
    """The sheet of a rating in the workspace folder; None where it cannot be read."""
    if job is None:
        return None
    try:
        return read_sheet(folder / job.out)
    except SwgparError:
        return None


def verdict_text(job: AppJob, known: StoredSheet) -> str:
    """The verdict of a rating, and where the rating is."""
    said = known.sentence or f"{known.headline}: {known.title}"
    return said if job.state == JobState.FINISHED else f"rating {job.state}, so far: {said}"


def _gauge(row: StoredRow) -> None:
    """A row of the sheet with the share of its limit."""
    judgement = Judgement(row.verdict)
    with ui.element("div").classes("w-full swgpar-gauge"):
        limit = "" if row.limit is None else f", {row.sense} {row.limit:.5g}"
        amount = f"{row.row}: {_value(row)} {row.unit}".rstrip()
        ui.label(f"{amount}{limit}").classes("text-caption")
        if row.used is not None:
            bar = ui.linear_progress(min(row.used, 1.0), show_value=False, size="8px")
            bar.props(f"color={COLOURS[judgement]}")
            bar.props["aria-label"] = f"{row.row}: {100.0 * row.used:.0f} % of the limit"
        text = f"{judgement}: {row.reason}" if row.reason else str(judgement)
        ui.label(text).classes(f"text-{COLOURS[judgement]} text-caption")
        if note := "; ".join(filter(None, (row.place, row.remark if row.remark != text else ""))):
            ui.label(note).classes("text-grey text-caption")


def _value(row: StoredRow | None) -> str:
    if row is None or row.value is None:
        return "—"
    error = "" if row.error is None else f" {plus_minus(row.error)}"
    return f"{value_text(row.value, row.error)}{error}"


def _difference(one: RowDifference) -> list[str]:
    """A row of the table of differences."""
    verdicts = [row.verdict for row in (one.first, one.second) if row is not None]
    change = "—"
    if one.change is not None:
        change = f"{'+' if one.change > 0.0 else ''}{value_text(one.change, one.error)}"
        change += "" if one.error is None else f" {plus_minus(one.error)}"
    if len(set(verdicts)) > 1:
        change += f"; {verdicts[0]}, now {verdicts[1]}"
    return [with_unit(one.name, one.unit), _value(one.first), _value(one.second), change]
