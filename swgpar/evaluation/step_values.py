"""Values of the history at the ends of the steps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from swgpar.answers.answer import (
    Answer,
    AnswerGroup,
    AnswerKind,
    declared_answers,
    evaluation,
    part_answers,
)
from swgpar.design.drive_design import DriveDesign
from swgpar.load.load_states import Stage
from swgpar.results.history import Row, columns_of

STEPS = range(Stage.DEFLECT, Stage.ROTATE + 1)
"""Steps with values of their own; all increments of the rotation count as the last one."""


@evaluation
class StepValues(AnswerGroup):
    """values : by step and column of the history, as in "step1.fs_s1" """

    values: Mapping[str, float] = part_answers(
        *(
            AnswerKind(
                f"step{k}.{column.name}",
                f"{column.label or column.name}, end of step {k}",
                column.unit,
                detail=True,
            )
            for k in STEPS
            for column in (*columns_of("all"), *columns_of("wave generator fixed"))
            if column.name not in ("step", "wall_s")
        )
    )

    TITLE = "ends of the steps"
    IN_PROGRAMS = False

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        kinds = super().kinds(design)
        if design.kinematics.wave_generator_is_fixed:
            return kinds
        left_out = {"input_angle_deg", "input_torque_Nmm"}
        return tuple(kind for kind in kinds if _parts(kind.name)[1] not in left_out)

    def answers(self) -> Iterator[Answer]:
        for kind in declared_answers(StepValues):
            if kind.name in self.values:
                yield kind.answer(self.values[kind.name])


def step_values(rows: Sequence[Row]) -> StepValues:
    """From the rows of history.csv; steps that are left out have no values."""
    last = {min(int(row["step"]), STEPS[-1]): row for row in rows}
    return StepValues(
        values={
            kind.name: float(last[k][name])
            for kind in declared_answers(StepValues)
            for k, name in [_parts(kind.name)]
            if k in last and name in last[k]
        }
    )


def _parts(name: str) -> tuple[int, str]:
    """Step and column of the name of a value."""
    step, _, column = name.partition(".")
    return int(step.removeprefix("step")), column
