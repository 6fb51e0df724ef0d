"""The rating sheet: verdicts, the runs behind them, and its files."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swgpar.answers.verdict import Judgement, Verdict, worst

FORMAT = 1
"""Number in rating.json."""

JSON, CSV, PAGE = "rating.json", "rating.csv", "rating.html"
"""Names of the sheet in its folder."""


@dataclass(frozen=True)
class RunEntry:
    """A run of the sheet.

    name : the load cases that it serves;  torque : N·m, None of a run that has several
    status : "finished", "failed", "refused" or "waits";  reason : of the last three
    left_out : what the design asks for and the run does not have
    wall_s : seconds, None of a run that has not finished;  folder : its name below that of the
    sheet, empty in memory
    """

    name: str
    torque: float | None
    status: str
    folder: str
    reason: str = ""
    left_out: str = ""
    wall_s: float | None = None


@dataclass(frozen=True)
class RatedVerdict:
    """A verdict and the load case that it refers to."""

    verdict: Verdict
    case: str


@dataclass(frozen=True)
class RatingSheet:
    """A drive's answers beside requirements and limits; the same on every rank.

    Attributes
    ----------
    title : of the drive
    rated : verdicts in the order of the sheet
    runs : in their order
    design : the whole design, defaults included, by section
    folder : of the files, None of a sheet in memory

    Examples
    --------
    >>> sheet = swgpar.rate("drive.toml", "results/rating")
    >>> sheet.headline, [one.verdict.name for one in sheet.rated]
    """

    title: str
    rated: tuple[RatedVerdict, ...]
    runs: tuple[RunEntry, ...]
    design: Mapping[str, Any]
    folder: Path | None

    @property
    def verdicts(self) -> tuple[Verdict, ...]:
        """All verdicts in the order of the sheet."""
        return tuple(one.verdict for one in self.rated)

    @property
    def headline(self) -> Judgement:
        """The worst verdict of all rows with a limit and of those about strength."""
        return worst(self.verdicts)

    @property
    def counts(self) -> dict[Judgement, int]:
        """How many rows have a judgement, without those that no row has; the worst first."""
        found = Counter(one.judgement for one in self.verdicts)
        return {one: found[one] for one in reversed(Judgement) if found[one]}

    @property
    def rows(self) -> list[dict[str, Any]]:
        """Rows of rating.csv."""
        return [_row(one) for one in self.rated]

    @property
    def content(self) -> dict[str, Any]:
        """Content of rating.json."""
        return {
            "format": FORMAT,
            "title": self.title,
            "headline": str(self.headline),
            "rows": self.rows,
            "runs": self.runs,
            "design": self.design,
        }


def _row(rated: RatedVerdict) -> dict[str, Any]:
    verdict = rated.verdict
    answer, limit = verdict.answer, verdict.limit
    return {
        "row": verdict.name,
        "verdict": str(verdict.judgement),
        "reason": verdict.why,
        "answer": "" if answer is None else answer.name,
        "value": None if answer is None else answer.value,
        "unit": "" if answer is None else answer.unit,
        "error": None if answer is None else answer.error,
        "no_error": "" if answer is None else answer.no_error,
        "sense": "" if limit is None else str(limit.sense),
        "limit": None if limit is None else limit.value,
        "source": "" if limit is None else limit.source,
        "load_case": rated.case,
        "place": "" if answer is None else answer.place,
        "remark": "" if answer is None else answer.remark,
    }
