"""Torques of the drive at a converged state."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from swgpar.contact.rigid_surface import CamPose
from swgpar.fem.body_layout import FLEXIBLE_SPLINE
from swgpar.solve.newton import NewtonSolver


def torques(equilibrium: NewtonSolver) -> dict[str, float]:
    """Torques about z (N mm): wave generator (and pins) and teeth on the flexible spline, load on the output.

    "balance" is what is left of the largest sum that should vanish, over the bodies that are free to turn.
    """
    u, scene, partition = equilibrium.displacement(), equilibrium.scene, equilibrium.partition
    body = equilibrium.elements.bodies[FLEXIBLE_SPLINE]
    rigid, teeth = np.zeros_like(u), np.zeros_like(u)
    if scene.cam is not None:
        equilibrium.rigid.evaluate(u, CamPose(scene.angle, scene.cam), rigid, None, owned_only=True)
    if scene.pins is not None:
        equilibrium.pins.evaluate(u, CamPose(scene.angle, inset=scene.pins), rigid, None, owned_only=True)
    if scene.teeth is not None:
        teeth = equilibrium.teeth.owned_forces(u, scene.teeth)
    spline = np.zeros(len(u), dtype=bool)
    spline[body.local[body.local >= 0]] = True
    x = equilibrium.positions() + u

    def moment(residual: np.ndarray) -> float:
        r = residual[spline]
        local = -float(np.sum(x[spline, 0] * r[:, 1] - x[spline, 1] * r[:, 0]))
        return partition.comm.allreduce(local, op=MPI.SUM) / equilibrium.share

    held = equilibrium.holding.reactions(equilibrium.multipliers(equilibrium.x))
    output = scene.torque if scene.control == "torque" else float(held[-1])
    wg, teeth_torque = moment(rigid), moment(teeth)
    if len(held) == 1:
        balance = abs(wg + teeth_torque + output)
    else:
        balance = max(abs(wg + teeth_torque + float(held[0])), abs(output - teeth_torque))
    return {"wg": wg, "teeth": teeth_torque, "output": output, "balance": balance}
