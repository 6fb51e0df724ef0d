"""Result of a gear train, in memory or in files: tables and summary.json."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.results import history
from swgpar.results.atomic import agreed, to_json, write_from_root
from swgpar.results.figure_set import NamedFigures
from swgpar.results.folder import SUMMARY, TABLES, read_summary
from swgpar.results.table import format_columns, format_csv, read_columns

Table = Mapping[str, np.ndarray]
"""Columns by name, with their unit at the end of the name; all of one length."""

PUBLISHED = "published.csv"


@dataclass(frozen=True)
class TrainResult:
    """What a run of a gear train gives; the same on every rank.

    Attributes
    ----------
    history : dict of (n,) arrays
        Columns of history.csv; their names end with the unit. ``pandas.DataFrame(result.history)``
        makes a table of it.
    tables : dict of tables like the history, by name
    quantities : dict
        What can be compared with published values: a number or a list of numbers by name.
    summary : dict
        Content of summary.json.
    compared : list of dict
        Published values of the design file beside the computed ones: rows of published.csv.
    folder : Path or None
        The results folder; None when the run was in memory.
    plot : NamedFigures
        The figures: ``plot.names`` lists them, ``plot.NAME()`` returns a matplotlib figure.
    """

    history: Table
    tables: Mapping[str, Table]
    quantities: Mapping[str, float | list[float]]
    summary: dict[str, Any] = field(default_factory=dict)
    compared: list[dict[str, Any]] = field(default_factory=list)
    folder: Path | None = None
    plot: NamedFigures = field(default_factory=lambda: NamedFigures({}, MPI.COMM_SELF), repr=False)

    @property
    def design_table(self) -> Mapping[str, Any]:
        """The whole design, defaults included."""
        return self.summary["design"]


def write(result: TrainResult, out: Path, comm: MPI.Comm) -> None:
    """Write all tables, the summary last; collective."""
    with agreed(comm, out / TABLES):
        if comm.rank == 0:
            (out / TABLES).mkdir(exist_ok=True)
    for name, table in result.tables.items():
        write_from_root(comm, out / TABLES / f"{name}.csv", format_columns(table))
    if result.compared:
        write_from_root(comm, out / PUBLISHED, format_csv(result.compared))
    write_from_root(comm, out / history.NAME, format_columns(result.history))
    write_from_root(comm, out / SUMMARY, to_json(result.summary))


def read(out: Path) -> TrainResult:
    """Result of a finished run from its folder, without figures; every rank reads the files."""
    summary = read_summary(out)
    tables = {path.stem: read_columns(path) for path in sorted((out / TABLES).glob("*.csv"))}
    compared = _read_compared(out / PUBLISHED) if (out / PUBLISHED).exists() else []
    quantities = {
        name: np.array(found, dtype=float).tolist()  # null is a number that is not finite
        for name, found in summary["quantities"].items()
    }
    return TrainResult(read_columns(out / history.NAME), tables, quantities, summary, compared, out)


def _read_compared(path: Path) -> list[dict[str, Any]]:
    texts = ("quantity", "meaning")
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return [
        {n: value if n in texts else float(value) if value else None for n, value in row.items()}
        for row in rows
    ]
