"""The results folder of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mpi4py import MPI
from pydantic import BaseModel, ConfigDict, ValidationError

from swgpar import log
from swgpar.errors import InputError, OutputError
from swgpar.input.quantities import show
from swgpar.results import history, lock
from swgpar.results.atomic import TEMPORARY, agreed, discard, on_root, reason_of, write_file

RECIPE = "recipe.toml"
"""The mesh recipe that was chosen for an accuracy."""

CHECKPOINT = "checkpoint.h5"
"""The last converged state, until the run is finished."""

FIELDS, FIELD_INDEX = "fields", "fields.h5"
"""Folder of the mesh and of the fields of all increments, and the file with links to them."""

TABLES = "tables"
"""Folder of the tables that a gear train adds to its history."""

DRIVE_TABLES = {
    "pairs": "contacts of the flanks under load",
    "contact_lines": "the same along the face width",
    "program": "torque and rotation of the output at the points of a load program",
    "stiffness": "the same on the branches of the stiffness loops",
    "transmission_error": "transmission error and input torque over a period or whole turns",
    "losses": "losses at the angles of the sampled period",
    "fatigue_cycle": "stress over a cycle where the safety is the least",
    "balls": "loads of the balls of a bearing",
    "bolts": "loads of the bolts that hold the cup",
}
"""Tables that a drive adds to its history: name of the file without .csv -> what it has."""

SECTOR, SECTOR_XDMF = "fatigue.h5", "fatigue.xdmf"
"""Safety factors at the nodes of one sector."""

START_STATES = "start_*.h5"
"""Loaded states on the meshes of a start, until there is a checkpoint."""

SUMMARY = "summary.json"
"""Written last: a folder that has it is that of a finished run."""

REPORT = "report.html"
"""What the run gives, on one page."""

LOG = "run.log"
"""The log of the run."""

RESULTS = (
    history.NAME,
    history.DESCRIPTION,
    CHECKPOINT,
    START_STATES,
    SUMMARY,
    *(f"{name}.csv" for name in DRIVE_TABLES),
    SECTOR,
    SECTOR_XDMF,
    "published.csv",
    RECIPE,
    f"{TABLES}/*.csv",
    "fields.xdmf",
    FIELD_INDEX,
    f"{FIELDS}/*.h5",
    "figures/*.png",
    REPORT,
    LOG,
)
"""Files that `overwrite` removes."""


def given_folder(out: str | Path) -> Path:
    """The folder that a user has given; an empty text, the working directory, is an InputError."""
    if isinstance(out, str) and not out.strip():
        raise InputError(f"out = {show(out)} names no folder: give the path of one")
    return Path(out)


def open_log(out: Path | None, comm: MPI.Comm) -> None:
    """Send the log into run.log of the folder from now on, or into no file; collective."""
    log.close_file()
    if out is not None:
        with agreed(comm, out / LOG):
            log.to_file(out / LOG, comm)


def prepare(out: Path, comm: MPI.Comm, restart: bool, overwrite: bool) -> bool:
    """Make the folder, lock it and try to write in it; raises OutputError on all ranks.

    The function that runs releases the lock: it is decorated with `lock.releasing`.

    Results of an earlier run are refused unless `restart` continues or `overwrite` replaces them.
    Returns whether there is a checkpoint to continue from: without one a run starts again.
    """
    with agreed(comm, out):
        if comm.rank == 0:
            out.mkdir(parents=True, exist_ok=True)
            lock.acquire(out)
            probe = out / f"probe{TEMPORARY}"
            write_file(probe, b"swgpar")
            probe.unlink()
            for left in out.glob(f"*{TEMPORARY}"):
                discard(left)
    present, saved = on_root(
        comm, lambda: [(out / name).exists() for name in (history.NAME, CHECKPOINT)]
    )
    if present and not restart and not overwrite:
        raise OutputError(
            f"{out} already holds results: continue them with restart = true (--restart), replace "
            "them with overwrite = true (--overwrite), or choose another folder"
        )
    if overwrite and not restart:
        with agreed(comm, out):
            if comm.rank == 0:
                remove_results(out)
    return restart and saved


def remove_results(out: Path) -> None:
    """Remove the results of an earlier run from a folder; call it on one rank."""
    for pattern in RESULTS:
        for old in out.glob(pattern):
            old.unlink()


class StoredSummary(BaseModel):
    """What summary.json of every system has. A system adds fields; `model_extra` has the others."""

    model_config = ConfigDict(extra="allow")

    design: dict[str, Any]
    versions: dict[str, str] = {}

    @property
    def written_by(self) -> str:
        """Words for the version of swgpar."""
        return self.versions.get("swgpar", "of unknown number")


def read_summary(folder: Path) -> StoredSummary:
    """Content of summary.json of a finished run; raises OutputError where there is none."""
    for name in (SUMMARY, history.NAME):
        if not (folder / name).exists():
            raise OutputError(f"{folder} has no {name} of a finished run")
    try:
        return StoredSummary.model_validate_json((folder / SUMMARY).read_bytes())
    except ValidationError as error:
        raise OutputError(f"cannot read {folder / SUMMARY}: {error.errors()[0]['msg']}") from None
    except OSError as error:
        raise OutputError(f"cannot read {folder / SUMMARY}: {reason_of(error)}") from None
