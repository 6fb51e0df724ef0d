"""Steps with friction: results that do not depend on the increments that are asked for."""

from __future__ import annotations

from typing import Any

import pytest
from pytest_mpi import parallel_assert

from support.paths import RECIPE
from support.stepping import small
from swgpar.analysis.run_drive import run_drive
from swgpar.evaluation.slip_error import SLIP_TOLERANCE
from swgpar.meshing import load_recipe
from swgpar.presentation.drive_result import DriveResult
from swgpar.run_options import RunOptions

ROTATION = 45.0
"""deg, more than five periods"""


def torque(increment: float, friction: float, **more: Any) -> tuple[float, DriveResult]:
    """Input torque (N·mm) of the small plane drive after a rotation, and the whole result."""
    steps = {"steps.rotation": ROTATION, "steps.increment": increment}
    values = {**steps, "contact.friction": friction, **more}
    result = run_drive(small("plane").with_values(values), RunOptions(recipe=load_recipe(RECIPE)))
    return float(result.history["wg_torque_Nmm"][-1]), result


@pytest.mark.parallel([1, 2])
def test_one_increment_has_the_friction_of_many() -> None:
    fine, _ = torque(1.0, 0.1)
    rough, result = torque(ROTATION, 0.1)
    none, _ = torque(ROTATION, 0.0)
    parallel_assert(fine > 1.05 * none, f"{fine} and {none} N·mm")
    parallel_assert(rough == pytest.approx(fine, rel=1e-5), f"{rough} and {fine} N·mm")
    parallel_assert(not result.summary.slip.places, f"{result.summary.slip}")


def test_steps_that_the_user_gives_are_kept_and_judged() -> None:
    """In one step of 45 degrees no point has slip: the torque is that without friction, and the
    change by half the step says how far it is from the truth."""
    none, _ = torque(ROTATION, 0.0)
    fine, _ = torque(1.0, 0.1)
    kept, result = torque(ROTATION, 0.1, **{"steps.subdivide": False})
    slip = result.summary.slip
    assert kept == pytest.approx(none, rel=1e-5)
    assert slip.torque_change_Nmm == pytest.approx(fine - kept, rel=0.1)
    assert result.summary["slip.share"].value > SLIP_TOLERANCE == result.summary["slip.share"].limit
    (remark,) = slip.remarks()
    assert "step 4 at 45°, where 100 % of the flanks" in remark and "not resolved" in remark
