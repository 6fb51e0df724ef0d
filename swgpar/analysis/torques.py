"""Torques of the drive in a converged state."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from swgpar.design.load_states import LoadState
from swgpar.fem.body_layout import FLEXIBLE_SPLINE, OUTER_RACE, RING_GEAR
from swgpar.solve.discrete_problem import DiscreteProblem


@dataclass(frozen=True)
class Torques:
    """Torques about z of the whole drive, N mm.

    wave_generator, teeth : on the flexible spline, of the wave generator with its pins and of the teeth; with a bearing
    on the spline and the outer race together, of the balls
    output : load on the output
    balance : largest sum that should vanish, over the bodies that are free to rotate
    """

    wave_generator: float
    teeth: float
    output: float
    balance: float


def torques(problem: DiscreteProblem, state: LoadState) -> Torques:
    """Torques of the present x, which is in equilibrium under `state`; collective."""
    u, supports, comm = problem.displacement(), problem.supports, problem.partition.comm
    rigid, teeth = np.zeros_like(u), np.zeros_like(u)
    for contact in problem.rigid_contacts:
        contact.add_owned_forces(u, state, rigid)
    if problem.flanks is not None:
        problem.flanks.add_owned_forces(u, state, teeth)
    spline = np.zeros(len(u), dtype=bool)
    bodies = problem.elements.bodies
    for body in (bodies[FLEXIBLE_SPLINE], *bodies[OUTER_RACE:]):  # the race and the spline press on each other
        spline[body.local[body.local >= 0]] = True
    x = problem.positions() + u

    def moment(residual: np.ndarray) -> float:
        r = residual[spline]
        local = -float(np.sum(x[spline, 0] * r[:, 1] - x[spline, 1] * r[:, 0]))
        return comm.allreduce(local, op=MPI.SUM) / supports.share

    reactions = supports.reactions(problem.multipliers())
    if state.control == "torque":
        reactions[supports.output_gear] = state.torque
    wave_generator, tooth, output = moment(rigid), moment(teeth), float(reactions[supports.output_gear])
    balance = abs(wave_generator + tooth + float(reactions[FLEXIBLE_SPLINE]))
    if supports.ring_floats:
        balance = max(balance, abs(float(reactions[RING_GEAR]) - tooth))
    return Torques(wave_generator, tooth, output, balance)
