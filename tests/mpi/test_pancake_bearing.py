"""The small pancake drive on a flexible bearing in the middle of its face width."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI
from pytest_mpi import parallel_assert

import swgpar
from support.bearing import BEARING
from support.pancake import loaded_pancake, pancake
from support.paths import RECIPE
from support.stepping import assert_agree
from swgpar.evaluation.bearing_loads import ball_rows

NAMES = ("fs_s1", "ds_s1", "rg_vm", "output_angle_deg", "wg_torque_Nmm")

TORQUE = 1000.0
"""Of the output, N mm."""


@pytest.mark.parallel([1, 2])
def test_same_on_any_ranks_and_on_half_of_the_drive() -> None:
    first = "wave_generator.bearing.first_ball=4.0"
    stepper, values = loaded_pancake(pancake(*BEARING, first))
    loads = [ball["load_N"] for ball in ball_rows(stepper.model, stepper.load_state, 1, 3)]
    stepper.model.destroy()
    whole, other = loaded_pancake(
        pancake(*BEARING, first, "solver.symmetry=false"), comm=MPI.COMM_SELF
    )
    expected = [ball["load_N"] for ball in ball_rows(whole.model, whole.load_state, 1, 3)]
    parallel_assert(min(loads) > 0.0 and np.allclose(loads, expected, rtol=0.0, atol=1e-3))
    assert_agree(values, other, NAMES, rel=1e-5)
    parallel_assert(values["torque_balance_Nmm"] < 1e-4 * TORQUE)
    parallel_assert(values["ds_tooth_torque_Nmm"] == pytest.approx(TORQUE, rel=1e-4))
    whole.model.destroy()


@pytest.mark.parametrize(("layout", "ratio"), [("ring_fixed", 20.0), ("spline_fixed", 21.0)])
def test_the_mean_input_torque_is_that_of_the_energy(layout: str, ratio: float) -> None:
    """Balls and teeth repeat together after many turns; 4 angles of a pitch leave 1.5 %, and 8
    less."""
    keys = (f"drive.layout={layout}", "steps.samples=4", "steps.rotation=9")
    design = pancake(*BEARING, *keys)
    found = swgpar.run(design, RECIPE, progress=False).summary
    assert found["rotation.expected_wg_torque"].value == pytest.approx(TORQUE / ratio)
    assert found["mean.wg_torque_Nmm"].value == pytest.approx(TORQUE / ratio, rel=0.025)


def test_windows_fatigue_and_stiffness() -> None:
    """Windows and fatigue refer to the stresses of the drive; a bearing makes it softer."""
    usual = ("output.root_stress=true", "steps.samples=4", "steps.rotation=9")
    design = pancake(*BEARING, *usual, "fatigue.tensile_strength=1200")
    found = swgpar.run(design, RECIPE, progress=False).summary
    _, values = loaded_pancake(pancake(*BEARING))
    assert found["root.s1_on_mesh"].value == pytest.approx(values["fs_s1"], rel=1e-4)
    assert found["root.s1"].value > found["root.s1_on_mesh"].value
    extremes = found["fatigue.amplitude"].value + found["fatigue.mean"].value
    assert extremes == pytest.approx(found["root.s1"].value, rel=0.03)
    loop = swgpar.run(
        pancake(*BEARING, "steps.rotation=0", "stiffness.positions=1"), RECIPE, progress=False
    ).summary
    rigid = swgpar.run(
        pancake("steps.rotation=0", "stiffness.positions=1"), RECIPE, progress=False
    ).summary
    assert 0.0 < loop["stiffness.K2"].value < rigid["stiffness.K2"].value
