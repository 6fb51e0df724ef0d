"""Commands that run in the background, one after the other: those that a user would type."""

from __future__ import annotations

import contextlib
import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum
from itertools import takewhile
from pathlib import Path

from swgpar.errors import InputError
from swgpar.optimisation import files as search
from swgpar.rating import sheet
from swgpar.results import folder as results
from swgpar.results.atomic import to_json, write_file
from swgpar.studies import study

RECORD = "jobs.json"
"""File of the workspace with the jobs and their states."""


PAGES = {
    "run": results.REPORT,
    "rate": sheet.PAGE,
    "study": study.REPORT,
    "optimise": search.REPORT,
}
LAST_FILES = {
    "run": results.SUMMARY,
    "rate": sheet.JSON,
    "study": study.TABLE,
    "optimise": search.REPORT,
}
"""Pages of results, and files that are written last, by command."""

RESTART = "--restart"

LINES, TAIL = 3, 4096
"""Lines of what a job prints that are shown while it runs, and bytes that hold them."""


class JobState(StrEnum):
    """Where a job is."""

    WAITS = "waits"
    RUNS = "runs"
    FINISHED = "finished"
    FAILED = "failed"
    CANCELLED = "cancelled"


OF_MPI = (
    *("OMPI_COMM_", "OMPI_MCA_ess", "OMPI_MCA_orte", "OMPI_MCA_pml", "OMPI_MCA_sharedfp"),
    *("PMIX_", "PMI_", "HYDI_", "MPI_LOCAL"),
)
"""What the names begin with that a process sets for itself when it initialises MPI. It passes them
on, and an mpirun that has them takes itself for a rank of its job and ends without a word."""


def shell_environment() -> dict[str, str]:
    """The environment of a shell, for commands outside of the MPI job of this process."""
    return {name: value for name, value in os.environ.items() if not name.startswith(OF_MPI)}


def command_line(arguments: Sequence[str], ranks: int) -> str:
    """A command of `swgpar` on some ranks, as it is typed."""
    start = f"mpirun -n {ranks} " if ranks > 1 else ""
    return f"{start}swgpar {shlex.join(arguments)}"


@dataclass
class AppJob:
    """One command.

    arguments : of `swgpar`;  ranks : of mpirun, 1 without it
    out : folder of its results, relative to the workspace
    process : of the leader of its group, 0 before it runs;  reason : last line of a failed one
    variant : whose design it takes, empty of a file of the user
    begun : when it began to run, s since 1970
    """

    number: int
    arguments: list[str]
    ranks: int
    out: str
    state: JobState = JobState.WAITS
    process: int = 0
    reason: str = ""
    variant: str = ""
    begun: float = 0.0

    @property
    def command(self) -> str:
        """Command of `swgpar`."""
        return self.arguments[0]

    @property
    def page(self) -> str | None:
        """Page of its results, relative to the workspace; None where it makes none."""
        name = PAGES.get(self.command)
        return None if name is None else f"{self.out}/{name}"

    @property
    def last_file(self) -> str | None:
        """File that it writes last, relative to the workspace; None where it has several."""
        name = LAST_FILES.get(self.command)
        return None if name is None else f"{self.out}/{name}"

    @property
    def continued(self) -> list[str]:
        """Arguments that continue it; none where it begins anew."""
        if self.command not in LAST_FILES:
            return []
        return [*(one for one in self.arguments if one != RESTART), RESTART]

    @property
    def typed(self) -> str:
        """The command line, as it would be typed in the workspace."""
        return command_line(self.arguments, self.ranks)


