"""summary.json: written from the summary, and read back into it, also from the first format."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from swgpar.checks.design_file import make_drive
from swgpar.drive_results.first_format import from_first_format
from swgpar.drive_results.summary import DriveSummary
from swgpar.errors import OutputError
from swgpar.results.atomic import to_json
from swgpar.results.folder import SUMMARY, StoredSummary
from swgpar.results.history import Row
from swgpar.version import __version__

FORMAT = 2
"""Number in the file. Format 1 has none: its values stood beside each other and had no table of
answers."""


def summary_to_json(summary: DriveSummary, tables: Mapping[str, Any] | None = None) -> bytes:
    """Text of summary.json. Its table of answers is for other programs: it is not read back.

    tables : facts of the tables beside it
    """
    content = asdict(summary) | {"design": summary.design.model_dump()}
    head = {"format": FORMAT, "tables": tables or {}}
    return to_json({**head, "answers": [asdict(answer) for answer in summary.values()], **content})


def summary_from(
    stored: StoredSummary,
    rows: Sequence[Row],
    pairs: Mapping[str, np.ndarray],
    path: Path = Path(SUMMARY),
) -> DriveSummary:
    """The summary from the content of summary.json, the rows of history.csv and the columns of
    pairs.csv.

    Raises OutputError for a format that this version does not read.
    """
    content = stored.model_dump()
    number = content.get("format", 1)
    try:
        if number not in (1, FORMAT):
            raise ValueError(number)
        if number == 1:
            content = from_first_format(content, rows, pairs)
        found: DriveSummary = _adapter().validate_python(content)
    except (ValidationError, KeyError, TypeError, ValueError):
        found_in = f"{path} was written by swgpar {stored.written_by}"
        if number in (1, FORMAT):
            raise OutputError(
                f"{found_in}, and swgpar {__version__} does not read its content: it was changed, "
                "or that version knew other keys; open it with that one, or run again"
            ) from None
        raise OutputError(
            f"{found_in} in the format {number}: allowed are formats 1 to {FORMAT} with swgpar "
            f"{__version__}; open it with that version, or run again"
        ) from None
    found.design.made_by(make_drive)
    return found


@cache
def _adapter() -> TypeAdapter[DriveSummary]:
    return TypeAdapter(DriveSummary)
