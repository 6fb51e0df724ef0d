"""Accuracy that was asked for, and that a run has reached."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.answers import Answer, AnswerGroup, AnswerKind


@dataclass(frozen=True)
class Accuracy(AnswerGroup):
    """Relative accuracy of the largest tensile stress at the teeth under load.

    asked : what was asked for;  estimated : by refinement;  reached : whether the estimate is small
    enough
    """

    asked: float
    estimated: float
    reached: bool

    TITLE = "accuracy of the tension at the teeth"
    ASKED_BY = "--accuracy"
    KINDS = (
        AnswerKind(
            "accuracy.estimated", "estimated relative error of the largest tension at the teeth"
        ),
    )

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        return ()  # a study does not ask for it

    def answers(self) -> Iterator[Answer]:
        remark = "" if self.reached else "NOT reached: no finer mesh is taken"
        for answer in super().answers():
            yield replace(answer, limit=self.asked, remark=remark)
