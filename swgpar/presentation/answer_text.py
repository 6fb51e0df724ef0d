"""Words and numbers of an answer, on the terminal and in the report."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from swgpar.answers.answer import Answer
from swgpar.results.page import Amount, Table, number

NOTHING = 1e-9
"""Size below which a value is round-off and 0 is shown."""

WRITTEN_OUT = 1e9
"""Size up to which a value has no power of ten."""


def value_text(value: float | None, error: float | None = None) -> str:
    """A value with the digits of its error, without one with five; a dash where there is none."""
    if value is None:
        return "—"
    if abs(value) < NOTHING:
        return number(0.0)
    if not np.isfinite(value) or error is None or error < NOTHING:
        written = number(float(value))
        # a power of ten stands for zeros before the point
        is_short = abs(value) < WRITTEN_OUT and "e+" in written
        return f"{float(written):.0f}" if is_short else written
    return _rounded(value, _decimals(error))


def _decimals(error: float) -> int:
    """Decimals of the second digit of an error, negative left of the point."""
    return 1 - int(np.floor(np.log10(error)))


def _rounded(value: float, decimals: int) -> str:
    """Without a power of ten and without the sign of a zero."""
    return f"{round(value, decimals) + 0.0:.{max(decimals, 0)}f}"


def error_text(answer: Answer) -> str:
    """The error with two digits, without a power of ten and without a break of the line, or what
    stands in its place."""
    error = answer.error
    if error is None:
        return answer.no_error.replace(" ", "\u00a0")
    return plus_minus(error)


def plus_minus(error: float) -> str:
    """An error with two digits, without a power of ten and without a break of the line."""
    error = 0.0 if error < NOTHING else error
    return f"±\u00a0{_rounded(error, _decimals(error) if error > 0.0 else 0)}"


def remark_text(answer: Answer) -> str:
    """What to know about an answer, with its limit."""
    limit = "" if answer.limit is None else f"good up to {number(answer.limit)}"
    return "; ".join(filter(None, (answer.remark, limit)))


def answer_table(answers: Iterable[Answer]) -> Table:
    """A row of the report for each answer."""
    rows = []
    for answer in answers:
        text = value_text(answer.value, answer.error)
        amount = text if answer.value is None else Amount(answer.value, text)
        numbers = [amount, answer.unit, error_text(answer)]
        rows.append([answer.text, *numbers, answer.place, remark_text(answer), answer.name])
    return Table(["", "value", "unit", "error", "where", "remark", "name"], rows)


def detail_table(summary: Mapping[str, Answer]) -> Table | None:
    """The answers that are details, None without any."""
    details = [answer for answer in summary.values() if answer.detail]
    return answer_table(details) if details else None
