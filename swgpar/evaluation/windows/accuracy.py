"""Accuracy that was asked for, and that a run has reached."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.answers import Answer, AnswerGroup, AnswerKind, answer, evaluation


@evaluation
class Accuracy(AnswerGroup):
    """Relative accuracy of the largest tensile stress at the teeth under load.

    asked : what was asked for;  reached : whether the estimate is small enough
    """

    asked: float
    estimated: float = answer(
        "accuracy.estimated", "estimated relative error of the largest tension at the teeth"
    )
    reached: bool

    TITLE = "accuracy of the tension at the teeth"
    ASKED_BY = "--accuracy"

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        return ()  # a study does not ask for it

    def answers(self) -> Iterator[Answer]:
        remark = "" if self.reached else "NOT reached: no finer mesh is taken"
        for one in super().answers():
            yield replace(one, limit=self.asked, remark=remark)
