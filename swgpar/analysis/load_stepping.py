"""Load stepping: one increment after the other, with prediction, cut-back and closing of the backlash."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from swgpar.analysis.bent_start import bend
from swgpar.analysis.drive_model import DriveModel
from swgpar.analysis.predictor import KnownState, predict
from swgpar.analysis.torques import torques
from swgpar.design.load_states import LoadState, Stage, start_state
from swgpar.errors import ConvergenceError
from swgpar.log import logger
from swgpar.solve.solve_state import SolveResult

MAX_KNOWN_STATES = 40
"""States of the rotation that are kept to predict the next ones from."""

MAX_JUMP_ITERATIONS = 60
"""Newton iterations of a solve for the loaded state at once; step by step it takes some 35 in all."""

MAX_CLOSING_ROTATIONS = 10
"""Rotations in which a backlash is closed: each leaves about an eighth of it, by the pressure angle."""


class LoadStepper:
    """Takes the model from one load state to the next.

    Parameters
    ----------
    model : the drive

    Attributes
    ----------
    load_state : the state reached;  iterations, residual : Newton iterations and last residual of the last increment
    known_states : periodic states that predictions start from
    """

    def __init__(self, model: DriveModel) -> None:
        self.model, self.design = model, model.design
        self.problem, self.solver = model.problem, model.solver
        self.load_state = start_state(model.design)
        self.iterations = 0
        self.residual = 0.0
        self.known_states: list[KnownState] = []

    def reset(self) -> None:
        """Go back to the undeformed drive."""
        self.load_state, self.known_states = start_state(self.design), []
        self.problem.x.set(0.0)
        self.problem.resume({})

    def resume_at(self, load_state: LoadState) -> None:
        """Take the model's present x as the state of `load_state`."""
        self.load_state = load_state
        self.known_states = [KnownState(load_state.angle, self.problem.x.copy())]

    def advance(self, target: LoadState) -> None:
        """Solve up to `target`, with smaller steps where Newton's iteration fails.

        Raises ConvergenceError after `solver.max_cutbacks` halvings; x is then the last converged state.
        """
        self.iterations = 0
        origin, x = self.load_state, self.problem.x
        if origin.control == "rotation" and target.control == "torque":
            # after a cut-back the increment begins with the torque that held the output
            reactions = self.problem.supports.reactions(self.problem.multipliers())
            origin = replace(origin, torque=float(reactions[-1]))
            self._close_backlash(target)
        done, share, cutbacks = 0.0, 1.0, 0
        while done < 1.0:
            saved = x.copy()
            end = min(1.0, done + share)
            state = origin.interpolate(target, end, self.design.drive.module, self.design.deflection)
            self._predict(state)
            result = self.solver.solve(state, establish_contact=state.switches_on(self.load_state))
            self.iterations += result.iterations
            if result.converged:
                self._take(state, result)
                done = end
                continue
            saved.copy(x)
            cutbacks += 1
            if cutbacks > self.design.solver.max_cutbacks or origin == target:  # nothing to halve
                raise ConvergenceError(self._failure(target, state, result, cutbacks - 1))
            share *= 0.5
            logger.info(
                "   cut back to %.3g of the increment (%s, residual %.1e)", share, result.reason, result.residual
            )

    def jump(self, target: LoadState) -> None:
        """Solve for `target` from the present x in one increment, whatever it is; raises ConvergenceError."""
        if target.control == "torque":
            self._close_backlash(target)
        result = self.solver.solve(target, max_iterations=MAX_JUMP_ITERATIONS)
        if not result.converged:
            raise ConvergenceError(self._failure(target, target, result, 0))
        self.iterations = result.iterations
        self._take(target, result)

    def _take(self, state: LoadState, result: SolveResult) -> None:
        self.load_state, self.residual = state, result.residual
        if state.is_periodic:
            self.known_states = [*self.known_states, KnownState(state.angle, self.problem.x.copy())]
            self.known_states = self.known_states[-MAX_KNOWN_STATES:]

    @staticmethod
    def _failure(target: LoadState, state: LoadState, result: SolveResult, cutbacks: int) -> str:
        return (
            f"step {target.step} ({target.stage.label}) did not converge at a wave-generator angle of "
            f"{np.degrees(state.angle):.4g} degrees after {cutbacks} cut-backs: {result.reason}, residual "
            f"{result.residual:.1e} of the contact force"
        )

    def _predict(self, state: LoadState) -> None:
        """Set x to a guess of the state."""
        here = self.load_state
        if here.stage == Stage.START and self.design.bearing is not None:
            # nothing but contacts holds the race: they have to act at once
            bend(self.model)
            self.problem.x.scale(1.0 - (state.cam_clearance or 0.0) / (here.cam_clearance or 1.0))
            return
        if state.angle != here.angle:
            self._predict_rotation(state.angle)
        elif state.control == "rotation" and state.output_rotation != here.output_rotation:
            self._rotate_output(state.output_rotation - here.output_rotation)
        elif state.stage == here.stage == Stage.DEFLECT:
            # the ring bends in proportion to the travel of the pins, or to the growth of the cam
            first, old, new = (
                s.cam_clearance if s.pin_inset is None else s.pin_inset for s in (start_state(self.design), here, state)
            )
            self.problem.x.scale((first - new) / (first - old))

    def _close_backlash(self, target: LoadState) -> None:
        """Rotate the output until the flanks that are to carry nearly meet.

        The deformed pattern rotates along, past the cam. Newton's steps move the nodes of the spline straight ahead,
        which lifts it off the cam, so that a rotation by a fraction of the backlash would take several iterations.
        """
        for _ in range(MAX_CLOSING_ROTATIONS):
            rotation = self.problem.closing_rotation(target)
            if rotation == 0.0:
                break
            self._rotate_output(rotation)

    def _rotate_output(self, rotation: float) -> None:
        """Rotate the output in its deformed pattern (rad)."""
        x = self.problem.x
        predict(self.model.partition, self.model.fixed_body, [KnownState(0.0, x)], x, 0.0, rotation)

    def _predict_rotation(self, angle: float) -> None:
        """Predict the state at an angle of the wave generator (rad) from the known states, or from the present one."""
        x = self.problem.x
        known = self.known_states or [KnownState(self.load_state.angle, x)]
        predict(self.model.partition, self.model.fixed_body, known, x, angle)

    def row(self) -> dict[str, float]:
        """The history's row of the present state, without stresses and times; collective."""
        state, problem = self.load_state, self.problem
        torque = torques(problem, state)
        return {
            "step": state.step,
            "wg_angle_deg": float(np.degrees(state.angle)),
            "output_angle_deg": float(np.degrees(problem.output_rotation())),
            "wg_torque_Nmm": torque.wave_generator,
            "tooth_torque_Nmm": torque.teeth,
            "output_torque_Nmm": torque.output,
            "torque_balance_Nmm": torque.balance,
            "pairs_in_contact": self.model.copies * problem.touching_pairs(),
            "max_penetration_mm": problem.penetration(),
            "newton_iterations": self.iterations,
        }
