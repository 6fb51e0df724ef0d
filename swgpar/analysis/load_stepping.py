"""Load stepping: increments in bounded steps, with prediction, cut-back and closing of the
backlash."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from swgpar.analysis.bent_start import bend
from swgpar.analysis.predictor import KnownState, add_change, predict, predict_guided
from swgpar.analysis.snapshot import ProgramState, Snapshot
from swgpar.analysis.step_bounds import steps_needed
from swgpar.analysis.torque_steps import TorqueSteps
from swgpar.errors import ConvergenceError
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.load.load_sequence import load_sequence
from swgpar.load.load_states import LoadState, Stage
from swgpar.log import logger
from swgpar.model.drive_model import DriveModel
from swgpar.model.torques import torques
from swgpar.results.history import OUTPUT_COLUMNS
from swgpar.solve.solve_state import SOFT_PENALTIES, SPREADING_PENALTIES, SolveResult

MAX_KNOWN_STATES = 40
"""States of the rotation that are kept to predict the next ones from."""

MAX_JUMP_ITERATIONS = 60
"""Newton iterations of a solve for the loaded state at once; step by step it takes some 35 in
all."""

MAX_EXTRAPOLATION = 2.0
"""Largest step of a load program that is predicted along the last one, over that one."""

MAX_CLOSING_ROTATIONS = 10
"""Rotations in which a backlash is closed: each leaves about an eighth of it, by the pressure
angle."""


class LoadStepper:
    """Takes the model from one load state to the next.

    Attributes
    ----------
    sequence : load states of the design's run;  load_state : the state reached
    iterations, residual : Newton iterations and last residual of the last increment
    known_states : periodic states that predictions start from
    guides : states at angles of the run on a coarser mesh, interpolated to this one: predictions
    follow their changes
    """

    def __init__(self, model: DriveModel) -> None:
        self.model, self.design = model, model.design
        self.problem, self.solver = model.problem, model.solver
        self.sequence = load_sequence(model.design)
        self.load_state = self.sequence.start
        self.iterations = 0
        self.residual = 0.0
        self.known_states: list[KnownState] = []
        self.guides: list[KnownState] = []
        self._steps = TorqueSteps()
        self._last: ProgramState = None
        self._before: ProgramState = None

    def reset(self) -> None:
        """Go back to the undeformed drive."""
        self.load_state, self.known_states, self.guides = self.sequence.start, [], []
        self._steps = TorqueSteps()
        self._last = self._before = None
        self.problem.x.set(0.0)
        self.problem.resume({})

    def resume_at(self, load_state: LoadState) -> None:
        """Take the model's present x as the state of `load_state`."""
        self.load_state = load_state
        self.known_states = [KnownState(load_state.angle, self.problem.x.copy())]

    def snapshot(self) -> Snapshot:
        """The present state, for `restore`."""
        return Snapshot(
            self.load_state,
            self.residual,
            self.problem.x.copy(),
            self.problem.accepted.copy(),
            tuple(flanks.history.tractions for flanks in self.problem.flanks),
            tuple(self.known_states),
            self._last,
            self._before,
        )

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a state of before; the results of its contacts come with the next solve."""
        self.load_state, self.residual = snapshot.load_state, snapshot.residual
        snapshot.x.copy(self.problem.x)
        snapshot.accepted.copy(self.problem.accepted)
        for flanks, tractions in zip(self.problem.flanks, snapshot.tractions):
            flanks.resume(dict(tractions))
        self.known_states = list(snapshot.known_states)
        self._last, self._before = snapshot.last, snapshot.before

    def advance(self, target: LoadState, *, cut_back: bool = True) -> None:
        """Solve up to `target` in the steps that it needs (`step_bounds`), and in smaller ones
        where Newton's iteration fails.

        cut_back : whether to take these smaller ones

        Raises ConvergenceError after `solver.max_cutbacks` halvings or `solver.iteration_limit`
        iterations of a step; x is then the last converged state.
        """
        self.iterations = 0
        for state in self.steps_to(target):
            self._take_step(state, cut_back=cut_back)

    def steps_to(self, target: LoadState) -> list[LoadState]:
        """The states at the ends of the steps to `target`, itself the last."""
        origin, count = self.origin(target), 1
        if self.design.steps.subdivide:
            friction = self.design.contact.friction > 0.0
            count = steps_needed(origin, target, self.design.kinematics, friction=friction)
        if count > 1:
            logger.info("   in %d steps, so that no tooth passes and no slip begins unseen", count)
        return [self.between(origin, target, k / count) for k in range(1, count + 1)]

    def between(self, origin: LoadState, target: LoadState, share: float) -> LoadState:
        """The state at a share of the way from `origin` to `target`."""
        return origin.interpolate(target, share, self.design.drive.module, self.design.deflection)

    def _take_step(self, target: LoadState, *, cut_back: bool) -> None:
        """Solve a step up to `target`.

        Teeth that are held across a backlash may stick on the wrong flanks. The first load that
        friction does not let through is taken up without it, and then with it.
        """
        takes_up_load = self.load_state.stage == Stage.ENGAGE and target.control == "torque"
        try:
            self._advance(target, cut_back=cut_back)
        except ConvergenceError as error:
            if not takes_up_load or not self.design.contact.friction:
                raise
            logger.info("   %s; the load is taken up without friction first", error)
            self._advance(replace(target, frictionless=True), cut_back=cut_back)
            self._advance(target, cut_back=cut_back)

    def _advance(self, target: LoadState, *, cut_back: bool) -> None:
        settings = self.design.solver
        most = settings.max_cutbacks if cut_back else 0
        origin, x = self.origin(target), self.problem.x
        done, share, cutbacks, spent = 0.0, 1.0, 0, 0
        while done < 1.0:
            saved = x.copy()
            end = min(1.0, done + share)
            state = self.between(origin, target, end)
            result = self._solve(state, settings.iteration_limit - spent)
            spent += result.iterations
            self.iterations += result.iterations
            if result.converged:
                self._take(state, result)
                done = end
                continue
            saved.copy(x)
            cutbacks += 1
            exhausted = spent >= settings.iteration_limit
            if exhausted:
                limit = f"{settings.iteration_limit} Newton iterations of one increment"
                result = replace(result, reason=f"{limit} (solver.iteration_limit)")
            # a state that is its own origin has nothing to halve
            if exhausted or cutbacks > most or origin == target:
                raise self._failure(target, state, result, cutbacks - 1)
            share *= 0.5
            logger.info(
                "   cut back to %.3g of the increment (%s, residual %.1e)",
                share,
                result.reason,
                result.residual,
            )

    def _solve(self, state: LoadState, most: int) -> SolveResult:
        """Solve for `state` from the present x. most : Newton iterations"""
        if not self._takes_up_torque(state):
            return self._solve_from_prediction(state, most)
        saved = self.problem.x.copy()
        spent = 0
        if (held := self._held(state)) is not None:
            self._close_backlash(held)
            result = self.solver.solve(held, max_iterations=most)
            spent = result.iterations
            if not result.converged:
                return result
        self._close_backlash(state)
        result = self._solve_from_prediction(state, max(1, most - spent))
        spent += result.iterations
        if not result.converged and spent < most and not self.problem.touching_pairs():
            logger.info("   the cam holds the torque before flanks meet: the backlash stays open")
            saved.copy(self.problem.x)
            result = self._solve_from_prediction(state, most - spent)
            spent += result.iterations
        return replace(result, iterations=spent)

    def _solve_from_prediction(self, state: LoadState, most: int) -> SolveResult:
        self._predict(state)
        softenings = SOFT_PENALTIES if state.switches_on(self.load_state) else ()
        return self.solver.solve(state, softenings=softenings, max_iterations=most)

    def _held(self, state: LoadState) -> LoadState | None:
        """The same load with the spline held, where contacts alone are to hold it; else None.

        Two backlashes cannot be closed at once: the output meets the held spline, then the ring.
        """
        free = self.problem.supports.spline_ratio is not None and not state.spline_held
        return replace(state, spline_held=True) if free else None

    def origin(self, target: LoadState) -> LoadState:
        """The present load state with what the output has under the control of the target.

        After a cut-back an increment begins with the torque that held the output, or its angle.
        """
        here, problem = self.load_state, self.problem
        if here.control == target.control:
            return here
        if target.control == "torque":
            reactions = problem.supports.reactions(problem.multipliers())
            return replace(here, torque=float(reactions[problem.supports.output_gear]))
        return replace(here, output_rotation=problem.output_rotation())

    def _takes_up_torque(self, state: LoadState) -> bool:
        """Whether other flanks may have to carry: a backlash is to be closed first."""
        here = self.load_state
        if state.control == "rotation" or not state.torque:
            return False
        return here.control == "rotation" or here.torque * state.torque <= 0.0

    def jump(self, target: LoadState) -> None:
        """Solve for `target` from x in one increment, whatever x is; raises ConvergenceError.

        The contacts of a cup are soft at first: its wall keeps it from the bent shape, and where it
        lies on the cam is found over many faces at once.
        """
        self.iterations = 0
        held = self._held(target)
        for state in (target,) if held is None else (held, target):
            if state.control == "torque":
                self._close_backlash(state)
            result = self.solver.solve(
                state,
                softenings=SPREADING_PENALTIES if self.design.has_cup else (),
                max_iterations=MAX_JUMP_ITERATIONS,
            )
            if not result.converged:
                raise self._failure(target, target, result, 0)
            self.iterations += result.iterations
        self._take(target, result)

    def _take(self, state: LoadState, result: SolveResult) -> None:
        before, self.load_state, self.residual = self.load_state, state, result.residual
        if state.stage == Stage.PROGRAM:
            x = self.problem.x.copy()
            self._before, self._last = self._last, (state, x)
            if self.design.stiffness and not self.design.contact.friction:
                self._steps.keep(state, x)
        if state.is_periodic:
            known = (
                self.known_states
                if state.continues_period(before, self.design.kinematics.ratio)
                else []
            )
            self.known_states = [*known, KnownState(state.angle, self.problem.x.copy())][
                -MAX_KNOWN_STATES:
            ]

    @staticmethod
    def _failure(
        target: LoadState, state: LoadState, result: SolveResult, cutbacks: int
    ) -> ConvergenceError:
        return ConvergenceError(
            f"step {target.step} ({target.stage.label}) did not converge at a wave-generator angle "
            f"of {np.degrees(state.angle):.4g} degrees after {cutbacks} cut-backs: "
            f"{result.reason}, residual {result.residual:.1e} of the contact force"
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
            if (
                not state.continues_period(here, self.design.kinematics.ratio)
                and state.control == "rotation"
            ):
                drift = (state.angle - here.angle) / self.design.kinematics.ratio
                self._rotate_output(state.output_rotation - here.output_rotation - drift)
        elif (factor := self._extrapolation(state)) > 0.0 and not self._bends(state, factor):
            (_, older), (_, last) = self._before, self._last
            self.problem.x.axpy(factor, last)
            self.problem.x.axpy(-factor, older)
        elif (known := self._steps.elsewhere([here, state])) is not None:
            partition, fixed = self.model.partition, self.model.fixed_body
            add_change(partition, fixed, known[0], known[1], self.problem.x, state.angle)
        elif state.control == "rotation" and state.output_rotation != here.output_rotation:
            if not self._presses(here):
                self._rotate_output(state.output_rotation - here.output_rotation)
        elif state.stage == here.stage == Stage.DEFLECT:
            # the ring bends in proportion to the travel of the pins, or to the growth of the cam
            first, old, new = (
                s.cam_clearance if s.pin_inset is None else s.pin_inset
                for s in (self.sequence.start, here, state)
            )
            self.problem.x.scale((first - new) / (first - old))

    def _bends(self, state: LoadState, factor: float) -> bool:
        """Whether the straight line to `state` by this share of the last step is a poor guess."""
        return self._steps.bends([self._before[0], self.load_state, state], factor)

    def _presses(self, here: LoadState) -> bool:
        """Whether flanks press under the first rotation of a program: a rotated pattern would press
        them deeper, and the first iteration follows the tangent. Collective."""
        first = self._before is None and (self._last is None or self._last[0] == here)
        return first and self.problem.touching_pairs() > 0

    def hold_output(self) -> None:
        """Hold the output where the present torque has rotated it: the same equilibrium, under a
        prescribed rotation."""
        rotation = self.problem.output_rotation()
        self.load_state = replace(self.load_state, control="rotation", output_rotation=rotation)
        self._before, self._last = None, (self.load_state, self.problem.x.copy())

    def _extrapolation(self, state: LoadState) -> float:
        """Share of the last step of a program that leads to `state`; 0 if other things change.

        It is bounded: contacts that come and go make the state bend off from the line.
        """
        if self._before is None or self._last is None or self._last[0] != self.load_state:
            return 0.0
        older, last = self._before[0], self._last[0]
        if older.angle != last.angle or {older.control, last.control} != {state.control}:
            return 0.0
        name = "torque" if state.control == "torque" else "output_rotation"
        values = [getattr(one, name) for one in (older, last, state)]
        # there may be a backlash between
        if state.control == "torque" and min(values) < 0.0 < max(values):
            return 0.0
        step = values[1] - values[0]
        return min((values[2] - values[1]) / step, MAX_EXTRAPOLATION) if step else 0.0

    def _close_backlash(self, target: LoadState) -> None:
        """Rotate the output until the flanks that are to carry nearly meet.

        The deformed pattern rotates along, past the cam. Newton's steps move the nodes of the
        spline straight ahead, which lifts it off the cam, so that a rotation by a fraction of the
        backlash would take several iterations.
        """
        for _ in range(MAX_CLOSING_ROTATIONS):
            rotation = self.problem.closing_rotation(target)
            if rotation == 0.0:
                break
            self._rotate_output(rotation, alone=target.spline_held)

    def _rotate_output(self, rotation: float, *, alone: bool = False) -> None:
        """Rotate the output in its deformed pattern (rad). alone : without a held spline"""
        x, fixed = self.problem.x, self.model.fixed_body
        resting = {fixed, FLEXIBLE_SPLINE} if alone else {fixed}
        predict(self.model.partition, fixed, [KnownState(0.0, x)], x, 0.0, rotation, resting)

    def _predict_rotation(self, angle: float) -> None:
        """Predict the state at an angle of the wave generator (rad) from the known or present
        ones."""
        x = self.problem.x
        known = self.known_states or [KnownState(self.load_state.angle, x)]
        fixed = self.model.fixed_body
        predict_guided(self.model.partition, fixed, known, self.guides, x, angle)

    def row(self) -> dict[str, float]:
        """The history's row of the present state, without stresses and times; collective."""
        state, problem = self.load_state, self.problem
        torque, u = torques(problem, state), problem.displacement()
        return {
            "step": state.step,
            "wg_angle_deg": float(np.degrees(state.angle)),
            "output_angle_deg": float(np.degrees(problem.output_rotation())),
            "wg_torque_Nmm": torque.wave_generator,
            "tooth_torque_Nmm": torque.teeth[0],
            "output_torque_Nmm": torque.output,
            "torque_balance_Nmm": torque.balance,
            "pairs_in_contact": self.model.copies * problem.touching_pairs(),
            "max_penetration_mm": problem.penetration(),
            "newton_iterations": self.iterations,
            **dict(zip(("ds_tooth_torque_Nmm",), torque.teeth[1:])),
            **dict(zip(OUTPUT_COLUMNS, problem.supports.output_displacement(u))),
        }
