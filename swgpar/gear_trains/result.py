"""Result of a gear train, in memory or in files: tables and summary.json."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
from mpi4py import MPI

from swgpar.answers.answer import NO_ESTIMATE, Answer
from swgpar.answers.table import AnswerTable
from swgpar.gear_trains.common_sections import TrainDesign
from swgpar.gear_trains.published import Comparison, numbered
from swgpar.results import history
from swgpar.results.atomic import agreed, on_root, to_json, write_from_root
from swgpar.results.figure_set import NamedFigures
from swgpar.results.folder import SUMMARY, TABLES, StoredSummary, table_facts
from swgpar.results.quantity import Quantity
from swgpar.results.table import Columns, format_columns, format_csv, read_columns, read_rows
from swgpar.vibration.sampling import TaskSeconds

PUBLISHED = "published.csv"

D = TypeVar("D", bound=TrainDesign, covariant=True)


@dataclass(frozen=True)
class Computed:
    """What the equations of a gear train give.

    history, tables : as those of a `TrainResult`
    quantities : a number or a list of numbers by name, NaN for what there is not
    task_s : times of the tasks of each kind
    """

    history: Columns
    tables: Mapping[str, Columns]
    quantities: Mapping[str, float | list[float]]
    task_s: Mapping[str, TaskSeconds]


@dataclass(frozen=True)
class TrainSummary(AnswerTable, Generic[D]):
    """What a whole run of a gear train gives: a mapping of answers by name.

    A quantity of several numbers has an answer for each: ``braked_B[1]``, ``braked_B[2]``.

    quantities : number or list of numbers by name, NaN for what there is not
    ranks : MPI ranks;  versions : of swgpar, Python, NumPy and SciPy
    wall_s : wall time of the run, s;  task_s : times of the tasks of each kind
    design : the whole design, defaults included
    known : meaning and unit of the quantities, by name
    """

    quantities: Mapping[str, float | list[float]]
    ranks: int
    versions: Mapping[str, str]
    wall_s: float
    task_s: Mapping[str, TaskSeconds]
    design: D
    known: Mapping[str, Quantity]

    def answers(self) -> Iterator[Answer]:
        for name, found in self.quantities.items():
            yield from _answers_of(name, self.known[name], np.atleast_1d(found).tolist())


def _answers_of(name: str, kind: Quantity, numbers: list[float]) -> Iterator[Answer]:
    for position, (title, value) in enumerate(zip(numbered(name, len(numbers)), numbers), start=1):
        text = kind.meaning if title == name else f"{kind.meaning}, {position} of {len(numbers)}"
        if math.isfinite(value):
            yield Answer(
                title,
                value,
                kind.unit,
                text,
                no_error=NO_ESTIMATE,
                remark=kind.remark,
                detail=kind.detail,
            )
        else:
            remark = "there is none"
            yield Answer(title, None, kind.unit, text, remark=remark, detail=kind.detail)


@dataclass(frozen=True)
class TrainResult(Generic[D]):
    """What a run of a gear train gives; the same on every rank.

    Attributes
    ----------
    history : dict of (n,) arrays
        Columns of history.csv; their names end with the unit. ``pandas.DataFrame(result.history)``
        makes a table of it.
    tables : dict of tables like the history, by name
    summary : TrainSummary
        A mapping of all answers by name: ``summary["out_of_contact"].value``.
        ``summary.quantities`` has lists where a quantity has several numbers.
    compared : list of Comparison
        Published values of the design file beside the computed ones: rows of published.csv.
    folder : Path or None
        The results folder; None when the run was in memory.
    plot : NamedFigures
        The figures: ``plot.names`` lists them, ``plot.NAME()`` returns a matplotlib figure.
    """

    history: Columns
    tables: Mapping[str, Columns]
    summary: TrainSummary[D]
    compared: list[Comparison] = field(default_factory=list)
    folder: Path | None = None
    plot: NamedFigures = field(default_factory=lambda: NamedFigures({}, MPI.COMM_SELF), repr=False)

    @property
    def design_table(self) -> Mapping[str, Any]:
        """The whole design, defaults included."""
        return self.summary.design.model_dump()


def write(result: TrainResult, out: Path, comm: MPI.Comm) -> None:
    """Write all tables, the summary last; collective."""
    with agreed(comm, out / TABLES):
        if comm.rank == 0:
            (out / TABLES).mkdir(exist_ok=True)
    for name, table in result.tables.items():
        write_from_root(comm, out / TABLES / f"{name}.csv", format_columns(table))
    if result.compared:
        write_from_root(comm, out / PUBLISHED, format_csv([asdict(row) for row in result.compared]))
    write_from_root(comm, out / history.NAME, format_columns(result.history))
    summary = result.summary
    names = [history.NAME, *(f"{TABLES}/{name}.csv" for name in result.tables)]
    content = {
        "tables": on_root(comm, lambda: table_facts(out, names)),
        "answers": [asdict(answer) for answer in summary.values()],
        "quantities": summary.quantities,
        "ranks": summary.ranks,
        "versions": summary.versions,
        "wall_s": summary.wall_s,
        "task_s": {name: asdict(times) for name, times in summary.task_s.items()},
        "design": result.design_table,
    }
    write_from_root(comm, out / SUMMARY, to_json(content))


class StoredTrainSummary(StoredSummary):
    """What summary.json of a gear train has beside its table of answers."""

    quantities: dict[str, Any]
    ranks: int
    wall_s: float
    task_s: dict[str, TaskSeconds | Any] = {}  # lists and sums in earlier versions


def summary_from(
    stored: StoredTrainSummary, design: TrainDesign, known: Mapping[str, Quantity]
) -> TrainSummary:
    """The summary from the content of summary.json, its design and what is known of its
    quantities."""
    given = stored.quantities | stored.model_extra  # some stood there in earlier versions
    times = {name: one for name, one in stored.task_s.items() if isinstance(one, TaskSeconds)}
    return TrainSummary(
        # null is a number that is not finite
        {name: np.array(given[name], dtype=float).tolist() for name in known if name in given},
        stored.ranks,
        stored.versions,
        stored.wall_s,
        times,
        design,
        known,
    )


def read(out: Path, stored: StoredSummary, summary: TrainSummary) -> TrainResult:
    """Result of a finished run from its folder, without figures; every rank reads the files."""
    tables = {path.stem: read_columns(path) for path in sorted((out / TABLES).glob("*.csv"))}
    rows = read_columns(out / history.NAME)
    found = {f"{TABLES}/{name}.csv": columns for name, columns in tables.items()}
    stored.require_whole(out, {**found, history.NAME: rows})
    compared = _read_compared(out / PUBLISHED) if (out / PUBLISHED).exists() else []
    return TrainResult(rows, tables, summary, compared, out)


def _read_compared(path: Path) -> list[Comparison]:
    _, rows = read_rows(path)
    return [
        Comparison(
            name, meaning, float(old), float(new), float(percent) if percent else None, *source
        )
        for name, meaning, old, new, percent, *source in rows  # no source in earlier versions
    ]
