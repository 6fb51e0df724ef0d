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
from pathlib import Path

from swgpar.errors import InputError
from swgpar.rating.sheet import JSON as RATING_JSON
from swgpar.rating.sheet import PAGE as RATING_PAGE
from swgpar.results.atomic import to_json, write_file
from swgpar.results.folder import REPORT, SUMMARY

RECORD = "jobs.json"
"""File of the workspace with the jobs and their states."""


class JobState(StrEnum):
    """Where a job is."""

    WAITS = "waits"
    RUNS = "runs"
    FINISHED = "finished"
    FAILED = "failed"
    CANCELLED = "cancelled"


def _environment() -> dict[str, str]:
    """That of a shell: without what the MPI of this process has set for itself."""
    own = ("OMPI_MCA_ess_singleton_isolated", "OMPI_MCA_pml", "OMPI_MCA_sharedfp")
    return {
        name: value
        for name, value in os.environ.items()
        if name not in own and not name.startswith(("PMIX_", "PMI_", "OMPI_COMM_"))
    }


@dataclass
class AppJob:
    """One command.

    arguments : of `swgpar`;  ranks : of mpirun, 1 without it
    out : folder of its results, relative to the workspace
    process : of the leader of its group, 0 before it runs;  reason : last line of a failed one
    """

    number: int
    arguments: list[str]
    ranks: int
    out: str
    state: JobState = JobState.WAITS
    process: int = 0
    reason: str = ""

    @property
    def rates(self) -> bool:
        """Whether it is a rating."""
        return self.arguments[0] == "rate"

    @property
    def page(self) -> str:
        """Page of its results, relative to the workspace."""
        return f"{self.out}/{RATING_PAGE if self.rates else REPORT}"

    @property
    def last_file(self) -> str:
        """File that it writes last, relative to the workspace."""
        return f"{self.out}/{RATING_JSON if self.rates else SUMMARY}"

    @property
    def typed(self) -> str:
        """The command line, as it would be typed in the workspace."""
        ranks = f"mpirun -n {self.ranks} " if self.ranks > 1 else ""
        return f"{ranks}swgpar {shlex.join(self.arguments)}"


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
    def next_number(self) -> int:
        """Number of the next job."""
        return 1 + max((job.number for job in self.jobs), default=0)

    def add(self, arguments: Sequence[str], out: str, ranks: int = 1) -> AppJob:
        """A job at the end of the queue. Raises InputError where there is no mpirun for its
        ranks."""
        if ranks > 1 and shutil.which("mpirun") is None:
            raise InputError(f"ranks = {ranks}: mpirun is not found")
        job = AppJob(self.next_number, list(arguments), ranks, out)
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
                job.reason = "" if code == 0 else self._last_line(job)
                changed = True
        waiting = [job for job in self.jobs if job.state == JobState.WAITS]
        if waiting and not any(job.state == JobState.RUNS for job in self.jobs):
            self._start(waiting[0])
            changed = True
        if changed:
            self._write()
        return changed

    def last_lines(self, job: AppJob, count: int = 12) -> str:
        """The end of what a job has printed."""
        with contextlib.suppress(OSError):
            text = self._log(job).read_text(encoding="utf-8", errors="replace")
            return "\n".join(text.splitlines()[-count:])
        return ""

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
                env=_environment(),
                stdin=subprocess.DEVNULL,
                stdout=file,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        job.process, job.state = self._running.pid, JobState.RUNS

    def _ended(self, job: AppJob) -> int | None:
        """Exit code of a job that has ended; of one that an earlier server has started 0 where its
        results are complete."""
        if self._running is not None and self._running.pid == job.process:
            return self._running.poll()
        with contextlib.suppress(OSError):
            os.killpg(job.process, 0)
            return None
        return 0 if (self.folder / job.last_file).exists() else 1

    def _last_line(self, job: AppJob) -> str:
        lines = self.last_lines(job).splitlines()
        return lines[-1] if lines else "it has printed nothing"

    def _log(self, job: AppJob) -> Path:
        return self.folder / "logs" / f"{job.number}.log"

    def _write(self) -> None:
        record = {"written": time.time(), "jobs": [asdict(job) for job in self.jobs]}
        write_file(self.folder / RECORD, to_json(record))
