"""Shares of the bearing in the compliance of the loaded drive.

The displacement x by a unit of load solves K x = f with the tangent K. The compliance is f . x =
sum x . K_i x over the parts of the model, so that each part has its share. K_i x is the difference
of the part's forces along x.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from mpi4py import MPI

from swgpar.contact.contact import largest
from swgpar.evaluation.bearing_loads import ComplianceShares
from swgpar.fem.body import OUTER_RACE
from swgpar.fem.vectors import create_vector
from swgpar.load.load_states import LoadState
from swgpar.model.drive_model import DriveModel
from swgpar.petsc import PETSc

STEP = 1e-6
"""Largest displacement (mm) of the differences, and change of the cam's size: far below the
approach of balls."""


def bearing_shares(model: DriveModel, state: LoadState) -> dict[str, ComplianceShares]:
    """Shares in the torsional compliance (against the torque) and in the radial one (against growth
    of the cam).

    None of them without a torque, which leaves the output's position open. Collective.

    model, state : the drive in its equilibrium under that load state
    """
    if state.control != "torque":
        return {}
    problem, system = model.problem, model.solver.system
    u, balls = problem.displacement(), problem.wave_generator.balls
    model.solver.factorise_tangent(state)

    def race_forces(u: np.ndarray) -> np.ndarray:
        forces = np.zeros_like(u)
        for part in problem.elements.bodies[OUTER_RACE].assembled:
            part.assemble(u, forces)
        return forces

    def ball_forces(u: np.ndarray, growth: float) -> tuple[np.ndarray, float]:
        """Forces on the race, and the sum of the balls' loads on this rank."""
        forces = np.zeros_like(u)
        balls.evaluate(u, replace(state, cam_clearance=state.cam_clearance - growth), forces, None)
        return forces, float(balls.owned_forces().sum())

    own = slice(0, model.partition.n_own)

    def shares(right: PETSc.Vec, growth: float) -> ComplianceShares:
        """Shares in the answer to a load, or to the cam's growth of so many mm for each unit of
        it."""
        x = create_vector(model.partition)
        system.solve_with_factor(right, x)
        field = problem.displacement(x)
        unit = STEP / max(largest(model.comm, float(np.abs(field).max(initial=0.0))), growth)
        ahead, behind = (ball_forces(u + t * field, t * growth) for t in (unit, -unit))
        race = race_forces(u + unit * field) - race_forces(u - unit * field)
        sums = [
            np.sum((ahead[0] - behind[0])[own] * field[own]),
            ahead[1] - behind[1],
            np.sum(race[own] * field[own]),
        ]
        on_race, pushed, bent = model.comm.allreduce(np.array(sums), op=MPI.SUM) / (2.0 * unit)
        # the balls take the work of the cam's growth less what they pass on to the race
        total = growth * pushed if growth else right.dot(x)
        x.destroy()
        return ComplianceShares((on_race + growth * pushed) / total, bent / total)

    pushed = create_vector(model.partition)
    change = ball_forces(u, -STEP)[0] - ball_forces(u, STEP)[0]
    pushed.array.reshape(-1, 3)[: model.partition.n_own] = change[own] / (2.0 * STEP)
    found = {"torsional": shares(system.border[-1], 0.0), "radial": shares(pushed, 1.0)}
    pushed.destroy()
    balls.evaluate(u, state, None, None)
    return found
