"""One of many runs: run it, keep what went wrong in its folder, continue it after a restart."""

from __future__ import annotations

import gc
import json
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from mpi4py import MPI

from swgpar import log
from swgpar.errors import InputError, SwgparError, printable
from swgpar.log import logger
from swgpar.petsc import PETSc
from swgpar.results.atomic import agreed, sentence, to_json, write_file, write_from_root
from swgpar.results.figure_set import save_figures
from swgpar.run_options import RunOptions
from swgpar.studies.case import Outcome, PlannedRun
from swgpar.systems import System

STATUS = "status.json"
"""In the folder of a run: status ("started", "failed", "finished"), identity of what is computed,
reason."""


def read_status(folder: Path) -> dict[str, Any]:
    """Content of the status file; empty when there is none that can be read."""
    with suppress(OSError, ValueError):
        status = json.loads((folder / STATUS).read_text(encoding="utf-8"))
        if isinstance(status, dict):
            return status
    return {}


def run_planned(planned: PlannedRun, options: RunOptions) -> Outcome:
    """Run a design without shortcuts; collective. Failures are returned, and recorded in the folder
    of the options.

    Only an error that swgpar does not know is raised when several ranks share the run: one rank may
    have met it alone, and the others then wait for it.
    """
    record: dict[str, Any] = {"identity": ""}
    folder, comm = options.out, options.comm
    options = replace(options, recipe=planned.recipe, recipe_name=planned.recipe_name, plain=True)
    try:
        if planned.design is None:
            raise InputError(planned.refusal)
        record = planned.system.identity(planned.design, planned.recipe)
        if folder is not None:
            outcome, same = _earlier(planned.system, folder, comm, record, options.restart)
            if outcome is not None:
                return outcome
            options = replace(
                options, restart=options.restart and same, overwrite=options.overwrite or not same
            )
        outcome = _compute(planned, options)
    except SwgparError as error:
        if getattr(error, "alone", False) and comm.size > 1:
            raise
        logger.error("%s", error)
        outcome = Outcome("failed", str(error))
    except Exception as error:
        logger.exception("unexpected error")
        outcome = Outcome("failed", printable(f"{type(error).__name__}: {sentence(error)}"))
        if comm.size > 1:
            if folder is not None:
                with suppress(OSError):
                    write_file(
                        folder / STATUS,
                        to_json({"status": "failed", **record, "reason": outcome.reason}),
                    )
            raise
    log.close_file()
    _release(comm)
    if folder is not None:
        with suppress(SwgparError):  # the table has it
            _record(folder, comm, {"status": outcome.status, **record, "reason": outcome.reason})
    return outcome


def _earlier(
    system: System[Any, Any], folder: Path, comm: MPI.Comm, record: dict[str, Any], restart: bool
) -> tuple[Outcome | None, bool]:
    """Outcome of a run that an earlier call finished, else None; and whether the folder holds this
    design's results.

    Marks the run as started unless there is an outcome; collective.
    """
    old = comm.bcast(read_status(folder) if comm.rank == 0 else None)
    same = old.get("identity", record["identity"]) == record["identity"]
    if restart and old.get("status") == "finished":
        if not same:
            reason = (
                f"{folder} holds results of another design: rename the case, or overwrite = true "
                f"(--overwrite)"
            )
            return Outcome("failed", reason), same
        complete = comm.bcast((folder / "summary.json").exists() if comm.rank == 0 else None)
        if complete and all(old.get(key) == value for key, value in record.items()):
            return _kept(system, folder, comm), same
    if comm.rank == 0:
        with suppress(
            OSError
        ):  # whether the folder can be written is found out below, by all ranks
            folder.mkdir(parents=True, exist_ok=True)
    write_from_root(comm, folder / STATUS, to_json({"status": "started", **record}))
    return None, same


def _compute(planned: PlannedRun, options: RunOptions) -> Outcome:
    system = planned.system
    if (
        "restart" not in system.options
    ):  # an interrupted run begins anew, and may have left its first tables
        options = replace(options, restart=False, overwrite=options.overwrite or options.restart)
    result = system.run(planned.design, options)
    if options.out is not None and system.draws_figures(planned.design):
        save_figures(result.plot, options.out)
    return Outcome.finished(system.measure(result))


def _record(folder: Path, comm: MPI.Comm, status: dict[str, Any]) -> None:
    if comm.rank == 0:
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
    earlier = comm.bcast(read_status(folder) if comm.rank == 0 else None)
    if status["status"] == "finished" or earlier.get("status") != "finished":
        write_from_root(comm, folder / STATUS, to_json(status))


def _kept(system: System[Any, Any], folder: Path, comm: MPI.Comm) -> Outcome:
    """Outcome from the files of a finished run; collective."""
    outcome = None
    with agreed(comm, folder / "summary.json", "read"):
        if comm.rank == 0:
            outcome = Outcome.finished(
                system.measure(system.open(folder, MPI.COMM_SELF)), kept=True
            )
    return comm.bcast(outcome)


def _release(comm: MPI.Comm) -> None:
    """Free the model of the last case; PETSc keeps what Python lets go of until this collective
    call."""
    gc.collect()
    PETSc.garbage_cleanup(comm)
