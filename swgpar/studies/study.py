"""A whole study: all its cases, then its tables and its report."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from mpi4py import MPI

from swgpar import watch
from swgpar.errors import InputError, OutputError
from swgpar.input.toml_file import require_source
from swgpar.results.atomic import on_root, write_from_root
from swgpar.results.lock import releasing
from swgpar.results.table import format_csv
from swgpar.run_options import RunOptions
from swgpar.studies.case import Job, Outcome
from swgpar.studies.cases import expand
from swgpar.studies.job import read_status, run_one
from swgpar.studies.many_runs import claim_folder, do_runs, note_ended
from swgpar.studies.report import make_report
from swgpar.studies.spec import Study, load_study, make_study
from swgpar.studies.table import (
    CaseComparison,
    JobResult,
    compare_cases,
    complete,
    published_rows,
    study_rows,
)
from swgpar.studies.terminal import StudyProgress
from swgpar.tasks import Send

TABLE, PUBLISHED, REPORT, CASES = "study.csv", "published.csv", "study.html", "cases"


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

    results: list[JobResult]
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
    def comparisons(self) -> list[CaseComparison]:
        """Published values beside the computed ones."""
        return compare_cases(self.results)

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
        self.progress = StudyProgress(jobs, terminal)
        watch.saved("cases", 0, len(jobs))

    def receive(self, message: tuple[int, Outcome | None]) -> None:
        """Job number with its outcome, or None after an increment."""
        number, outcome = message
        if outcome is not None:
            self.outcomes[number] = outcome
            note_ended("cases", len(self.outcomes), len(self.jobs))
        self.progress.receive(number, outcome)
        begin, missing = time.perf_counter(), len(self.jobs) - len(self.outcomes)
        if outcome is None or self.out is None or begin < self.next_writing or not missing:
            return
        with suppress(OutputError):  # the others are at work: said at the end, when all write
            _write(self.study, self.results(), self.out, MPI.COMM_SELF, missing)
        end = time.perf_counter()
        self.next_writing = end + (end - begin) / SHARE

    def results(self) -> list[JobResult]:
        """Jobs that have ended, in the order of the study."""
        return [(self.jobs[number], self.outcomes[number]) for number in sorted(self.outcomes)]


@releasing
def study(
    study: str | Path | Mapping[str, Any],
    out: str | Path | None = None,
    *,
    restart: bool = False,
    overwrite: bool = False,
    progress: bool | None = None,
    comm: MPI.Comm = MPI.COMM_WORLD,
) -> StudyResult:
    """Compute many designs and compare them; collective.

    Parameters
    ----------
    study : path or mapping
        A study file (TOML), or its content ``{"study": {...}}`` with paths relative to the working
        directory.
    out : path
        Folder of the study: study.csv, published.csv, study.html, and the results of every case.
        Without it the study is in memory and leaves no files.
    restart : bool
        Keep what is finished in `out`, continue what was interrupted, try again what failed.
    overwrite : bool
        Replace a study that `out` already holds.
    progress : bool
        Report every case on the terminal. Default: only on a terminal.
    comm : communicator
        Each rank works on cases of its own.

    Returns
    -------
    StudyResult
        A case that fails does not stop the others: see ``failed``.

    Raises
    ------
    InputError
        A study file that cannot be used.
    OutputError
        The folder cannot be written, or holds another study.

    Examples
    --------
    >>> found = swgpar.study({"study": {
    ...     "design": "drivers/plane_half_turn.toml", "meshes": ["plane_coarse"],
    ...     "vary": {"load.torque": [5.0, 10.0, 20.0]}}})
    >>> found.table["mean.fs_s1"]
    """
    require_source("study", study)
    given = RunOptions.given(
        out, progress, plain=True, restart=restart, overwrite=overwrite, comm=comm
    )
    folder = given.out
    file, jobs = on_root(comm, lambda: _read(study))  # whatever happens to the file meanwhile
    if folder is not None:
        claim_folder(folder, given, "a study", [CASES], (TABLE, PUBLISHED, REPORT), CASES)
    elif restart:
        raise InputError(
            "restart = true needs the folder of the study: a study in memory leaves nothing to "
            "continue"
        )
    order = on_root(comm, lambda: queue(jobs, [_status(job, folder) for job in jobs]))

    def run(index: int, own: MPI.Comm, send: Send) -> None:
        job = jobs[order[index]]
        options = replace(
            given,
            out=folder and job.folder(folder),
            recipe=job.recipe,
            recipe_name=str(job.mesh or ""),
            comm=own,
            terminal=False,
            on_increment=lambda: send((order[index], None)),
        )
        outcome = run_one(job.case.system, job.case.design, options, job.case.refusal)
        send((order[index], outcome))

    book = _Book(file, jobs, folder, given.terminal) if comm.rank == 0 else None
    try:
        do_runs(comm, file.section.parallel, len(jobs), run, book.receive if book else None)
    finally:
        if book:
            book.progress.stop()
    results = comm.bcast(book.results() if book else None)
    if folder is not None:
        _write(file, results, folder, comm)
    return StudyResult(results, None if folder is None else folder.absolute())


def _read(source: str | Path | Mapping[str, Any]) -> tuple[Study, list[Job]]:
    study = make_study(source) if isinstance(source, Mapping) else load_study(source)
    return study, expand(study)


def _status(job: Job, folder: Path | None) -> str | None:
    """Status of an earlier call; None in memory, and without one."""
    return None if folder is None else read_status(job.folder(folder)).get("status")


def queue(jobs: Sequence[Job], statuses: Sequence[str | None]) -> list[int]:
    """Numbers of the jobs in the order in which they are begun: long ones first, those that failed
    before last."""
    return sorted(
        range(len(jobs)),
        key=lambda k: (statuses[k] == "failed", jobs[k].finer, -jobs[k].increments),
    )


def _write(
    study: Study, results: Sequence[JobResult], out: Path, comm: MPI.Comm, missing: int = 0
) -> None:
    """Write tables and report; collective. missing : number of jobs that have not ended"""
    comparisons = compare_cases(complete(results))
    write_from_root(comm, out / TABLE, format_csv(study_rows(results)))
    if comparisons:
        write_from_root(comm, out / PUBLISHED, format_csv(published_rows(comparisons)))
    page = make_report(study, results, comparisons, out, missing) if comm.rank == 0 else b""
    write_from_root(comm, out / REPORT, page)