class JobQueue:
    """Jobs of a workspace; `step` starts and ends them, and has to be called now and then.

    A job goes on when the server ends. The next server waits for its end.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.jobs: list[AppJob] = []
        self._running: subprocess.Popen[bytes] | None = None
        with contextlib.suppress(OSError, ValueError, TypeError):
            for entry in json.loads((folder / RECORD).read_text(encoding="utf-8"))["jobs"]:
                self.jobs.append(AppJob(**{**entry, "state": JobState(entry["state"])}))

    @property
    def runs(self) -> bool:
        """Whether a job runs."""
        return any(job.state == JobState.RUNS for job in self.jobs)

    def is_last(self, job: AppJob) -> bool:
        """Whether no later job has gone on with its results."""
        return all(one.out != job.out for one in self.jobs if one.number > job.number)

    @property
    def next_number(self) -> int:
        """Number of the next job."""
        return 1 + max((job.number for job in self.jobs), default=0)

    def add(self, arguments: Sequence[str], out: str, ranks: int = 1, variant: str = "") -> AppJob:
        """A job at the end of the queue. Raises InputError where there is no mpirun for its
        ranks."""
        if ranks > 1 and shutil.which("mpirun") is None:
            raise InputError(f"ranks = {ranks}: mpirun is not found")
        job = AppJob(self.next_number, list(arguments), ranks, out, variant=variant)
        self.jobs.append(job)
        self.step()
        return job

    def cancel(self, job: AppJob) -> None:
        """End a job; what it has written can be continued with --restart."""
        if job.state == JobState.RUNS:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(job.process, signal.SIGTERM)
        if job.state in (JobState.WAITS, JobState.RUNS):
            job.state = JobState.CANCELLED
        self._write()

    def step(self) -> bool:
        """Look after the jobs; whether one has changed its state."""
        changed = False
        for job in self.jobs:
            if job.state == JobState.RUNS and (code := self._ended(job)) is not None:
                job.state = JobState.FINISHED if code == 0 else JobState.FAILED
                job.reason = "" if code == 0 else self._reason(job)
                changed = True
        waiting = [job for job in self.jobs if job.state == JobState.WAITS]
        if waiting and not self.runs:
            self._start(waiting[0])
            changed = True
        if changed:
            self._write()
        return changed

    def progress(self, job: AppJob) -> str:
        """How long a job runs, the end of what it has printed, and where its last run is."""
        lines = _last_lines(self._log(job), LINES)
        runs = sorted((self.folder / job.out).glob(f"*/**/{results.LOG}"), key=_changed)
        for logged in _last_lines(runs[-1], 1) if runs else []:
            # a line of run.log begins with its time and its level
            lines.append(f"{runs[-1].parent.name}: {logged.split('  ', 2)[-1].strip()}")
        minutes = int((time.time() - job.begun) / 60.0) if job.begun else 0
        return "\n".join([*([f"for {minutes} min"] if minutes else []), *lines])

    def _start(self, job: AppJob) -> None:
        command = [sys.executable, "-m", "swgpar.cli", *job.arguments]
        if job.ranks > 1:
            command = ["mpirun", "-n", str(job.ranks), *command]
        log = self._log(job)
        log.parent.mkdir(parents=True, exist_ok=True)
        with log.open("wb") as file:
            self._running = subprocess.Popen(
                command,
                cwd=self.folder,
                env=shell_environment(),
                stdin=subprocess.DEVNULL,
                stdout=file,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        job.process, job.state, job.begun = self._running.pid, JobState.RUNS, time.time()

    def _ended(self, job: AppJob) -> int | None:
        """Exit code of a job that has ended; of one that an earlier server has started 0 where its
        results are complete."""
        if self._running is not None and self._running.pid == job.process:
            return self._running.poll()
        with contextlib.suppress(OSError):
            os.killpg(job.process, 0)
            return None
        return 0 if job.last_file and (self.folder / job.last_file).exists() else 1

    def _reason(self, job: AppJob) -> str:
        """Sentence of a job that has failed, or the last line of its own before those of mpirun."""
        lines = _last_lines(self._log(job), TAIL)
        sentences = [line for line in lines if line.startswith("swgpar: ")]
        own = [*takewhile(lambda line: not line.startswith("-----"), lines)]
        return (sentences or own or ["it has printed nothing"])[-1]

    def _log(self, job: AppJob) -> Path:
        return self.folder / "logs" / f"{job.number}.log"

    def _write(self) -> None:
        record = {"written": time.time(), "jobs": [asdict(job) for job in self.jobs]}
        write_file(self.folder / RECORD, to_json(record))


def _last_lines(path: Path, count: int) -> list[str]:
    """The last lines of a file, of which its end is read; none where it cannot be."""
    try:
        with path.open("rb") as file:
            file.seek(max(file.seek(0, os.SEEK_END) - TAIL, 0))
            return file.read().decode(errors="replace").splitlines()[-count:]
    except OSError:
        return []


def _changed(path: Path) -> float:
    """When a file has last changed, 0 where it is gone."""
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0
