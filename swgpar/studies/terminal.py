"""Terminal output of a study: a line for each case and mesh, a bar if there is a terminal, tables
at the end."""

from __future__ import annotations

from collections.abc import Sequence

from swgpar.log import console, progress_bar
from swgpar.results.number_tables import Labels, number_tables
from swgpar.results.page import number
from swgpar.studies.case import Job, Outcome
from swgpar.studies.many_runs import print_line
from swgpar.studies.table import CaseComparison, JobResult, shown_quantities

COLUMNS = 5
"""Quantities that the table on the terminal shows: study.csv has all of them."""


class StudyProgress:
    """Lines and bar of rank 0; counts increments.

    jobs : all jobs of the study;  terminal : whether something is shown
    """

    def __init__(self, jobs: Sequence[Job], terminal: bool) -> None:
        self._jobs, self._shown = jobs, terminal
        self._done = [0] * len(jobs)
        self._finished = 0
        self._width = max(len(job.title) for job in jobs)
        self._bar = progress_bar() if terminal and console.is_terminal else None
        if self._bar:
            self._task = self._bar.add_task("increments", total=sum(job.increments for job in jobs))
            self._bar.start()

    def receive(self, index: int, outcome: Outcome | None) -> None:
        """A job has computed an increment, or has ended."""
        job = self._jobs[index]
        if outcome is None:
            self._done[index] += 1
        else:
            self._done[index] = job.increments
            self._finished += 1
            if self._shown:
                self._print(job, outcome)
        if self._bar:
            self._bar.update(self._task, completed=sum(self._done))

    def _print(self, job: Job, outcome: Outcome) -> None:
        count = f"{self._finished:{len(str(len(self._jobs)))}d}/{len(self._jobs)}"
        words = [f"{count}  {job.title:{self._width}s}"]
        if outcome.status == "finished":
            words.append(f"{outcome.wall_s:8.1f} s")
            if outcome.newton_mean is not None:
                words.append(f"{outcome.newton_mean:5.1f} Newton iterations")
            words.append("finished before" if outcome.kept else "finished")
        else:
            words.append(f"failed: {outcome.reason}")
        print_line(words)

    def stop(self) -> None:
        """Take the bar away."""
        if self._bar:
            self._bar.stop()


def print_results(results: Sequence[JobResult], comparisons: Sequence[CaseComparison]) -> None:
    """Print the first quantities of all cases, then published beside computed values."""
    quantities = list(shown_quantities(results).items())[:COLUMNS]
    outcomes = [outcome for _, outcome in results]
    columns = {
        f"{name} {quantity.unit}".rstrip(): [_cell(one, one.values.get(name)) for one in outcomes]
        for name, quantity in quantities
    }
    columns["s"] = [_cell(one, one.wall_s) for one in outcomes]
    cases = Labels("case", [job.title for job, _ in results])
    for table in number_tables(cases, columns, console.width):
        console.print(table)
    if not comparisons:
        return
    both = Labels("case, quantity", [f"{each.case}, {each.quantity}" for each in comparisons])
    columns = {
        "published": [number(each.published) for each in comparisons],
        "computed": [number(each.computed) for each in comparisons],
        "%": [number(each.difference_percent) for each in comparisons],
        "error estimate": [number(each.error_estimate) for each in comparisons],
        "verdict": [each.verdict for each in comparisons],
    }
    for table in number_tables(both, columns, console.width, "published values"):
        console.print(table)


def _cell(outcome: Outcome, value: float | None) -> str:
    return number(value) if outcome.status == "finished" else "failed"
