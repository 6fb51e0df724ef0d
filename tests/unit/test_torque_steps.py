"""Steps of the torque at other angles of the wave generator as a guess of the present one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from mpi4py import MPI

from swgpar.analysis.torque_steps import BEND, TorqueSteps
from swgpar.load.load_states import LoadState, Stage
from swgpar.petsc import PETSc

LOAD = LoadState(Stage.PROGRAM, 3, control="torque", torque=100.0)
ELSEWHERE = 0.02
"""rad"""


def vector(*values: float) -> PETSc.Vec:
    return PETSc.Vec().createWithArray(np.array(values), comm=MPI.COMM_SELF)


def steps(*known: tuple[float, float, float]) -> TorqueSteps:
    """States at angles (rad) under torques, each of one value."""
    found = TorqueSteps()
    for angle, torque, value in known:
        found.keep(replace(LOAD, angle=angle, torque=torque), vector(value))
    return found


def under(*torques: float, angle: float = 0.0) -> list[LoadState]:
    return [replace(LOAD, angle=angle, torque=torque) for torque in torques]


def test_states_are_found_under_the_same_torques_at_other_angles() -> None:
    known = steps(
        (ELSEWHERE, 100.0, 1.0), (ELSEWHERE, 50.0, 2.0), (2 * ELSEWHERE, 50.0, 3.0), (0.0, 50.0, 4)
    )
    (at_100,), (at_50,) = known.elsewhere(under(100.0, 50.0))
    assert (at_100.angle, at_100.x.getArray()[0]) == (ELSEWHERE, 1.0)
    assert (at_50.angle, at_50.x.getArray()[0]) == (ELSEWHERE, 2.0)
    assert known.elsewhere(under(100.0, 60.0)) is None
    assert known.elsewhere(under(100.0, -50.0)) is None
    held = replace(LOAD, control="rotation", torque=50.0)
    assert known.elsewhere([LOAD, held]) is None
    assert known.elsewhere([*under(100.0), *under(50.0, angle=0.01)]) is None


def test_a_line_that_misses_the_step_elsewhere_is_left() -> None:
    """The line through 0 and 1 is at 3 after a step of 2."""
    for end, bends in ((3.0, False), (3.0 + 1.9 * BEND, False), (3.0 + 4.0 * BEND, True)):
        known = steps((ELSEWHERE, 10.0, 0.0), (ELSEWHERE, 20.0, 1.0), (ELSEWHERE, 40.0, end))
        assert known.bends(under(10.0, 20.0, 40.0), 2.0) is bends
    assert not known.bends(under(10.0, 20.0, 30.0), 1.0)
