"""CSV tables: floats as the shortest text that reads back the same, nothing for no value."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from swgpar.errors import OutputError, printable

Columns = Mapping[str, np.ndarray]
"""Of a table, by name; all of one length."""

FORMULA = ("=", "+", "-", "@")
"""First letters of a text that spreadsheets take for a formula and compute."""


def format_csv(rows: Sequence[Mapping[str, Any]]) -> bytes:
    """The text of a table given by its rows; the columns are those of the first."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = list(rows[0])
    writer.writerow([_cell(name) for name in names])
    writer.writerows([_cell(row[name]) for name in names] for row in rows)
    return text.getvalue().encode()


def _cell(value: Any) -> Any:
    """A value in a file: a text that a spreadsheet would compute begins with an apostrophe."""
    if isinstance(value, float):
        return repr(float(value))  # NumPy 2 shows the type of its own numbers
    if not isinstance(value, str):
        return value
    value = printable(value)
    return f"'{value}" if value.startswith(FORMULA) and not is_number(value) else value


def is_number(text: str) -> bool:
    """Whether a cell of a table holds a number."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def format_columns(columns: Mapping[str, Sequence[Any] | np.ndarray]) -> bytes:
    """The text of a table given by its columns, all of one length of at least one."""
    lists = [c.tolist() if isinstance(c, np.ndarray) else list(c) for c in columns.values()]
    return format_csv([dict(zip(columns, row)) for row in zip(*lists, strict=True)])


def as_columns(rows: Sequence[Mapping[str, Any]]) -> dict[str, np.ndarray]:
    """The columns of a table given by its rows, as `read_columns` reads them; none for no rows."""
    found = {name: np.array([row[name] for row in rows]) for name in (rows[0] if rows else {})}
    return {
        name: values.astype(float) if values.dtype.kind in "if" else values
        for name, values in found.items()
    }


def read_columns(path: Path) -> dict[str, np.ndarray]:
    """Columns of a table: float64 where every value is a number, else text.

    Raises OutputError for a file that is none that `format_csv` writes.
    """
    header, rows = read_rows(path)
    columns = {}
    for name, values in zip(header, zip(*rows, strict=True)):
        try:
            columns[name] = np.array(values, dtype=float)
        except ValueError:
            columns[name] = np.array(values)
    return columns


def read_rows(path: Path) -> tuple[list[str], list[list[str]]]:
    """Header and rows of a table, which all have as many cells; raises OutputError otherwise."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            found = list(csv.reader(file))
    except (OSError, ValueError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or "it is no table"
        raise OutputError(f"cannot read {path}: {reason}") from None
    if not found or len({*found[0]}) < len(found[0]):
        raise OutputError(f"cannot read {path}: it has no header with a name for each column")
    for number, row in enumerate(found[1:], start=2):
        if len(row) != len(found[0]):
            raise OutputError(
                f"cannot read {path}: row {number} has {len(row)} cells, and the header "
                f"{len(found[0])}: it was cut off or changed"
            )
    return found[0], found[1:]


def as_rows(columns: Mapping[str, np.ndarray]) -> list[dict[str, Any]]:
    """The rows of a table given by its columns, with Python's own types."""
    return [
        dict(zip(columns, values))
        for values in zip(*(column.tolist() for column in columns.values()))
    ]
