"""The rating sheet of a folder, from its file."""

from __future__ import annotations

import json
from dataclasses import dataclass, fields
from pathlib import Path

from swgpar.answers.verdict import Judgement, Sense
from swgpar.errors import OutputError
from swgpar.rating.sheet import FORMAT, JSON
from swgpar.results.atomic import reason_of


@dataclass(frozen=True)
class StoredRow:
    """A row of rating.json: `swgpar.rating.sheet` says what its entries are."""

    row: str
    verdict: str
    reason: str
    answer: str
    value: float | None
    unit: str
    error: float | None
    no_error: str
    sense: str
    limit: float | None
    source: str
    load_case: str
    place: str
    remark: str

    @property
    def used(self) -> float | None:
        """Share of the limit that is used: 1 at the limit, above it beyond; None without a value or
        a limit, and where one of both is not above 0."""
        if self.value is None or self.limit is None or min(self.value, self.limit) <= 0.0:
            return None
        share = self.value / self.limit
        return share if self.sense == Sense.AT_MOST else 1.0 / share


@dataclass(frozen=True)
class StoredSheet:
    """title : of the drive;  headline : the worst judgement;  rows : in the order of the sheet
    sentence : the headline in words, with the rows that it comes from
    """

    title: str
    headline: Judgement
    rows: tuple[StoredRow, ...]
    sentence: str = ""


def read_sheet(folder: Path) -> StoredSheet:
    """The sheet of a folder. Raises OutputError where it cannot be read."""
    path = folder / JSON
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        if content["format"] != FORMAT:
            raise ValueError(f"its format is {content['format']}: this program reads {FORMAT}")
        names = [field.name for field in fields(StoredRow)]
        rows = tuple(StoredRow(**{name: row[name] for name in names}) for row in content["rows"])
        said = content.get("sentence", "")  # sheets of older versions have none
        return StoredSheet(content["title"], Judgement(content["headline"]), rows, said)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise OutputError(f"{path} cannot be read: {reason_of(error)}") from None
