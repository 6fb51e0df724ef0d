"""What the run of a gear train leaves behind: history.csv, tables, published.csv and summary.json."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.results import history
from swgpar.results.atomic import agreed, to_json, write_from_root
from swgpar.results.folder import TABLES
from swgpar.results.table import format_columns, format_csv, read_columns

Table = Mapping[str, np.ndarray]
"""Columns by name, with their unit at the end of the name; all of one length."""

PUBLISHED = "published.csv"


@dataclass(frozen=True)
class TrainResult:
    """Results of a gear train, the same on all ranks.

    history : columns of history.csv;  tables : further tables by name
    quantities : what can be compared with published values;  summary : content of summary.json
    """

    history: Table
    tables: Mapping[str, Table]
    quantities: Mapping[str, float | list[float]]
    summary: dict[str, Any] = field(default_factory=dict)


def write(result: TrainResult, compared: list[dict[str, Any]], out: Path, comm: MPI.Comm) -> None:
    """Write all tables, the summary last; collective."""
    with agreed(comm, out / TABLES):
        if comm.rank == 0:
            (out / TABLES).mkdir(exist_ok=True)
    for name, table in result.tables.items():
        write_from_root(comm, out / TABLES / f"{name}.csv", format_columns(table))
    if compared:
        write_from_root(comm, out / PUBLISHED, format_csv(compared))
    write_from_root(comm, out / history.NAME, format_columns(result.history))
    write_from_root(comm, out / "summary.json", to_json(result.summary))


def read_table(out: Path, name: str) -> dict[str, np.ndarray]:
    """A table of a finished run."""
    return read_columns(out / TABLES / f"{name}.csv")
