"""The results folder of a run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from mpi4py import MPI
from pydantic import BaseModel, ConfigDict, ValidationError

from swgpar import log
from swgpar.errors import OutputError
from swgpar.results import history, lock, made_files
from swgpar.results.atomic import TEMPORARY, agreed, discard, on_root, reason_of
from swgpar.results.table import Columns, read_columns

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

COMMON_RESULTS = (history.NAME, SUMMARY, "figures/*.png", REPORT, LOG)
"""Files of all systems."""

DRIVE_RESULTS = (
    *COMMON_RESULTS,
    history.DESCRIPTION,
    CHECKPOINT,
    START_STATES,
    *(f"{name}.csv" for name in DRIVE_TABLES),
    SECTOR,
    SECTOR_XDMF,
    "fields.xdmf",
    FIELD_INDEX,
    f"{FIELDS}/*.h5",
)
"""Files of a drive whose mesh is given."""

TRAIN_RESULTS = (*COMMON_RESULTS, "published.csv", f"{TABLES}/*.csv")
"""Files of a gear train."""

RESULTS = tuple(dict.fromkeys((*DRIVE_RESULTS, RECIPE, *TRAIN_RESULTS)))
"""Files that `overwrite` removes, as far as a run has made them."""


def open_log(out: Path | None, comm: MPI.Comm) -> None:
    """Send the log into run.log of the folder from now on, or into no file; collective."""
    log.close_file()
    if out is not None:
        with agreed(comm, out / LOG):
            if comm.rank == 0:
                made_files.note(out / LOG)
            log.to_file(out / LOG, comm)


def prepare(
    out: Path,
    comm: MPI.Comm,
    written: Iterable[str],
    *,
    restart: bool,
    overwrite: bool,
    inputs: Iterable[Path] = (),
) -> bool:
    """Make the folder, lock it and try to write in it; raises OutputError on all ranks.

    The function that runs releases the lock: it is decorated with `lock.releasing`.

    Results of an earlier run are refused unless `restart` continues or `overwrite` replaces them.
    So are links, and files that no run has made here, under names that the run will write.

    written : patterns of these names;  inputs : files that the run reads, which stay

    Returns whether there is a checkpoint to continue from: without one a run starts again.
    """
    with agreed(comm, out):
        if comm.rank == 0:
            out.mkdir(parents=True, exist_ok=True)
            lock.acquire(out)
            probe = out / f"probe{TEMPORARY}"
            discard(probe)
            with probe.open("xb") as file:
                file.write(b"swgpar")
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
    with agreed(comm, out):
        if comm.rank == 0:
            if restart and saved:
                made_files.begin(out, DRIVE_RESULTS)
            made_files.require_own(out, written)
            made_files.begin(out)
            if overwrite and not restart:
                made_files.require_none_of(out, written, inputs)
                remove_results(out, inputs)
    return restart and saved


def remove_results(out: Path, inputs: Iterable[Path] = ()) -> None:
    """Remove what an earlier run has made in a folder; call it on one rank. inputs : that stay"""
    made_files.remove(out, RESULTS, [path.resolve() for path in inputs])


class TableFacts(BaseModel):
    """Number of rows of a table, and its columns of texts."""

    rows: int
    texts: list[str]

    @classmethod
    def of(cls, columns: Columns) -> TableFacts:
        """Those of a table."""
        texts = [name for name, values in columns.items() if values.dtype.kind == "U"]
        return cls(rows=max(map(len, columns.values()), default=0), texts=texts)


class StoredSummary(BaseModel):
    """What summary.json of every system has. A system adds fields; `model_extra` has the others."""

    model_config = ConfigDict(extra="allow")

    design: dict[str, Any]
    versions: dict[str, str] = {}
    tables: dict[str, TableFacts] = {}

    @property
    def written_by(self) -> str:
        """Words for the version of swgpar."""
        return self.versions.get("swgpar", "of unknown number")

    def require_whole(self, folder: Path, tables: Mapping[str, Columns]) -> None:
        """Raise OutputError where a table has other rows than the run has written, or texts in a
        column of numbers. tables : by the file's path below the folder
        """
        for name, written in self.tables.items():
            found = TableFacts.of(tables.get(name, {}))
            if found.rows != written.rows:
                raise OutputError(
                    f"{folder / name} has {found.rows} rows, and the run wrote {written.rows}: "
                    "restore it from a copy, or run again"
                )
            if changed := sorted(set(found.texts) - set(written.texts)):
                raise OutputError(
                    f"{folder / name} has texts in the column {changed[0]}, and the run wrote "
                    "numbers: restore it from a copy, or run again"
                )


def table_facts(folder: Path, names: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Facts of tables in a folder by the file's path, for `StoredSummary`; call it on one rank."""
    present = [name for name in names if (folder / name).exists()]
    return {name: TableFacts.of(read_columns(folder / name)).model_dump() for name in present}


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
