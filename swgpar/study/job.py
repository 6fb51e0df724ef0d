"""One case on one mesh: run it, keep what went wrong in its folder, continue it after a restart."""

from __future__ import annotations

import gc
import json
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from mpi4py import MPI
from petsc4py import PETSc

from swgpar import log
from swgpar.errors import InputError, SwgparError
from swgpar.log import logger
from swgpar.report import make_figures
from swgpar.results import history
from swgpar.results.atomic import agreed, sentence, to_json, write_file, write_from_root
from swgpar.run import identity, run_drive
from swgpar.study.cases import Job

STATUS = "status.json"
"""In the folder of a job: status ("started", "failed", "finished"), identity of what is computed, reason."""


@dataclass(frozen=True)
class Outcome:
    """What became of a job.

    status : "finished" or "failed";  reason : one sentence, empty when finished
    means, rows : as in summary.json and history.csv; empty when failed
    kept : whether an earlier call of the study had finished it
    """

    status: str
    reason: str = ""
    elements: int | None = None
    means: dict[str, float] = field(default_factory=dict)
    newton_mean: float | None = None
    wall_s: float | None = None
    rows: list[dict[str, Any]] = field(default_factory=list)
    kept: bool = False


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
    """Run a case on one mesh; collective. Failures are returned, and recorded in the job's folder.

    Only an error that swgpar does not know is raised when several ranks share the case: one rank may have met it
    alone, and the others then wait for it.
    """
    record = {"identity": "", "rotation": 0.0}
    try:
        if job.case.design is None:
            raise InputError(job.case.refusal)
        record = {"identity": identity(job.case.design, job.recipe, None), "rotation": job.case.design.steps.rotation}
        old = comm.bcast(read_status(folder) if comm.rank == 0 else None)
        same = old.get("identity", record["identity"]) == record["identity"]
        if restart and old.get("status") == "finished":
            if not same:
                return Outcome("failed", f"{folder} holds results of another design: rename the case, or --overwrite")
            whole = comm.bcast((folder / "summary.json").exists() if comm.rank == 0 else None)
            if whole and old["rotation"] == record["rotation"]:
                return replace(_finished(folder, comm), kept=True)
        if comm.rank == 0:
            with suppress(OSError):  # whether the folder can be written is found out below, by all ranks
                folder.mkdir(parents=True, exist_ok=True)
        write_from_root(comm, folder / STATUS, to_json({"status": "started", **record}))
        run_drive(
            job.case.design,
            job.recipe,
            folder,
            restart=restart and same,
            overwrite=overwrite or not same,
            comm=comm,
            recipe_name=str(job.mesh),
            on_increment=on_increment,
        )
        outcome = _finished(folder, comm)
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


def _finished(folder: Path, comm: MPI.Comm) -> Outcome:
    """Outcome from the files of a finished run; collective."""
    outcome = None
    with agreed(comm, folder / "summary.json", "read"):
        if comm.rank == 0:
            summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
            outcome = Outcome(
                "finished",
                elements=summary["elements"],
                means=summary["means"],
                newton_mean=summary["newton_iterations_mean"],
                wall_s=summary["wall_s"],
                rows=history.read_history(folder / history.NAME),
            )
    return comm.bcast(outcome)


def _figures(job: Job, folder: Path, comm: MPI.Comm) -> None:
    if comm.rank == 0 and job.case.design.output.figures:
        try:
            make_figures(folder)
        except Exception as error:  # a picture that fails must not cost the case
            logger.warning("figures could not be drawn: %s", error)


def _release(comm: MPI.Comm) -> None:
    """Free the model of the last case; PETSc keeps what Python lets go of until this collective call."""
    gc.collect()
    PETSc.garbage_cleanup(comm)
