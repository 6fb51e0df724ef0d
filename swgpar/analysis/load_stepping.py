"""The load steps: increments with prediction and cut-back, backlash, history rows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from mpi4py import MPI

from swgpar.analysis.drive_model import DriveModel
from swgpar.analysis.predictor import State, predict
from swgpar.analysis.torques import torques
from swgpar.design.load_states import LoadState, start
from swgpar.errors import ConvergenceError
from swgpar.log import logger

LOADED = 3
"""Step from which states repeat with the period."""

MEMORY = 40
"""States of the rotation that are kept to predict the next ones from."""

CLOSING = 10
"""Turns in which a backlash is closed: each leaves some eighth of it, by the pressure angle."""


class LoadStepper:
    """Goes through the sequence, one increment after the other; `row` describes the state reached."""

    def __init__(self, model: DriveModel) -> None:
        self.model, self.design = model, model.design
        self.equilibrium = model.equilibrium
        self.scene = start(model.design)
        self.iterations = 0
        self.residual = 0.0
        self.visited: list[State] = []

    def reset(self) -> None:
        """Go back to the undeformed drive."""
        self.scene, self.visited = start(self.design), []
        self.equilibrium.x.set(0.0)
        self.equilibrium.resume({})

    def take(self, scene: LoadState) -> None:
        """Take the model's present state as that of `scene`."""
        self.scene = scene
        self.visited = [(scene.angle, self.equilibrium.x.copy())]

    def advance(self, target: LoadState) -> None:
        """Solve up to `target`, halving the way when Newton's iteration fails; raises ConvergenceError at the end."""
        origin, x = self.scene, self.equilibrium.x
        if origin.control == "rotation" and target.control == "torque":
            # cut, the way begins with the torque that holds the output
            held = self.equilibrium.holding.reactions(self.equilibrium.multipliers(x))
            origin = replace(origin, torque=float(held[-1]))
            self._close_backlash(target)
        done, share, cuts = 0.0, 1.0, 0
        while done < 1.0:
            saved = x.copy()
            reach = min(1.0, done + share)
            scene = origin.toward(target, reach, self.design.drive.module, self.design.deflection)
            if scene.angle != self.scene.angle:
                self._turn_to(scene.angle)
            elif scene.control == "rotation" and scene.rotation != self.scene.rotation:
                self._slip(scene.rotation - self.scene.rotation)
            elif scene.name == "deflect" and self.scene.name == "deflect":
                # the ring bends in proportion to the travel of the pins, or to the growth of the cam
                first, old, new = (s.cam if s.pins is None else s.pins for s in (start(self.design), self.scene, scene))
                x.scale((first - new) / (first - old))
            contacts = [value is not None for value in (scene.cam, scene.pins, scene.teeth)]
            before = [value is not None for value in (self.scene.cam, self.scene.pins, self.scene.teeth)]
            fresh = self.scene.step == 0 or any(new and not old for new, old in zip(contacts, before))
            solved = self.equilibrium.solve(scene, soft=fresh)
            self.iterations += solved.iterations
            if solved.converged:
                self.scene, self.residual, done = scene, solved.residual, reach
                if target.step >= LOADED:
                    self.visited = [*self.visited, (scene.angle, x.copy())][-MEMORY:]
                continue
            saved.copy(x)
            cuts += 1
            if cuts > self.design.solver.max_cutbacks or origin == target:  # nothing to halve
                raise ConvergenceError(
                    f"step {target.step} ({target.name}) did not converge at a wave-generator angle of "
                    f"{np.degrees(scene.angle):.4g} degrees after {cuts - 1} cut-backs: {solved.reason}, residual "
                    f"{solved.residual:.1e} of the contact force"
                )
            share *= 0.5
            logger.info(
                "   cut back to %.3g of the increment (%s, residual %.1e)", share, solved.reason, solved.residual
            )

    def _close_backlash(self, target: LoadState) -> None:
        """Turn the output until the flanks that are to carry nearly meet.

        The drive's pattern turns along, past the cam: Newton's steps turn the spline straight ahead, which lifts it off
        the cam, so that a turn by a fraction of the backlash costs them several iterations.
        """
        for _ in range(CLOSING):
            turn = self.equilibrium.closing_turn(target)
            if turn == 0.0:
                break
            self._slip(turn)

    def _slip(self, turn: float) -> None:
        """Turn the output in its pattern (rad)."""
        x = self.equilibrium.x
        predict(self.model.partition, self.model.fixed_body, [(0.0, x)], x, 0.0, turn)

    def _turn_to(self, angle: float) -> None:
        """Predict the state at a cam angle (rad) from those visited, or from the present one."""
        x = self.equilibrium.x
        predict(self.model.partition, self.model.fixed_body, self.visited or [(self.scene.angle, x)], x, angle)

    def increment(self, target: LoadState) -> None:
        """Do one entry of the sequence."""
        self.iterations = 0
        self.advance(target)

    def row(self) -> dict[str, float]:
        """The history row of the present state, without stresses and times."""
        equilibrium, copies = self.equilibrium, self.model.copies
        torque = torques(equilibrium)
        pairs = (
            self.model.comm.allreduce(equilibrium.teeth.touching_pairs(), op=MPI.SUM)
            if self.scene.teeth is not None
            else 0
        )
        return {
            "step": self.scene.step,
            "wg_angle_deg": float(np.degrees(self.scene.angle)),
            "output_angle_deg": float(np.degrees(equilibrium.rotation())),
            "wg_torque_Nmm": torque["wg"],
            "tooth_torque_Nmm": torque["teeth"],
            "output_torque_Nmm": torque["output"],
            "torque_balance_Nmm": torque["balance"],
            "pairs_in_contact": copies * pairs,
            "max_penetration_mm": equilibrium.penetration(),
            "newton_iterations": self.iterations,
        }
