"""A whole study: all its cases, then its tables and its report."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from mpi4py import MPI

from swgpar import log, watch
from swgpar.errors import InputError, OutputError
from swgpar.results.atomic import agreed, first_reason, write_from_root
from swgpar.results.folder import given_folder, remove_results
from swgpar.results.lock import acquire, releasing
from swgpar.results.table import format_csv
from swgpar.run_options import RunOptions
from swgpar.studies.case import Job, Outcome
from swgpar.studies.cases import expand
from swgpar.studies.job import STATUS, read_status, run_planned
from swgpar.studies.report import make_report
from swgpar.studies.spec import Study, load_study, make_study
from swgpar.studies.table import Comparison, Result, compare, complete, published_rows, study_rows
from swgpar.studies.terminal import StudyProgress
from swgpar.tasks import share_tasks

Report = Callable[[tuple[int, Outcome | None]], None]
"""Takes a job's number with its outcome, or None after an increment."""

Run = Callable[[int, MPI.Comm, Report], None]
"""Runs the job of a number."""

TABLE, PUBLISHED, REPORT = "study.csv", "published.csv", "study.html"


@dataclass(frozen=True)
class StudyResult:
    """What a study gives; the same on every rank.

    Attributes
    ----------
    results : list of (Job, Outcome)
        In the order of the study; the outcome of a case that failed says why.
    folder : Path or None
        The folder of the study; None when it was in memory.

    Examples
    --------
    >>> found = swgpar.study("drivers/studies/torque.toml")
    >>> pandas.DataFrame(found.table)[["load.torque", "mean.fs_s1"]]
    """

    results: list[Result]
    folder: Path | None = None

    @property
    def rows(self) -> list[dict[str, Any]]:
        """Rows of study.csv: case, mesh, varied keys, status, quantities, wall seconds, reason of a
        failure."""
        return study_rows(self.results)

    @property
    def table(self) -> dict[str, list[Any]]:
        """The same by columns; None where a case has no value."""
        rows = self.rows
        return {name: [row[name] for row in rows] for name in rows[0]}

    @property
    def comparisons(self) -> list[Comparison]:
        """Published values beside the computed ones."""
        return compare(self.results)

    @property
    def published(self) -> list[dict[str, Any]]:
        """Rows of published.csv: published values beside the computed ones."""
        return published_rows(self.comparisons)

    @property
    def failed(self) -> dict[str, str]:
        """Reason of every case that failed, by its name and mesh."""
        return {
            job.title: outcome.reason for job, outcome in self.results if outcome.status == "failed"
        }

    @property
    def report(self) -> Path | None:
        """The file study.html; None when the study was in memory."""
        return None if self.folder is None else self.folder / REPORT


SHARE = 0.05
"""Largest share of the time that is spent on tables and report while cases are computed."""


class _Book:
    """What rank 0 knows: outcomes by job. Tables and report on the disk follow them, for a study
    that is stopped."""

    def __init__(self, study: Study, jobs: Sequence[Job], out: Path | None, terminal: bool) -> None:
        self.study, self.jobs, self.out = study, jobs, out
        self.next_writing = 0.0
        self.outcomes: dict[int, Outcome] = {}
        self.progress = StudyProgress(jobs) if terminal else None
        watch.saved("cases", 0, len(jobs))

    def receive(self, message: tuple[int, Outcome | None]) -> None:
        """Job number with its outcome, or None after an increment."""
        number, outcome = message
        if outcome is None:
            if self.progress is not None:
                self.progress.increment(number)
            return
        self.outcomes[number] = outcome
        watch.saved("cases", len(self.outcomes), len(self.jobs))
        watch.doing(f"{len(self.outcomes)} of {len(self.jobs)} cases have ended")
        if self.progress is not None:
            self.progress.outcome(number, outcome)
        begin = time.perf_counter()
        if (
            self.out is not None
            and begin >= self.next_writing
            and len(self.outcomes) < len(self.jobs)
        ):
            with suppress(OutputError):  # the others are at work: said at the end, when all write
                _write(
                    self.study,
                    self.results(),
                    self.out,
                    MPI.COMM_SELF,
                    len(self.jobs) - len(self.outcomes),
                )
            end = time.perf_counter()
            self.next_writing = end + (end - begin) / SHARE

    def results(self) -> list[Result]:
        """Jobs that have ended, in the order of the study."""
        return [(self.jobs[number], self.outcomes[number]) for number in sorted(self.outcomes)]


