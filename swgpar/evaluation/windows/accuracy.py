"""Accuracy that was asked for, and that a run has reached."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.answers import (
    NO_ESTIMATE,
    Answer,
    AnswerGroup,
    AnswerKind,
    answer,
    evaluation,
)


@evaluation
class Accuracy(AnswerGroup):
    """Relative accuracy of the largest tensile stress at the teeth under load.

    asked : what was asked for;  estimated : None where it is not known
    reached : whether the estimate is small enough
    """

    asked: float
    estimated: float | None = answer(
        "accuracy.estimated",
        "estimated relative error of the largest tension at the teeth",
        exact=True,
    )
    reached: bool

    TITLE = "accuracy of the tension at the teeth"
    ASKED_BY = "--accuracy"

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        return ()  # a study does not ask for it

    def answers(self) -> Iterator[Answer]:
        for one in super().answers():
            yield replace(one, limit=self.asked, remark=one.remark or self._remark)

    def reasons(self) -> Mapping[str, str]:
        return {"accuracy.estimated": f"{NO_ESTIMATE}; {self._remark}"}

    @property
    def _remark(self) -> str:
        return "" if self.reached else "NOT reached: no finer mesh is taken"
