"""Words and numbers of a verdict, on the terminal and on the page."""

from __future__ import annotations

import math

from swgpar.answers.verdict import Judgement, Verdict, counted
from swgpar.presentation.answer_text import error_text, value_text
from swgpar.rating.sheet import RatingSheet, RunEntry
from swgpar.results.page import number


def amount_text(verdict: Verdict) -> str:
    """The value with its unit; a dash where there is none."""
    answer = verdict.answer
    if answer is None or answer.value is None:
        return "—"
    if math.isinf(answer.value):
        return "without end"
    return f"{value_text(answer.value, answer.error)} {answer.unit}".rstrip()


def error_of(verdict: Verdict) -> str:
    """The error, or what stands in its place; empty without an answer."""
    answer = verdict.answer
    return "" if answer is None or answer.value is None else error_text(answer)


def limit_text(verdict: Verdict) -> str:
    """The limit with its sense; empty without one."""
    limit = verdict.limit
    return "" if limit is None else f"{limit.sense} {number(limit.value)}"


def further_text(verdict: Verdict) -> str:
    """Why nothing is judged, place, remark, and where the limit comes from."""
    answer, limit = verdict.answer, verdict.limit
    parts = [verdict.why]
    if answer is not None and answer.value is not None:
        parts += [answer.place, "" if answer.remark == verdict.why else answer.remark]
    parts.append("" if limit is None else f"limit: {limit.source}")
    return "; ".join(filter(None, parts))


def headline_text(sheet: RatingSheet) -> str:
    """The headline in a sentence, with the rows that it comes from."""
    rows = [one for one in counted(sheet.verdicts) if one.judgement == sheet.headline]
    named = ", ".join(one.name for one in rows)
    failing = "computation" if all(one.of_computation for one in rows) else "drive"
    sentences = {
        Judgement.PASSES: "The drive passes.",
        Judgement.NOT_JUDGED: f"The drive is not judged. No verdict on {named or 'any row'}.",
        Judgement.WITHIN_ERROR: f"The drive is within its errors of a limit: {named}.",
        Judgement.FAILS: f"The {failing} fails: {named}.",
    }
    return sentences[sheet.headline]


def counts_text(sheet: RatingSheet) -> str:
    """How many rows have a judgement, and how many runs wait."""
    counts = [f"{judgement}: {count}" for judgement, count in sheet.counts.items()]
    if waiting := sum(run.status == "waits" for run in sheet.runs):
        counts.append(f"runs that wait: {waiting}")
    return ", ".join(counts)


def run_text(run: RunEntry) -> str:
    """What is to know of a run."""
    left = f"left out: {run.left_out}" if run.left_out else ""
    return "; ".join(filter(None, (run.reason, left)))
