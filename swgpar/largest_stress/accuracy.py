"""Accuracy that was asked for, and that a run has reached."""

from __future__ import annotations

from collections.abc import Mapping

from swgpar.answers.answer import NO_ESTIMATE, AnswerGroup, AnswerKind, answer, evaluation
from swgpar.design.drive_design import DriveDesign


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
        remark="remark",
        limit="asked",
    )
    reached: bool

    TITLE = "accuracy of the tension at the teeth"
    ASKED_BY = "--accuracy"

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        return ()  # a study does not ask for it

    def reasons(self) -> Mapping[str, str]:
        return {"accuracy.estimated": f"{NO_ESTIMATE}; {self.remark}"}

    @property
    def remark(self) -> str:
        """What to know of the estimate."""
        return "" if self.reached else "NOT reached: no finer mesh is taken"
