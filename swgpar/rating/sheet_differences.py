"""What changes between two rating sheets."""

from __future__ import annotations

from dataclasses import dataclass

from swgpar.rating.stored_sheet import StoredRow, StoredSheet


@dataclass(frozen=True)
class RowDifference:
    """A row of two sheets; None where a sheet does not have it."""

    first: StoredRow | None
    second: StoredRow | None

    @property
    def name(self) -> str:
        """What is judged."""
        row = self.second or self.first
        assert row is not None
        return row.row

    @property
    def unit(self) -> str:
        """Of the values, and of the change."""
        units = [row.unit for row in (self.second, self.first) if row is not None and row.unit]
        return units[0] if units else ""

    @property
    def change(self) -> float | None:
        """From the first value to the second one; None where one is missing."""
        values = [row.value for row in (self.first, self.second) if row is not None]
        if len(values) < 2 or values[0] is None or values[1] is None:
            return None
        return values[1] - values[0]

    @property
    def error(self) -> float | None:
        """Of the change: the sum of both errors, None where one has no estimate."""
        errors = [row.error for row in (self.first, self.second) if row is not None]
        if len(errors) < 2 or errors[0] is None or errors[1] is None:
            return None
        return errors[0] + errors[1]


def sheet_differences(first: StoredSheet, second: StoredSheet) -> list[RowDifference]:
    """Rows whose value or verdict is not the same, in the order of the second sheet."""
    before = {row.row: row for row in first.rows}
    after = {row.row: row for row in second.rows}
    names = [*after, *(name for name in before if name not in after)]
    pairs = [RowDifference(before.get(name), after.get(name)) for name in names]
    return [pair for pair in pairs if _content(pair.first) != _content(pair.second)]


def _content(row: StoredRow | None) -> tuple[float | None, str]:
    """What counts; a sheet without a row says no more than one without its value."""
    return (None, "") if row is None else (row.value, row.verdict)
