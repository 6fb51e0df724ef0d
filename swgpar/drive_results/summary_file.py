"""summary.json: written from the summary, and read back into it, also from the first format."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import cache
from pathlib import Path

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


def summary_to_json(summary: DriveSummary) -> bytes:
    """Text of summary.json. Its table of answers is for other programs: it is not read back."""
    content = asdict(summary) | {"design": summary.design.model_dump()}
    return to_json(
        {"format": FORMAT, "answers": [asdict(answer) for answer in summary.values()], **content}
    )


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
        raise OutputError(
            f"{path} of swgpar {stored.written_by} has the format {number}, and not a content "
            f"that swgpar {__version__} reads: allowed are results of formats 1 to {FORMAT}"
        ) from None
    found.design.made_by(make_drive)
    return found


@cache
def _adapter() -> TypeAdapter[DriveSummary]:
    return TypeAdapter(DriveSummary)
