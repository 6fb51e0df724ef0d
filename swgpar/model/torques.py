"""Torques of the drive in a converged state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from swgpar.constraints.supports import RING_COUPLING, SPLINE_COUPLING
from swgpar.contact.contact import Contact
from swgpar.fem.body import FLEXIBLE_SPLINE, OUTER_RACE
from swgpar.load.load_states import LoadState
from swgpar.solve.discrete_problem import DiscreteProblem


@dataclass(frozen=True)
class Torques:
    """Torques about z of the whole drive, N mm.

    wave_generator : on the flexible spline, of the wave generator with its pins; with a bearing on
    the spline and the outer race together, of the balls
    teeth : on the flexible spline, of the teeth of each ring gear
    output : load on the output
    balance : largest sum that should vanish, over the bodies that are free to rotate
    """

    wave_generator: float
    teeth: tuple[float, ...]
    output: float
    balance: float


def torques(problem: DiscreteProblem, state: LoadState) -> Torques:
    """Torques of the present x, which is in equilibrium under `state`; collective."""
    u, supports, comm = problem.displacement(), problem.supports, problem.partition.comm
    bodies = problem.elements.bodies
    spline = np.zeros(len(u), dtype=bool)
    # the race and the spline press on each other
    for body in (bodies[name] for name in (FLEXIBLE_SPLINE, OUTER_RACE) if name in bodies):
        spline[body.local[body.local >= 0]] = True
    x = problem.positions() + u

    def moment(contacts: Sequence[Contact]) -> float:
        residual = np.zeros_like(u)
        for contact in contacts:
            contact.add_owned_forces(u, state, residual)
        r = residual[spline]
        local = -float(np.sum(x[spline, 0] * r[:, 1] - x[spline, 1] * r[:, 0]))
        return comm.allreduce(local, op=MPI.SUM) / supports.share

    reactions = supports.reactions(problem.multipliers())
    if state.control == "torque":
        reactions[supports.output_gear] = state.torque
    output = float(reactions[supports.output_gear])
    wave_generator = moment(problem.wave_generator.all)
    teeth = tuple(moment([flanks]) for flanks in problem.flanks)
    reactions[supports.output_gear] += supports.bearing_moment(u)
    balance = abs(wave_generator + sum(teeth) + float(reactions[SPLINE_COUPLING]))
    if supports.ring_floats:
        of_ring = sum(
            torque for flanks, torque in zip(problem.flanks, teeth) if flanks.ring_motion.floats
        )
        balance = max(balance, abs(float(reactions[RING_COUPLING]) - of_ring))
    return Torques(wave_generator, teeth, output, balance)
