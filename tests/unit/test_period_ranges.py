"""Ranges over a period with their errors by the angles and by a coarser mesh."""

from __future__ import annotations

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar.design.kinematics import Kinematics
from swgpar.evaluation.period_ranges import (
    INPUT_TORQUE,
    MISSED,
    CoarsePeriod,
    PeriodRanges,
    period_ranges,
    range_errors,
)
from swgpar.results.history import Row


@pytest.fixture
def kinematics() -> Kinematics:
    return swgpar.load_design(DESIGN, PLANE).kinematics


def rows_of(kinematics: Kinematics, errors: list[float], torques: list[float]) -> list[Row]:
    """Rows with these transmission errors (arc seconds) and torques (N mm)."""
    angles = np.linspace(0.0, 5.0, len(errors), endpoint=False)
    return [
        {
            "wg_angle_deg": angle,
            "output_angle_deg": angle / kinematics.ratio + error / 3600.0,
            INPUT_TORQUE: torque,
        }
        for angle, error, torque in zip(angles, errors, torques, strict=True)
    ]


def test_the_errors_add_what_angles_miss_and_what_the_mesh_changes(kinematics: Kinematics) -> None:
    rows = rows_of(kinematics, [0.0, 4.0, 1.0, -2.0], [30.0, 33.0, 31.0, 29.0])
    every = period_ranges(kinematics, rows, INPUT_TORQUE)
    assert every.transmission_error == pytest.approx(6.0) and every.torque == 4.0
    coarse = CoarsePeriod(PeriodRanges(5.0, 5.5), factor=1.6)
    found = range_errors(kinematics, rows, INPUT_TORQUE, coarse)
    assert found is not None
    # of the first and third angle the ranges are 1 and 1, of the others 6 and 4
    assert found.transmission_error == pytest.approx(MISSED * 5.0 + 1.6 * 1.0)
    assert found.torque == pytest.approx(MISSED * 3.0 + 1.6 * 1.5)


def test_without_a_coarser_mesh_or_with_odd_angles_nothing_is_known(
    kinematics: Kinematics,
) -> None:
    rows = rows_of(kinematics, [0.0, 4.0, 1.0, -2.0], [30.0, 33.0, 31.0, 29.0])
    assert range_errors(kinematics, rows, INPUT_TORQUE, None) is None
    coarse = CoarsePeriod(PeriodRanges(5.0, 5.5), factor=1.6)
    assert range_errors(kinematics, rows[:3], INPUT_TORQUE, coarse) is None


def test_a_run_states_them(kinematics: Kinematics) -> None:
    """On a mesh with a coarser one, over a sampled period. The error of the mean torque is that of
    the energy balance."""
    rotation = 2.0 * float(np.degrees(kinematics.period_angle))
    design = swgpar.load_design(DESIGN, PLANE).with_values(
        {"steps.rotation": rotation, "steps.increment": 1.0, "output.root_stress": True}
    )
    summary = swgpar.run(design, swgpar.load_mesh("plane_coarse"), progress=False).summary
    names = ("rotation.torque_ripple", "rotation.transmission_error", "contact.pressure_off_edges")
    for name in names:
        found = summary[name]
        print(f"{name} {found.value:.4g} ± {found.error:.2g}")
        assert 0.0 < found.error
    assert summary["sharing.largest_force_share"].value == 0.5  # one pair in a lobe
    assert summary["sharing.largest_force"].error is None
    mean = summary["mean.wg_torque_Nmm"]
    expected = summary["rotation.expected_wg_torque"].value
    left = summary["residue.torque"].value
    assert mean.error == pytest.approx(2.0 * abs(mean.value - expected) + left)
    # a mesh without a coarser one: the balance of energy is known all the same
    tiny = swgpar.run(design, swgpar.load_mesh(RECIPE), progress=False).summary
    assert tiny["rotation.torque_ripple"].error is None
    assert tiny["mean.wg_torque_Nmm"].error > 0.0
