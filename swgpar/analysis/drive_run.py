"""One run on its mesh: start or restart, increments with what is resolved at each, evaluation."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence

import numpy as np

from swgpar.analysis.coarse_period import coarse_period
from swgpar.analysis.coarse_start import MeshedDrive, start_at_load
from swgpar.analysis.coarse_wall import coarse_wall
from swgpar.analysis.compare_meshes import compare_meshes
from swgpar.analysis.drive_mesh_error import (
    CoarserMesh,
    MeshComparison,
    coarser_mesh,
    coarser_recipe,
)
from swgpar.analysis.evaluate_run import evaluate_run
from swgpar.analysis.follow_turns import follow_turns
from swgpar.analysis.recorder import FolderRecorder, Recorder
from swgpar.analysis.saved_state import StartStates
from swgpar.analysis.step_control import StepControl
from swgpar.analysis.stiffness_error import stiffness_error
from swgpar.drive_results.drive_data import DriveData
from swgpar.errors import ConvergenceError, InputError
from swgpar.evaluation.period import continued
from swgpar.evaluation.result_frame import history_rows
from swgpar.evaluation.transmission_error import period_rows
from swgpar.largest_stress.root_stress import RootStress, resolve_root_stress, with_angle
from swgpar.largest_stress.wall_stress import WallStress, resolve_wall
from swgpar.load.load_states import LoadState, Stage
from swgpar.log import IncrementProgress, logger, ranks_text
from swgpar.meshing.recipe_counts import body_ratio
from swgpar.model.drive_model import DriveModel
from swgpar.petsc import warn_of_unused_options
from swgpar.run_options import RunOptions


class DriveRun:
    """One run on its mesh: start or restart, all increments, end.

    drive : on this mesh and on others
    kept : loaded states on the meshes of the start
    begin : time.perf_counter() at the run's start
    """

    def __init__(
        self,
        recorder: Recorder,
        drive: MeshedDrive,
        kept: StartStates,
        options: RunOptions,
        begin: float,
    ) -> None:
        self.recorder, self.stepper, self.model = recorder, recorder.stepper, recorder.model
        self.drive, self.kept, self.options, self.begin = drive, kept, options, begin
        self.earlier_seconds, self.ended_early = 0.0, False
        self.coarser: CoarserMesh | None = None
        self._tried_coarser = False
        self.comparison: MeshComparison | None = None
        counts = self.model.counts()
        logger.info(
            "%d elements, %d nodes in the whole drive; %d unknowns modelled%s; %s",
            self.model.n_elements(),
            sum(b["nodes_whole"] for b in counts.values()),
            sum(b["dofs"] for b in counts.values()),
            self.model.part_remark,
            ranks_text(self.model.comm.size),
        )
        recorder.begin()

    @property
    def seconds(self) -> float:
        """Wall seconds of the run, restarts included."""
        return self.earlier_seconds + time.perf_counter() - self.begin

    def resume(self) -> Sequence[LoadState]:
        """Bring back the state of the checkpoint; returns all increments of the run."""
        assert isinstance(self.recorder, FolderRecorder)  # a run in memory leaves no checkpoint
        states, self.earlier_seconds = self.recorder.resume()
        record = self.recorder.record
        logger.info("restarted after increment %d", len(record.rows))
        if self.model.design.resolves_root_stress and not record.root_stress:
            logger.info(
                "the stress at the teeth is resolved only by the run that computes the loaded state"
            )
        return states

    def start(self) -> Sequence[LoadState]:
        """Reach the loaded state at once if the design asks for it; returns all increments."""
        record, sequence = self.recorder.record, self.stepper.sequence
        if record.accuracy is not None:  # the model was loaded when its mesh was chosen
            self.stepper.resume_at(sequence.loaded)
            return sequence.from_loaded
        record.starts_loaded = start_at_load(self.stepper, self.drive, self._keep_coarse, self.kept)
        return sequence.from_loaded if record.starts_loaded else sequence.states

    def _keep_coarse(self, model: DriveModel) -> None:
        """Keep what the coarser mesh gives that this one is compared with."""
        self._tried_coarser = True
        loaded, record = self.stepper.sequence.loaded, self.recorder.record
        record.coarse_wall = coarse_wall(model, loaded, self.model.recipe)
        if model.design.compares_meshes:
            model.take_over_windows(self.model)
            windows = model.design.resolves_root_stress
            try:
                self.coarser = coarser_mesh(model, loaded, windows=windows)
            except (ConvergenceError, InputError) as error:
                logger.info("the error by the mesh of the drive is not known: %s", error)
            self.model.take_over_windows(model)
        if body_ratio(model.recipe, self.model.recipe) is not None:
            record.coarse_period = coarse_period(model, self.stepper)

    def _load_coarser(self) -> None:
        """Load the drive on the coarser mesh in the steps of the run, where it did not start on
        it."""
        recipe = coarser_recipe(self.model.recipe)
        if recipe is None:
            return
        self._tried_coarser = True
        try:
            model = self.drive.load(recipe)
        except (ConvergenceError, InputError) as error:
            logger.info("the error by the mesh of the drive is not known: %s", error)
            return
        try:
            self._keep_coarse(model)
        finally:
            self.drive.models.give_back(model)

    def go_through(self, states: Sequence[LoadState]) -> None:
        """Compute and record the increments that are left."""
        stepper, recorder, terminal = self.stepper, self.recorder, self.options.terminal
        record = recorder.record
        steps = StepControl(stepper, record.torque_points, record.slip_checks)
        loaded = next((state for state in reversed(states) if state.stage == Stage.LOAD), None)
        with IncrementProgress(
            self.model.comm, len(states), done=len(record.rows), terminal=terminal
        ) as progress:
            self.model.solver.monitor = lambda state, its, ratio: progress.newton(
                state.stage.label, np.degrees(state.angle), its, ratio
            )
            for state in states[len(record.rows) :]:
                if steps.has_ended() or self.ended_early:
                    break
                if state != stepper.load_state and steps.has_passed(state):
                    continue
                start = time.perf_counter()
                # a start at once ends with the first one
                if state != stepper.load_state and not self._advance(steps, state):
                    break
                seconds = time.perf_counter() - start
                if state == loaded:
                    self.drive.models.keep_loaded(stepper)
                    self._compare(state)
                record.root_stress = self._root_stress(state, state == loaded)
                if state == loaded:
                    record.wall_stress = self._wall_stress(state)
                recorder.keep(seconds, self.seconds)
                if len(record.rows) == 1:
                    self.kept.remove(self.model.comm)
                angle = float(np.degrees(state.angle))
                progress.increment(
                    state.stage.label, angle, stepper.iterations, stepper.residual, seconds
                )
                self.options.on_increment()
                if terminal:
                    warn_of_unused_options()

    def _advance(self, steps: StepControl, state: LoadState) -> bool:
        """Compute an increment, or its part up to where the rotated output has no equilibrium;
        False where nothing of it has one."""
        before = self.stepper.load_state
        try:
            steps.advance(state)
        except ConvergenceError as error:
            rotated = self.model.design.ratcheting is not None and state.stage == Stage.PROGRAM
            starts = rotated and state.control == "torque"
            if not starts and not (rotated and self.recorder.record.torque_points):
                raise
            if starts:
                logger.warning(
                    "the rotation of the output begins under a smaller torque: %s", error
                )
            else:
                logger.warning("the rotation of the output ends here: %s", error)
                self.ended_early = True
            if self.stepper.load_state == before:
                return starts
            self.stepper.advance(self.stepper.load_state)  # contacts of the last state
        return True

    def _root_stress(self, state: LoadState, loaded: bool) -> RootStress | None:
        """Largest tensile stress at the teeth by windows; the one known before where a window
        cannot be computed, or none is asked for."""
        known, sequence = self.recorder.record.root_stress, self.stepper.sequence
        if not self.model.design.resolves_root_stress:
            return known
        # of two periods the first one settles
        further = sequence.samples and sequence.periods == 1 and state.stage == Stage.ROTATE
        try:
            with self.model.phases("windows"):
                if loaded:
                    return known or self._resolve_loaded(state)
                if known and further:
                    return with_angle(known, self.model, state)
        except (ConvergenceError, InputError) as error:
            angle = np.degrees(state.angle)
            logger.warning(
                "the stress at the teeth is not resolved at %.4g degrees: %s", angle, error
            )
        return known

    def _compare(self, state: LoadState) -> None:
        """Compare contacts and bearing of the loaded state with those on a coarser mesh, where that
        is asked for and not known before."""
        record = self.recorder.record
        # the choice of the mesh has compared the state whose stress is known
        if not self.model.design.compares_meshes or record.root_stress is not None:
            return
        if not self._tried_coarser:
            with self.model.phases("coarser mesh"):
                self._load_coarser()
        if self._tried_coarser and self.coarser is None:
            return
        found = compare_meshes(self.model, state, self.recorder.contacts(), self.coarser)
        record.contact_errors, record.bearing_errors = found.contact_errors, found.bearing_errors
        self.comparison = found

    def _resolve_loaded(self, state: LoadState) -> RootStress:
        found = resolve_root_stress(self.model, state)
        return found if self.comparison is None else self.comparison.with_errors(found)

    def _wall_stress(self, state: LoadState) -> WallStress | None:
        """Largest stresses of the wall behind the teeth; None where they are not asked for or
        cannot be computed."""
        record = self.recorder.record
        if not self.model.design.resolves_wall:
            return None
        at_teeth = 0.0 if record.root_stress is None else record.root_stress.s1
        try:
            with self.model.phases("windows"):
                return resolve_wall(self.model, state, at_teeth, record.coarse_wall)
        except (ConvergenceError, InputError) as error:
            logger.warning("the stress of the wall is not resolved: %s", error)
            return None

    def finish(self, recipe_name: str) -> DriveData:
        """Summarise the run."""
        recorder, sequence, rows = self.recorder, self.stepper.sequence, self.recorder.record.rows
        of_stiffness = self._stiffness_error()
        if self.model.design.deviations is not None:
            follow_turns(recorder)
        else:
            recorder.keep_turns(period_rows(sequence, rows))
        if sequence.samples and rows:
            self.drive.models.keep_period(self.stepper)
            rows = continued(sequence, rows)
        rows = history_rows(sequence.kinematics, rows)
        summary, tables = evaluate_run(
            recorder,
            rows,
            recipe_name,
            self.seconds,
            stiffness_error=of_stiffness,
            ended_early=self.ended_early,
        )
        for remark in filter(None, (summary.rotation.jammed, summary.rotation.energy)):
            logger.warning("%s", remark)
        self._log_penetration()
        return recorder.finish(rows, summary, tables)

    def _stiffness_error(self) -> Mapping[str, float] | None:
        """Errors of the torsional stiffness by the mesh; None where they are not asked for or not
        known."""
        section = self.model.design.stiffness
        if section is None or not section.mesh_error:
            return None
        with self.model.phases("coarser mesh"):
            rows = self.recorder.program_rows()
            return stiffness_error(self.drive, self.model.recipe, rows)

    def _log_penetration(self) -> None:
        """Say once how deep cam and pins have got into the flexible spline, where augmentations did
        not bring them within the tolerance."""
        settings, rows = self.model.solver.settings, self.recorder.record.rows
        deepest = max((row["max_penetration_mm"] for row in rows), default=0.0)
        if settings.max_augmentations and deepest > settings.penetration_tolerance:
            logger.warning(
                "cam and pins penetrate by up to %.2g mm, with %d augmentations",
                deepest,
                settings.max_augmentations,
            )
