"""Tables of a drive's run beside its history: contacts of flanks, fatigue and losses; in memory or
in files."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from pathlib import Path

from mpi4py import MPI

from swgpar.results.atomic import write_from_root
from swgpar.results.folder import DRIVE_TABLES
from swgpar.results.sector_fields import SectorFields, read_sector, write_sector
from swgpar.results.table import Columns, format_columns, read_columns


@dataclass(eq=False)
class DriveTables:
    """Columns of the tables that `DRIVE_TABLES` describes, empty where there are none.

    fatigue : safety factors, amplitude and mean at the nodes of a sector, None without
    """

    pairs: Columns = field(default_factory=dict)
    contact_lines: Columns = field(default_factory=dict)
    program: Columns = field(default_factory=dict)
    transmission_error: Columns = field(default_factory=dict)
    balls: Columns = field(default_factory=dict)
    bolts: Columns = field(default_factory=dict)
    fatigue_cycle: Columns = field(default_factory=dict)
    losses: Columns = field(default_factory=dict)
    fatigue: SectorFields | None = None


def write_tables(folder: Path, comm: MPI.Comm, tables: DriveTables) -> None:
    """Write what is evaluated at the end of a run; collective."""
    for name in ("fatigue_cycle", "losses"):
        if columns := getattr(tables, name):
            write_from_root(comm, folder / f"{name}.csv", format_columns(columns))
    if tables.fatigue is not None:
        write_sector(folder, comm, tables.fatigue)


def table_files() -> dict[str, str]:
    """Files of the tables that are read back -> their attributes."""
    names = DRIVE_TABLES.keys() & {each.name for each in fields(DriveTables)}
    return {f"{name}.csv": name for name in sorted(names)}


def read_tables(folder: Path) -> DriveTables:
    """The tables in a results folder."""
    paths = {name: folder / file for file, name in table_files().items()}
    found = {name: read_columns(path) for name, path in paths.items() if path.exists()}
    return DriveTables(**found, fatigue=read_sector(folder))
