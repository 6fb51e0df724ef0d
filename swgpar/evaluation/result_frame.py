"""Results in the frame of the fixed member.

A drive whose wave generator is fixed is computed in the frame of its ring gear, where it is a drive
with the ring gear fixed: a rigid rotation of the whole drive changes no stress and no torque
(docs/theory/kinematics.md). What a run leaves is rotated back by the angle of the wave generator
against the ring gear, so that the wave generator stands. In the other layouts nothing changes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from swgpar.answers.answer import answer, evaluation
from swgpar.design.kinematics import Kinematics
from swgpar.fem.stress import rotated_tensor
from swgpar.geometry.rotation import rotated
from swgpar.model.drive_model import DriveModel
from swgpar.results.history import Row, column, wrapped


def history_rows(kinematics: Kinematics, rows: Sequence[Row]) -> list[Row]:
    """Rows of history.csv from those in the frame in which the drive is computed.

    With the wave generator fixed they have the ring gear's angle and its torque too: that of the
    teeth on the spline, which is the torque that drives the ring gear. `wg_angle_deg` is the angle
    against the ring gear in all layouts with the flexible spline as the output.
    """
    if not kinematics.wave_generator_is_fixed:
        return list(rows)
    return [
        {
            **row,
            "output_angle_deg": shown_output(
                kinematics, row["wg_angle_deg"], row["output_angle_deg"]
            ),
            "input_angle_deg": kinematics.in_frame_of_result(0.0, row["wg_angle_deg"]),
            "input_torque_Nmm": row["tooth_torque_Nmm"],
        }
        for row in rows
    ]


def shown_output(kinematics: Kinematics, wg_angle: float, output_angle: float) -> float:
    """Angle of the output (degrees), within half a turn, from angles (degrees) in the frame in
    which the drive is computed."""
    return float(wrapped(np.array(kinematics.in_frame_of_result(output_angle, wg_angle))))


def nodal_fields(
    model: DriveModel, angle: float, fields: Mapping[str, dict[str, np.ndarray]]
) -> dict[str, dict[str, np.ndarray]]:
    """Nodal fields of all bodies by name. angle : rad, of the wave generator in the frame of the
    computation

    Displacements go from the undeformed place to that in the frame of the fixed member.
    """
    if not model.design.kinematics.wave_generator_is_fixed:
        return dict(fields)
    found = {}
    for name, body in model.elements.bodies.items():
        values, position = fields[name], body.positions()[body.owned]
        back = np.full((len(position), 1), model.design.kinematics.in_frame_of_result(0.0, angle))
        found[name] = {
            **values,
            "displacement": rotated(position + values["displacement"], back) - position,
            "stress": rotated_tensor(values["stress"], back),
        }
    return found


@evaluation
class InputTorque:
    """Torque of a ring gear that is driven, over the rotation.

    torque_expected_Nmm : T_in theta_in + T_out theta_out = 0
    """

    torque_Nmm: float = answer("input.torque", "torque of the driven ring gear, mean", "N·mm")
    torque_expected_Nmm: float = answer(
        "input.expected_torque", "the same by the energy balance", "N·mm", exact=True
    )


def input_torque(
    kinematics: Kinematics, output_torque: float, rows: Sequence[Row]
) -> InputTorque | None:
    """Over the increments `rows` of the rotation; None where the wave generator drives.

    output_torque : N·m
    """
    if not kinematics.wave_generator_is_fixed or not rows:
        return None
    return InputTorque(
        torque_Nmm=float(column(rows, "tooth_torque_Nmm").mean()),
        torque_expected_Nmm=-kinematics.internal_torque(output_torque) / kinematics.input_ratio,
    )