@releasing
def run_study(
    source: str | Path | Mapping[str, Any],
    out: str | Path | None = None,
    *,
    restart: bool = False,
    overwrite: bool = False,
    terminal: bool = False,
    comm: MPI.Comm = MPI.COMM_WORLD,
) -> StudyResult:
    """Run all cases of a study; collective.

    Parameters
    ----------
    source : a study file (TOML), or its content
    out : folder of the study, with tables, report and the results of every case; None keeps
    everything in memory
    restart : keep what is finished in the folder, continue what was interrupted, try again what
    failed
    overwrite : replace a study that the folder already holds
    terminal : whether rank 0 reports on the terminal

    Raises
    ------
    InputError
        A study file that cannot be used.
    OutputError
        A folder that cannot be written. A case that fails is an outcome.
    """
    folder = None if out is None else given_folder(out)
    study, jobs = _read(source, comm)
    statuses: list[str | None] | None = [None] * len(jobs)
    if folder is not None:
        _prepare(folder, comm, restart, overwrite)
        if comm.rank == 0:
            statuses = [read_status(job.folder(folder)).get("status") for job in jobs]
    elif restart:
        raise InputError(
            "restart = true needs the folder of the study: a study in memory leaves nothing to "
            "continue"
        )
    order = queue(jobs, comm.bcast(statuses))
    run = partial(_run_one, jobs, folder, restart, overwrite)
    with log.session(
        MPI.COMM_SELF if study.section.parallel == "cases" else comm, terminal=False, shown=False
    ):
        results = _run_all(study, jobs, order, run, folder, terminal, comm)
    if folder is not None:
        _write(study, results, folder, comm)
    return StudyResult(results, None if folder is None else folder.absolute())


def _run_all(
    study: Study,
    jobs: list[Job],
    order: list[int],
    run: Run,
    out: Path | None,
    terminal: bool,
    comm: MPI.Comm,
) -> list[Result]:
    """All jobs and their outcomes, on every rank."""
    book = _Book(study, jobs, out, terminal) if comm.rank == 0 else None
    receive: Report = book.receive if book is not None else lambda _: None
    try:
        if study.section.parallel == "cases":
            share_tasks(
                comm,
                len(order),
                lambda index, send: run(order[index], MPI.COMM_SELF, send),
                receive,
            )
        else:
            for number in order:
                run(number, comm, receive)
    finally:
        if book is not None and book.progress is not None:
            book.progress.stop()
    return comm.bcast(book.results() if book is not None else None)


def _read(source: str | Path | Mapping[str, Any], comm: MPI.Comm) -> tuple[Study, list[Job]]:
    """Rank 0 reads, so that all have the same study whatever happens to the file."""
    content: Any = None
    reason = None
    if comm.rank == 0:
        try:
            study = make_study(source) if isinstance(source, Mapping) else load_study(source)
            content = (study, expand(study))
        except InputError as error:
            reason = str(error)
    reason = first_reason(comm, reason)
    if reason is not None:
        raise InputError(reason)
    return comm.bcast(content)


def _prepare(out: Path, comm: MPI.Comm, restart: bool, overwrite: bool) -> None:
    with agreed(comm, out):
        if comm.rank == 0:
            out.mkdir(parents=True, exist_ok=True)
            acquire(out)
    present = comm.bcast((out / "cases").exists() if comm.rank == 0 else None)
    if present and not restart and not overwrite:
        raise OutputError(
            f"{out} already holds a study: continue it with restart = true (--restart), replace it "
            f"with "
            "overwrite = true (--overwrite), or choose another folder"
        )
    with agreed(comm, out):
        if comm.rank == 0:
            (out / "cases").mkdir(parents=True, exist_ok=True)
            if overwrite and not restart:
                for status in [*out.glob(f"cases/**/{STATUS}")]:
                    remove_results(status.parent)
                    status.unlink()
                for name in (TABLE, PUBLISHED, REPORT):
                    (out / name).unlink(missing_ok=True)


def queue(jobs: Sequence[Job], statuses: Sequence[str | None]) -> list[int]:
    """Numbers of the jobs in the order in which they are begun: long ones first, those that failed
    before last."""
    return sorted(
        range(len(jobs)),
        key=lambda k: (statuses[k] == "failed", jobs[k].finer, -jobs[k].increments),
    )


def _run_one(
    jobs: Sequence[Job],
    out: Path | None,
    restart: bool,
    overwrite: bool,
    number: int,
    comm: MPI.Comm,
    report: Report,
) -> None:
    """Run a job and report its increments, as None, and its outcome."""
    job = jobs[number]
    options = RunOptions(
        None if out is None else job.folder(out),
        restart=restart,
        overwrite=overwrite,
        comm=comm,
        on_increment=lambda: report((number, None)),
    )
    report((number, run_planned(job.planned, options)))


def _write(
    study: Study, results: Sequence[Result], out: Path, comm: MPI.Comm, missing: int = 0
) -> None:
    """Write tables and report; collective. missing : number of jobs that have not ended"""
    comparisons = compare(complete(results))
    write_from_root(comm, out / TABLE, format_csv(study_rows(results)))
    if comparisons:
        write_from_root(comm, out / PUBLISHED, format_csv(published_rows(comparisons)))
    page = make_report(study, results, comparisons, out, missing) if comm.rank == 0 else b""
    write_from_root(comm, out / REPORT, page)
