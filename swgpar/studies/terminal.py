"""Terminal output of a study: a line for each case and mesh, a bar if there is a terminal, tables
at the end."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

from rich import box
from rich.table import Table

from swgpar import watch
from swgpar.log import console, progress_bar
from swgpar.studies.case import Job, Outcome
from swgpar.studies.table import Comparison, Result, shown_quantities

COLUMNS = 5
"""Quantities that the table on the terminal shows: study.csv has all of them."""


class StudyProgress:
    """Lines and bar of rank 0; counts increments.

    Parameters
    ----------
    jobs : all jobs of the study
    """

    def __init__(self, jobs: Sequence[Job]) -> None:
        self._jobs = jobs
        self._done = [0] * len(jobs)
        self._finished = 0
        self._width = max(len(job.title) for job in jobs)
        self._bar = progress_bar() if console.is_terminal else None
        if self._bar:
            self._task = self._bar.add_task("increments", total=sum(job.increments for job in jobs))
            self._bar.start()

    def increment(self, number: int) -> None:
        """An increment of job `number` has been computed."""
        self._done[number] += 1
        self._update()

    def outcome(self, number: int, outcome: Outcome) -> None:
        """Job `number` has ended."""
        job = self._jobs[number]
        self._done[number] = job.increments
        self._finished += 1
        count = f"{self._finished:{len(str(len(self._jobs)))}d}/{len(self._jobs)}"
        words = [f"{count}  {job.title:{self._width}s}"]
        if outcome.status == "finished":
            words.append(f"{outcome.wall_s:8.1f} s")
            if outcome.newton_mean is not None:
                words.append(f"{outcome.newton_mean:5.1f} Newton iterations")
            words.append("finished before" if outcome.kept else "finished")
        else:
            words.append(f"failed: {outcome.reason}")
        with suppress(
            OSError, SystemExit
        ):  # the reader of our output has gone: the others are at work
            console.print("  ".join(words), markup=False)
            watch.note_output()
        self._update()

    def stop(self) -> None:
        """Take the bar away."""
        if self._bar:
            self._bar.stop()

    def _update(self) -> None:
        if self._bar:
            self._bar.update(self._task, completed=sum(self._done))


def print_results(results: Sequence[Result], comparisons: Sequence[Comparison]) -> None:
    """Print the first quantities of all cases, then published beside computed values."""
    quantities = list(shown_quantities(results).items())[:COLUMNS]
    cases = Table(
        box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0)
    )  # long names are folded into 80 columns
    cases.add_column("case", overflow="fold")
    for name, quantity in quantities:
        unit = f" {quantity.unit}" if quantity.unit else ""
        cases.add_column(f"{name}{unit}", justify="right", overflow="fold")
    cases.add_column("s", justify="right", no_wrap=True)
    for job, outcome in results:
        if outcome.status == "finished":
            numbers = [*(outcome.values.get(name) for name, _ in quantities), outcome.wall_s]
            texts = ["" if value is None else f"{value:.5g}" for value in numbers]
        else:
            texts = ["failed"]
        cases.add_row(job.title, *texts)
    console.print(cases)
    if not comparisons:
        return
    published = Table(title="published values", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
    published.add_column("case", overflow="fold")
    published.add_column("quantity", overflow="fold")
    for name in ("published", "computed", "%", "error estimate", ""):
        published.add_column(name, justify="right", no_wrap=True)
    for c in comparisons:
        numbers = [c.published, c.computed, c.difference, c.estimate.error if c.estimate else None]
        published.add_row(
            c.case,
            c.quantity,
            *("" if value is None else f"{value:.5g}" for value in numbers),
            c.verdict,
        )
    console.print(published)
