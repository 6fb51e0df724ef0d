"""One job of a study: run it, keep what went wrong in its folder, continue it after a restart."""

from __future__ import annotations

import gc
import json
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from mpi4py import MPI
from petsc4py import PETSc

from swgpar import log
from swgpar.errors import InputError, SwgparError
from swgpar.log import logger
from swgpar.results.atomic import agreed, sentence, to_json, write_file, write_from_root
from swgpar.results.figure_set import save_figures
from swgpar.studies.system import Job, Outcome
from swgpar.systems import system_of

STATUS = "status.json"
"""In the folder of a job: status ("started", "failed", "finished"), identity of what is computed, reason."""


def read_status(folder: Path) -> dict[str, Any]:
    """Content of the status file; empty when there is none that can be read."""
    with suppress(OSError, ValueError):
        status = json.loads((folder / STATUS).read_text(encoding="utf-8"))
        if isinstance(status, dict):
            return status
    return {}


def run_job(
    job: Job,
    folder: Path,
    comm: MPI.Comm,
    *,
    restart: bool,
    overwrite: bool = False,
    on_increment: Callable[[], None] = lambda: None,
) -> Outcome:
    """Run a job; collective. Failures are returned, and recorded in the job's folder.

    Only an error that swgpar does not know is raised when several ranks share the case: one rank may have met it
    alone, and the others then wait for it.
    """
    record: dict[str, Any] = {"identity": ""}
    try:
        if job.case.design is None:
            raise InputError(job.case.refusal)
        record = job.case.system.identity(job)
        old = comm.bcast(read_status(folder) if comm.rank == 0 else None)
        same = old.get("identity", record["identity"]) == record["identity"]
        if restart and old.get("status") == "finished":
            if not same:
                return Outcome("failed", f"{folder} holds results of another design: rename the case, or --overwrite")
            whole = comm.bcast((folder / "summary.json").exists() if comm.rank == 0 else None)
            if whole and all(old.get(key) == value for key, value in record.items()):
                return replace(_finished(job, folder, comm), kept=True)
        if comm.rank == 0:
            with suppress(OSError):  # whether the folder can be written is found out below, by all ranks
                folder.mkdir(parents=True, exist_ok=True)
        write_from_root(comm, folder / STATUS, to_json({"status": "started", **record}))
        job.case.system.run(
            job, folder, comm, restart=restart and same, overwrite=overwrite or not same, on_increment=on_increment
        )
        outcome = _finished(job, folder, comm)
        _figures(job, folder, comm)
    except SwgparError as error:
        logger.error("%s", error)
        outcome = Outcome("failed", str(error))
    except Exception as error:
        logger.exception("unexpected error")
        outcome = Outcome("failed", f"{type(error).__name__}: {sentence(error)}")
        if comm.size > 1:
            with suppress(OSError):
                write_file(folder / STATUS, to_json({"status": "failed", **record, "reason": outcome.reason}))
            raise
    log.close_file()
    _release(comm)
    with suppress(SwgparError):  # the table has it
        _record(folder, comm, {"status": outcome.status, **record, "reason": outcome.reason})
    return outcome


def _record(folder: Path, comm: MPI.Comm, status: dict[str, Any]) -> None:
    if comm.rank == 0:
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
    earlier = comm.bcast(read_status(folder) if comm.rank == 0 else None)
    if status["status"] == "finished" or earlier.get("status") != "finished":
        write_from_root(comm, folder / STATUS, to_json(status))


def _finished(job: Job, folder: Path, comm: MPI.Comm) -> Outcome:
    """Outcome from the files of a finished run; collective."""
    outcome = None
    with agreed(comm, folder / "summary.json", "read"):
        if comm.rank == 0:
            outcome = job.case.system.read(job, folder)
    return comm.bcast(outcome)


def _figures(job: Job, folder: Path, comm: MPI.Comm) -> None:
    if job.case.design.output.figures:
        save_figures(system_of(job.case.design).open(folder).plot, folder, comm)


def _release(comm: MPI.Comm) -> None:
    """Free the model of the last case; PETSc keeps what Python lets go of until this collective call."""
    gc.collect()
    PETSc.garbage_cleanup(comm)
