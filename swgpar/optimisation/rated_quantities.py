"""Numbers of a rating sheet that objectives and constraints take: values and margins of its rows,
and how far its verdicts are from what is allowed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from swgpar.answers.answer import NO_LIMIT
from swgpar.answers.verdict import Judgement, Verdict, counted
from swgpar.errors import InputError
from swgpar.input.quantities import show
from swgpar.optimisation.spec import HEADLINE
from swgpar.rating.rows import RatingRow
from swgpar.rating.sheet import RatingSheet
from swgpar.results.quantity import Quantity

MARGIN_OF = "margin of "
"""Before the name of a row: how far its value is from its limit, over the limit."""

LEAST_MARGIN = "least margin"
"""Name of the least margin of all rows that are judged."""

NOT_JUDGED = 1.0
"""Distance of a row from a verdict that it would have with an answer: as far as a value of twice
its limit."""

KEPT = -1.0
"""Distance of verdicts without a number that are allowed."""

LEAST = 1e-12
"""Least distance of a verdict that is not allowed."""


def rated_quantities(rows: Iterable[RatingRow]) -> dict[str, Quantity]:
    """What a sheet with these rows gives, by name."""
    found = {LEAST_MARGIN: Quantity("least margin of the rows that are judged", "")}
    for row in rows:
        found[row.name] = Quantity(f"{row.name}, of the rating sheet", row.unit)
        if row.limit is not None:
            text = f"distance of the {row.name} from its limit, over the limit; below 0 beyond it"
            found[f"{MARGIN_OF}{row.name}"] = Quantity(text, "")
    return found


def rated_values(sheet: RatingSheet) -> dict[str, float]:
    """The numbers of a sheet by name, without those that it does not have."""
    found: dict[str, float] = {}
    for verdict in sheet.verdicts:
        if verdict.answer is not None and verdict.answer.value is not None:
            found[verdict.name] = verdict.answer.value
        margin = verdict.margin
        if margin is not None:
            found[f"{MARGIN_OF}{verdict.name}"] = margin
    if row := row_of_least_margin(sheet):
        found[LEAST_MARGIN] = found[f"{MARGIN_OF}{row}"]
    return found


def row_of_least_margin(sheet: RatingSheet) -> str:
    """Name of the judged row that has the least margin; empty where no row has one."""
    judged = [
        (one.margin, one.name)
        for one in sheet.verdicts
        if one.margin is not None and one.judgement != Judgement.NOT_JUDGED
    ]
    return min(judged)[1] if judged else ""


def growing(sheet: RatingSheet) -> frozenset[str]:
    """Names of the numbers that grow with every finer mesh."""
    rows = {
        one.name
        for one in sheet.verdicts
        if one.answer is not None and one.answer.no_error == NO_LIMIT
    }
    return frozenset(rows | {f"{MARGIN_OF}{name}" for name in rows})


def require_reachable(rows: Sequence[RatingRow], name: str, allowed: Judgement) -> None:
    """Refuse a verdict that no design can have, because a row has no limit.

    name : of a row, or "headline"
    """
    if allowed != Judgement.PASSES:
        return
    for row in rows:
        if row.limit is None and (row.name == name or (name == HEADLINE and row.of_strength)):
            raise InputError(
                f"{show(name)} never passes: {row.name} has no limit: "
                f"{row.missing or 'no requirement'}"
            )


def judged_as(sheet: RatingSheet, name: str) -> Judgement:
    """The verdict of a row, or of the headline."""
    if name == HEADLINE:
        return sheet.headline
    return next(one.judgement for one in sheet.verdicts if one.name == name)


def distance(sheet: RatingSheet, name: str, allowed: Judgement) -> float:
    """How far a row, or the headline, is from the worst verdict that is allowed, over its limit;
    0 and less is allowed."""
    verdicts = [one for one in sheet.verdicts if one.name == name]
    if name == HEADLINE:
        verdicts = counted(sheet.verdicts)
    return max((_distance(one, allowed) for one in verdicts), default=NOT_JUDGED)


def _distance(verdict: Verdict, allowed: Judgement) -> float:
    order, judgement, margin = list(Judgement), verdict.judgement, verdict.margin
    kept = order.index(judgement) <= order.index(allowed)
    if judgement == Judgement.NOT_JUDGED or margin is None or verdict.limit is None:
        return KEPT if kept else NOT_JUDGED
    error = verdict.answer.error if verdict.answer is not None else None
    share = (error or 0.0) / verdict.limit.size
    found = -margin + (-share if allowed == Judgement.WITHIN_ERROR else share)
    if math.isinf(found):
        return KEPT if kept else NOT_JUDGED
    return min(found, 0.0) if kept else max(found, LEAST)
