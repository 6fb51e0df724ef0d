"""Limits of time and iterations: a run ends on all ranks with what was tried, and can be
continued."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

import swgpar
from support.paths import DESIGN, RECIPE
from support.small_drive import NO_SHORTCUTS, PLANE, SHORT
from swgpar.errors import ConvergenceError, TimeLimitError
from swgpar.solve.time_limit import ending, limited, stopped_by

COMM = MPI.COMM_WORLD


def design(*more: str, **solver: float) -> swgpar.DriveDesign:
    limits = [f"solver.{key}={value}" for key, value in solver.items()]
    return swgpar.load_design(
        DESIGN, [*PLANE, *SHORT, *NO_SHORTCUTS, "output.figures=false", *more, *limits]
    )


@pytest.mark.parallel([1, 2])
def test_a_time_limit_ends_a_run() -> None:
    words = (
        r"time limit of 1e-06 s \(solver.time_limit\) has passed in step 1 .* after \d+ Newton "
        r"iterations, residual"
    )
    with pytest.raises(TimeLimitError, match=words):
        swgpar.run(design(time_limit=1e-6), RECIPE)
    assert ending(COMM) == ""


@pytest.mark.parallel([1, 2])
def test_a_run_continues_with_another_limit(tmp_path: Path) -> None:
    """The limits do not belong to what is computed. The hardest increment needs an iteration more
    than it may have."""
    folder, bent = COMM.bcast(tmp_path), "steps.bent_start=true"
    whole = swgpar.run(design(bent), RECIPE)
    needed = whole.history["newton_iterations"]
    hardest = 1 + int(np.argmax(needed[1:]))  # the first one is reached at once, without this limit
    limit = int(needed[hardest]) - 1
    words = (
        rf"cut-backs: {limit} Newton iterations of one increment \(solver.iteration_limit\), .*; "
        rf"{hardest} increments"
    )
    with pytest.raises(ConvergenceError, match=words):
        swgpar.run(design(bent, iteration_limit=limit), RECIPE, folder)
    found = swgpar.run(design(bent, time_limit=1e6), RECIPE, folder, restart=True)
    # the input torque is the small difference of torques as large as the teeth's
    scales = {
        "fs_s1": "fs_s1",
        "wg_torque_Nmm": "tooth_torque_Nmm",
        "output_angle_deg": "output_angle_deg",
    }
    for name, scale in scales.items():
        near = 1e-8 * np.abs(whole.history[scale]).max()
        assert found.history[name] == pytest.approx(whole.history[name], rel=0.0, abs=near)


@pytest.mark.parallel([1, 2])
def test_limits_of_time_end_with_their_block() -> None:
    with limited(1e6):
        assert ending(COMM) == ""
        with limited(0.0):
            assert "limit of 0 s" in ending(COMM)
        assert ending(COMM) == ""
    with limited(None), stopped_by(lambda: True):
        assert ending(COMM) == "the run was stopped"
    assert ending(COMM) == ""


@pytest.mark.parallel([1, 2])
def test_a_session_goes_on_after_a_run_that_was_stopped() -> None:
    """It keeps no state of that run."""
    answers = iter([False, False, True])
    stop = lambda: next(answers, False)  # noqa: E731
    with swgpar.Session(stop=stop) as session:
        with pytest.raises(TimeLimitError, match="the run was stopped in step 1"):
            session.run(design(), RECIPE)
        found = session.run(design(), RECIPE)
    alone = swgpar.run(design(), RECIPE)
    assert found.history["fs_s1"] == pytest.approx(alone.history["fs_s1"], rel=1e-9)


def test_the_default_is_far_from_what_drives_need() -> None:
    assert design().solver.iteration_limit == 600 and design().solver.time_limit is None
    with pytest.raises(
        swgpar.InputError, match=r"solver.time_limit = 0(\.0)? is out of range: allowed above 0 to"
    ):
        design(time_limit=0.0)
