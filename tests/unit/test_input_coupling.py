"""Coupling between shaft and cam: what it adds at the output, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from support.stepping import small
from swgpar.errors import InputError
from swgpar.evaluation.input_coupling import coupling_at_output
from swgpar.evaluation.program_results import point_rows
from swgpar.evaluation.stiffness import StiffnessValues, by_position
from swgpar.load.load_sequence import load_sequence, stiffness_program
from swgpar.load.load_states import Stage
from swgpar.rating.planned_runs import LoadCase, plan_runs

TORQUE, CAM_LOCKED = 10.0, 4000.0
"""Largest torque (N·m), and a stiffness (N·m/rad) that is the same at all torques."""

STIFFNESS, PLAY = 30.0, 0.28
"""Of the coupling, N·m/rad and deg."""


def values(layout: str, **coupling: float) -> tuple[StiffnessValues, float]:
    """The stiffness of a drive that is a linear spring, with a coupling at its input, and its
    ratio."""
    keys = {f"input_coupling.{key}": value for key, value in coupling.items()}
    program = {"stiffness.torque": TORQUE, "stiffness.positions": 1, "drive.layout": layout}
    design = small("plane").with_values(program | keys)
    kinematics, sequence = design.kinematics, load_sequence(design)
    direction = kinematics.torque_direction
    history = [
        {
            "step": float(Stage.LOAD + k),
            "wg_angle_deg": 0.0,
            "output_angle_deg": direction * float(np.degrees(point.value / CAM_LOCKED)),
            "output_torque_Nmm": direction * 1000.0 * point.value,
            "wg_torque_Nmm": 0.0,
            "pairs_in_contact": 1.0,
        }
        for k, point in enumerate(sequence.points)
    ]
    rows = point_rows(sequence, history)
    return by_position(stiffness_program(design), rows)[0.0], kinematics.ratio


@pytest.mark.parametrize("layout", ["ring_fixed", "spline_fixed"])
def test_a_coupling_is_in_series_with_the_drive(layout: str) -> None:
    """Stiffnesses by the square of the ratio, play by the ratio; the play turns no chord."""
    before, ratio = values(layout)
    after, _ = values(layout, stiffness=STIFFNESS, play=PLAY)
    assert before.K1 == pytest.approx(CAM_LOCKED) and before.lost_motion > 0.0
    in_series = 1.0 / (1.0 / CAM_LOCKED + 1.0 / (ratio**2 * STIFFNESS))
    assert (after.K1, after.K2, after.K3) == pytest.approx((in_series,) * 3, rel=1e-9)
    play = 60.0 * PLAY / abs(ratio)
    assert after.backlash - before.backlash == pytest.approx(play, rel=1e-9)
    assert after.hysteresis - before.hysteresis == pytest.approx(play, rel=1e-9)
    lost = play + before.lost_motion * CAM_LOCKED / in_series
    assert after.lost_motion == pytest.approx(lost, rel=1e-9)
    rigid, _ = values(layout, play=PLAY)
    assert rigid.K3 == pytest.approx(before.K3) and rigid.backlash == pytest.approx(after.backlash)


def test_answers_and_the_run_of_a_rating() -> None:
    keys = {"input_coupling.stiffness": STIFFNESS, "input_coupling.play": PLAY}
    design = small("plane").with_values({**keys, "rating.rated_torque": 5.0})
    ratio = design.kinematics.ratio
    found = {a.name: a.value for a in coupling_at_output(design.input_coupling, ratio).answers()}
    assert found["input_coupling.stiffness"] == pytest.approx(ratio**2 * STIFFNESS)
    assert found["input_coupling.play"] == pytest.approx(60.0 * PLAY / abs(ratio))
    (run,) = [one for one in plan_runs(design).runs if LoadCase.STIFFNESS in one.cases]
    assert run.design is not None and run.design.input_coupling == design.input_coupling


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (
            {"input_coupling.play": 0.0},
            "input_coupling.stiffness is missing: give it .* or inp",
        ),
        ({"input_coupling.stiffness": 0.0}, "input_coupling.stiffness = 0 is out of range"),
        ({"input_coupling.play": -0.1}, "input_coupling.play = -0.1 is out of range"),
        (
            {"input_coupling.play": 0.1, "drive.layout": "wave_generator_fixed"},
            r"\[input_coupling\] is not available .*wave_generator_fixed",
        ),
    ],
)
def test_what_does_nothing_is_refused(keys: dict[str, float | str], words: str) -> None:
    with pytest.raises(InputError, match=words):
        small("plane").with_values(keys)
