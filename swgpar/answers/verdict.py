"""Verdicts: an answer beside its limit."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from swgpar.answers.answer import NO_LIMIT, Answer


class Judgement(StrEnum):
    """What a verdict says, from the best to the worst."""

    PASSES = "passes"
    NOT_JUDGED = "not judged"
    WITHIN_ERROR = "within its error"
    FAILS = "fails"


class Sense(StrEnum):
    """On which side of a limit values are good; the limit itself is."""

    AT_MOST = "at most"
    AT_LEAST = "at least"


@dataclass(frozen=True)
class Limit:
    """value : in the unit of the answer;  source : where the limit comes from"""

    value: float
    sense: Sense
    source: str

    @property
    def size(self) -> float:
        """By which distances from it are divided: its magnitude, 1 of the limit 0."""
        return abs(self.value) or 1.0


@dataclass(frozen=True)
class Verdict:
    """An answer beside its limit.

    name : what is judged
    answer : None where there is none, for the `reason`
    limit : None without a requirement
    reason : why nothing is judged, or why the answer is a bound; empty otherwise
    is_lower_bound : of the number that counts. It cannot pass where the limit is the largest value,
    nor fail where it is the least one
    of_strength : whether it is about the strength of the drive
    of_computation : whether it is about the computation and not about the drive
    """

    name: str
    answer: Answer | None
    limit: Limit | None
    reason: str = ""
    is_lower_bound: bool = False
    of_strength: bool = False
    of_computation: bool = False

    @property
    def judgement(self) -> Judgement:
        """What it says. An answer without an estimate of its error is judged by its value."""
        answer, limit = self.answer, self.limit
        if limit is None or answer is None or answer.value is None or answer.no_error == NO_LIMIT:
            return Judgement.NOT_JUDGED
        beyond = answer.value - limit.value
        if limit.sense == Sense.AT_LEAST:
            beyond = -beyond
        fails = beyond > 0.0
        if self.is_lower_bound and fails == (limit.sense == Sense.AT_LEAST):
            return Judgement.NOT_JUDGED
        if answer.error is not None and abs(beyond) <= answer.error:
            return Judgement.WITHIN_ERROR
        return Judgement.FAILS if fails else Judgement.PASSES

    @property
    def margin(self) -> float | None:
        """How far the value is from its limit on the good side, over the size of the limit; below 0
        beyond it. None without a value or a limit."""
        if self.limit is None or self.answer is None or self.answer.value is None:
            return None
        sign = 1.0 if self.limit.sense == Sense.AT_LEAST else -1.0
        return sign * (self.answer.value - self.limit.value) / self.limit.size

    @property
    def why(self) -> str:
        """Why nothing is judged; empty where something is."""
        answer = self.answer
        if self.judgement != Judgement.NOT_JUDGED:
            return ""
        if self.reason or self.limit is None:
            return self.reason or "no requirement"
        if answer is None or answer.value is None:
            return answer.remark if answer is not None else "the run does not have it"
        return answer.remark or "it grows with every finer mesh"


def counted(verdicts: Iterable[Verdict]) -> list[Verdict]:
    """The verdicts that have a limit or are about strength: those that judge the whole."""
    return [one for one in verdicts if one.limit is not None or one.of_strength]


def worst(verdicts: Iterable[Verdict]) -> Judgement:
    """The worst judgement of `counted` verdicts; `NOT_JUDGED` without any."""
    order = list(Judgement)
    judgements = [one.judgement for one in counted(verdicts)]
    return max(judgements, key=order.index, default=Judgement.NOT_JUDGED)
