"""One of many runs: run it, keep what went wrong in its folder, continue it after a restart."""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from mpi4py import MPI

from swgpar import log
from swgpar.errors import InputError, SwgparError, printable
from swgpar.input.design import Design
from swgpar.log import logger
from swgpar.petsc import release_unused
from swgpar.results import made_files
from swgpar.results.atomic import agreed, on_root, reason_of, to_json, write_file, write_from_root
from swgpar.results.figure_set import save_figures
from swgpar.results.folder import RESULTS, SUMMARY, remove_results
from swgpar.run_options import RunOptions
from swgpar.studies.case import Outcome
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


def run_one(
    system: System[Any, Any], design: Design | None, options: RunOptions, refusal: str = ""
) -> Outcome:
    """Run a design; collective. Failures are returned, and recorded in the folder of the options.

    Only an error that swgpar does not know is raised when several ranks share the run: one rank may
    have met it alone, and the others then wait for it.

    design : None when it is refused, for the reason in `refusal`
    """
    record: dict[str, Any] = {"identity": ""}
    folder, comm = options.out, options.comm
    try:
        if design is None:
            raise InputError(refusal)
        record = system.identity(design, options.recipe)
        if options.accuracy is not None:
            record["accuracy"] = options.accuracy
        if folder is not None:
            old = on_root(comm, lambda: read_status(folder))
            same = _continues(old, record)
            if options.restart and old.get("status") == "finished":
                outcome = _finished_before(system, folder, comm, record, old)
                if outcome is not None:
                    if outcome.kept:
                        system.take_over(design, options)
                    return outcome
            _make(folder, comm)
            write_from_root(comm, folder / STATUS, to_json({"status": "started", **record}))
            restart = options.restart and same
            options = replace(options, restart=restart, overwrite=options.overwrite or not same)
        outcome = _compute(system, design, options)
    except SwgparError as error:
        if getattr(error, "alone", False) and comm.size > 1:
            raise
        logger.error("%s", error)
        outcome = Outcome("failed", str(error))
    except Exception as error:
        logger.exception("unexpected error")
        outcome = Outcome("failed", printable(f"{type(error).__name__}: {reason_of(error)}"))
        if comm.size > 1:
            if folder is not None:
                status = {"status": "failed", **record, "reason": outcome.reason}
                with suppress(OSError):
                    write_file(folder / STATUS, to_json(status))
            raise
    log.close_file()
    release_unused(comm)
    if folder is not None:
        with suppress(SwgparError):  # the table has it
            _record(folder, comm, {"status": outcome.status, **record, "reason": outcome.reason})
    return outcome


def remove_runs(folder: Path) -> None:
    """Remove the results of all runs below a folder; call it on one rank."""
    for status in [*folder.glob(f"**/{STATUS}")]:
        remove_results(status.parent)
        made_files.remove(status.parent, [STATUS])


def _make(folder: Path, comm: MPI.Comm) -> None:
    """Make the folder of a run, and the list of its files; collective."""
    with agreed(comm, folder):
        if comm.rank == 0:
            made_files.refuse_link(folder)
            folder.mkdir(parents=True, exist_ok=True)
            begun = (folder / STATUS).exists()
            made_files.begin(folder, (STATUS, *RESULTS) if begun else ())


def _continues(old: dict[str, Any], record: dict[str, Any]) -> bool:
    """Whether a run goes on from what its folder holds: not where it computes more in the loaded
    state, which is passed. old : its status file"""
    begun = {name for name in record if name not in ("identity", "rotation")} if old else set()
    same = old.get("identity", record["identity"]) == record["identity"]
    return same and all(old.get(name) == record[name] for name in begun)


def _finished_before(
    system: System[Any, Any],
    folder: Path,
    comm: MPI.Comm,
    record: dict[str, Any],
    old: dict[str, Any],
) -> Outcome | None:
    """Outcome of a run that an earlier call finished, unless it has to be computed again;
    collective. old : its status file"""
    if old.get("identity", record["identity"]) != record["identity"]:
        return Outcome(
            "failed",
            f"{folder} holds results of another design: rename the case, or overwrite = true "
            "(--overwrite)",
        )

    outcome = None
    with agreed(comm, folder / SUMMARY, "read"):
        complete = comm.rank == 0 and (folder / SUMMARY).exists()
        if complete and all(old.get(key) == value for key, value in record.items()):
            measured = system.measure(system.open(folder, MPI.COMM_SELF))
            outcome = Outcome("finished", **vars(measured), kept=True)
    return comm.bcast(outcome)


def _compute(system: System[Any, Any], design: Design, options: RunOptions) -> Outcome:
    if "restart" not in system.options:
        # an interrupted run begins anew, and may have left its first tables
        options = replace(options, restart=False, overwrite=options.overwrite or options.restart)
    result = system.run(design, options)
    if options.out is not None and system.draws_figures(design):
        save_figures(result.plot, options.out)
    return Outcome("finished", **vars(system.measure(result)))


def _record(folder: Path, comm: MPI.Comm, status: dict[str, Any]) -> None:
    _make(folder, comm)
    earlier = on_root(comm, lambda: read_status(folder))
    if status["status"] == "finished" or earlier.get("status") != "finished":
        write_from_root(comm, folder / STATUS, to_json(status))
