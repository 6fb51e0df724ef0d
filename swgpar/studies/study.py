"""A whole study: all its cases, then its tables and its report."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

from mpi4py import MPI

from swgpar import log
from swgpar.errors import InputError, OutputError
from swgpar.results.atomic import agreed, first_reason, write_from_root
from swgpar.results.folder import prepare
from swgpar.results.table import format_csv
from swgpar.studies.cases import expand
from swgpar.studies.job import STATUS, read_status, run_job
from swgpar.studies.report import make_report
from swgpar.studies.schedule import Counter, Reports
from swgpar.studies.spec import Study, load_study
from swgpar.studies.system import Job, Outcome
from swgpar.studies.table import Result, compare, published_rows, study_rows
from swgpar.studies.terminal import StudyProgress

Report = Callable[[tuple[int, Outcome | None]], None]
"""Takes a job's number with its outcome, or None after an increment."""

Run = Callable[[int, MPI.Comm, Report], None]
"""Runs the job of a number."""

TABLE, PUBLISHED, REPORT = "study.csv", "published.csv", "study.html"


class _Book:
    """What rank 0 knows: outcomes by job. The table on the disk follows every one of them."""

    def __init__(self, jobs: Sequence[Job], out: Path) -> None:
        self.jobs, self.out = jobs, out
        self.outcomes: dict[int, Outcome] = {}
        self.progress = StudyProgress(jobs)

    def receive(self, message: tuple[int, Outcome | None]) -> None:
        """Job number with its outcome, or None after an increment."""
        number, outcome = message
        if outcome is None:
            self.progress.increment(number)
            return
        self.outcomes[number] = outcome
        self.progress.outcome(number, outcome)
        with suppress(OutputError):  # the others are at work: said at the end, when all write
            write_from_root(MPI.COMM_SELF, self.out / TABLE, format_csv(study_rows(self.results())))

    def results(self) -> list[Result]:
        """Jobs that have ended, in the order of the study."""
        return [(self.jobs[number], self.outcomes[number]) for number in sorted(self.outcomes)]


def run_study(
    path: str | Path,
    out: str | Path,
    *,
    restart: bool = False,
    overwrite: bool = False,
    comm: MPI.Comm = MPI.COMM_WORLD,
) -> list[Result]:
    """Run all cases of a study file and write tables and report below `out`; collective.

    Returns the jobs and their outcomes, in the order of the study, on every rank. Raises InputError for a study file
    that cannot be used and OutputError for a folder that cannot be written; a case that fails is an outcome.
    """
    out = Path(out)
    study, jobs = _read(Path(path), comm)
    log.start(MPI.COMM_SELF if study.section.parallel == "cases" else comm, terminal=False)
    _prepare(out, comm, restart, overwrite)
    statuses = [read_status(job.folder(out)).get("status") for job in jobs] if comm.rank == 0 else None
    order = queue(jobs, comm.bcast(statuses))
    book = _Book(jobs, out) if comm.rank == 0 else None
    receive: Report = book.receive if book is not None else lambda _: None
    run: Run = partial(_run_one, jobs, out, restart, overwrite)
    try:
        if study.section.parallel == "cases":
            _cases_at_once(order, comm, receive, run)
        else:
            for number in order:
                run(number, comm, receive)
    finally:
        if book is not None:
            book.progress.stop()
    results = comm.bcast(book.results() if book is not None else None)
    _write(study, results, out, comm)
    return results


def _read(path: Path, comm: MPI.Comm) -> tuple[Study, list[Job]]:
    """Rank 0 reads, so that all have the same study whatever happens to the file."""
    content: Any = None
    reason = None
    if comm.rank == 0:
        try:
            study = load_study(path)
            content = (study, expand(study))
        except InputError as error:
            reason = str(error)
    reason = first_reason(comm, reason)
    if reason is not None:
        raise InputError(reason)
    return comm.bcast(content)


def _prepare(out: Path, comm: MPI.Comm, restart: bool, overwrite: bool) -> None:
    there = comm.bcast((out / "cases").exists() if comm.rank == 0 else None)
    if there and not restart and not overwrite:
        raise OutputError(
            f"{out} already holds a study: continue it with --restart, replace it with --overwrite, "
            "or choose another --out"
        )
    with agreed(comm, out):
        if comm.rank == 0:
            (out / "cases").mkdir(parents=True, exist_ok=True)
            if overwrite and not restart:
                for status in [*out.glob(f"cases/**/{STATUS}")]:
                    prepare(status.parent, MPI.COMM_SELF, restart=False, overwrite=True)
                    status.unlink()
                for name in (TABLE, PUBLISHED, REPORT):
                    (out / name).unlink(missing_ok=True)


def queue(jobs: Sequence[Job], statuses: Sequence[str | None]) -> list[int]:
    """Numbers of the jobs in the order in which they are begun: long ones first, those that failed before last."""
    return sorted(range(len(jobs)), key=lambda k: (statuses[k] == "failed", jobs[k].finer, -jobs[k].increments))


def _run_one(
    jobs: Sequence[Job], out: Path, restart: bool, overwrite: bool, number: int, comm: MPI.Comm, report: Report
) -> None:
    """Run a job and report its increments, as None, and its outcome."""
    job = jobs[number]
    outcome = run_job(
        job, job.folder(out), comm, restart=restart, overwrite=overwrite, on_increment=lambda: report((number, None))
    )
    report((number, outcome))


def _cases_at_once(order: Sequence[int], comm: MPI.Comm, receive: Report, run: Run) -> None:
    own = comm.Dup()
    counter, reports = Counter(own), Reports(own, receive)
    while (place := counter.take()) < len(order):
        run(order[place], MPI.COMM_SELF, reports.send)
    reports.end()
    counter.free()
    own.Free()


def _write(study: Study, results: Sequence[Result], out: Path, comm: MPI.Comm) -> None:
    comparisons = compare(results)
    write_from_root(comm, out / TABLE, format_csv(study_rows(results)))
    if comparisons:
        write_from_root(comm, out / PUBLISHED, format_csv(published_rows(comparisons)))
    page = make_report(study, results, comparisons, out) if comm.rank == 0 else b""
    write_from_root(comm, out / REPORT, page)
