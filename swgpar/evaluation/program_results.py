"""Results of load programs: torque and rotation of the output at every point."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from swgpar.answers.answer import (
    NO_ESTIMATE,
    Answer,
    AnswerGroup,
    AnswerKind,
    evaluation,
    part_answers,
)
from swgpar.design.drive_design import DriveDesign
from swgpar.load.load_sequence import LoadSequence
from swgpar.load.load_states import Stage
from swgpar.results.history import Row, wrapped

PointRow = dict[str, Any]
"""Row of program.csv: a value for every column."""

COLUMNS = {
    "step": "",
    "stage": "",
    "wg_angle_deg": "deg",
    "torque_Nm": "N·m",
    "rotation_arcmin": "arc minutes",
    "wg_torque_Nmm": "N·mm",
    "pairs_in_contact": "",
}
"""Columns of program.csv with their units: the torque on the output, positive against its motion,
and the rotation of the output by it, beyond what the ratio makes of the wave generator's angle."""


def point_rows(sequence: LoadSequence, rows: Sequence[Row]) -> list[PointRow]:
    """Rows of program.csv from those of the history. With a coupling between shaft and wave
    generator the angles are those of a locked shaft."""
    points, kinematics, coupling = sequence.points, sequence.kinematics, sequence.coupling
    direction, computed = kinematics.torque_direction, []
    for row in rows:
        index = int(row["step"]) - Stage.LOAD
        if not 0 <= index < len(points):
            continue
        rotation = wrapped(row["output_angle_deg"] - row["wg_angle_deg"] / kinematics.ratio)
        torque = direction * row["output_torque_Nmm"] / 1000.0
        arc_minutes = direction * 60.0 * float(rotation)
        if coupling is not None:
            arc_minutes += 60.0 * float(np.degrees(coupling.rotation(torque, kinematics.ratio)))
        computed.append(
            {
                "step": int(row["step"]),
                "stage": points[index].stage,
                "wg_angle_deg": row["wg_angle_deg"],
                "torque_Nm": torque,
                "rotation_arcmin": arc_minutes,
                "wg_torque_Nmm": row["wg_torque_Nmm"],
                "pairs_in_contact": row["pairs_in_contact"],
            }
        )
    return computed


def work_by_torque(rows: Sequence[PointRow]) -> float:
    """Work (N mm) of the output's torque along the rows, by the trapezoidal rule."""
    torque = 1000.0 * np.array([row["torque_Nm"] for row in rows])
    rotation = np.radians(np.array([row["rotation_arcmin"] for row in rows]) / 60.0)
    return float((0.5 * (torque[1:] + torque[:-1]) * np.diff(rotation)).sum())


@evaluation
class ProgramStages(AnswerGroup):
    """The last point of every stage of a load program.

    stages : by the name of the stage, values by the columns of program.csv, without that of the
    stage
    """

    stages: Mapping[str, Mapping[str, float]] = part_answers(
        *(
            AnswerKind(
                f"program.STAGE.{name}",
                f"{name} at the end of STAGE",
                unit,
                exact=name == "wg_angle_deg",
            )
            for name, unit in COLUMNS.items()
            if name not in ("step", "stage")
        )
    )

    TITLE = "ends of the stages of the load program"
    ASKED_BY = "load.program"

    @classmethod
    def kinds(cls, design: DriveDesign) -> tuple[AnswerKind, ...]:
        return cls.kinds_with("STAGE", (stage.name for stage in design.load.program))

    def answers(self) -> Iterator[Answer]:
        for stage, values in self.stages.items():
            for kind in self.kinds_with("STAGE", (stage,)):
                value = float(values[kind.name.rpartition(".")[2]])
                no_error = "" if kind.exact else NO_ESTIMATE
                yield kind.answer(value, no_error=no_error)


def stage_ends(rows: Sequence[PointRow]) -> ProgramStages:
    """The last point of every stage from the rows of program.csv."""
    return ProgramStages(
        stages={
            row["stage"]: {name: row[name] for name in COLUMNS if name != "stage"} for row in rows
        }
    )
