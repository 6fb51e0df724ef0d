"""A sampled period with a bearing: places of teeth and balls, and what the stated error covers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import swgpar
from support.bearing import BEARING
from support.paths import DESIGN, RECIPE
from support.stepping import assert_agree, load_stepper, rotate, row, small
from support.three_lobes import MODELS
from swgpar.analysis.bent_start import bend
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.bearing_loads import ball_rows
from swgpar.evaluation.rotation import Rotation
from swgpar.load.load_sequence import load_sequence

pytestmark = pytest.mark.parallel(1)

BALLS = "wave_generator.bearing.balls"
FEW, DENSE = 4, 12
NAMES = ("fs_s1", "fs_s3")


def two_lobes(*overrides: str) -> DriveDesign:
    return small("plane", *BEARING, "steps.rotation=9", *overrides)


def three_lobes(*overrides: str) -> DriveDesign:
    keys = (*MODELS["plane"], *BEARING, "wave_generator.C=0.98", "steps.rotation=9")
    return swgpar.load_design(DESIGN, [*keys, f"{BALLS}=21", *overrides])


def test_the_state_after_a_period_is_the_first_one_renamed() -> None:
    """Teeth by one, balls by their passings."""
    design = two_lobes("steps.samples=5")
    passings = design.kinematics.ball_passings(5)
    assert passings % 5 != 0
    stepper = load_stepper(design)
    bend(stepper.model)
    stepper.jump(load_sequence(design).loaded)
    first, before = row(stepper), _loads(stepper)
    for k in range(1, 6):
        last = rotate(stepper, design.kinematics.period_angle * k / 5)
    assert _loads(stepper) == pytest.approx(np.roll(before, -passings), abs=1e-6 * before.max())
    assert np.ptp(before) > 0.1 * before.max()
    assert_agree(last, first, ("fs_s1", "fs_s3", "wg_torque_Nmm"), rel=1e-6)
    stepper.model.destroy()


def means(drive: Callable[..., DriveDesign], samples: int, *overrides: str) -> Rotation:
    """Over a period of so many angles."""
    quick = ("solver.rtol=1e-6", "output.contact_errors=false")
    design = drive(f"steps.samples={samples}", *quick, *overrides)
    assert design.kinematics.states(samples) == samples
    return swgpar.run(design, RECIPE, progress=False).summary.rotation


@pytest.mark.parametrize("drive", [two_lobes, three_lobes])
def test_many_angles_lie_within_the_error_of_few(drive: Callable[..., DriveDesign]) -> None:
    """The means of the stresses over `DENSE` angles, each with another place of teeth and balls."""
    many, few = means(drive, DENSE), means(drive, FEW)
    for name in NAMES:
        print(name, many.means[name], few.means[name], few.sampling_error[name])
        assert abs(many.means[name] - few.means[name]) <= few.sampling_error[name]
        assert few.sampling_error[name] < 0.03 * many.means[name]


def test_balls_that_are_fixed_to_the_cam_have_other_means() -> None:
    """By more than the angles show: all of them have the same place of the balls."""
    passing = means(two_lobes, FEW)
    fixed = means(two_lobes, FEW, "wave_generator.bearing.cage_speed=1")
    apart = abs(passing.means["fs_s1"] - fixed.means["fs_s1"])
    assert apart > 2.0 * fixed.sampling_error["fs_s1"]


def _loads(stepper: LoadStepper) -> np.ndarray:
    """Loads (n,) N of all balls."""
    return np.array([ball["load_N"] for ball in ball_rows(stepper.model, stepper.load_state, 1, 3)])
