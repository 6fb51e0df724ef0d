"""The run of a drive on its mesh: start or restart, increments with what is resolved at each,
evaluation."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from swgpar.analysis.coarse_start import start_at_load
from swgpar.analysis.evaluate_run import evaluate_run
from swgpar.analysis.follow_turns import follow_turns
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.mesh_refinement import compared_stresses, drive_error, least_error, size_ratio
from swgpar.analysis.recorder import FolderRecorder, Recorder
from swgpar.analysis.run_record import RunRecord
from swgpar.analysis.start_states import StartStates
from swgpar.analysis.stiffness_error import stiffness_error
from swgpar.drive_results.drive_data import DriveData
from swgpar.errors import ConvergenceError, InputError
from swgpar.evaluation.period import continued
from swgpar.evaluation.place_errors import CoarseStresses
from swgpar.evaluation.places import find_places
from swgpar.evaluation.ratcheting import has_fallen
from swgpar.evaluation.result_frame import history_rows
from swgpar.evaluation.transmission_error import period_rows
from swgpar.evaluation.windows.root_stress import RootStress, resolve_root_stress, with_angle
from swgpar.load.load_sequence import LoadSequence
from swgpar.load.load_states import LoadState, Stage
from swgpar.log import IncrementProgress, logger
from swgpar.meshing import MeshRecipe
from swgpar.model.drive_model import DriveModel
from swgpar.petsc import warn_of_unused_options


class DriveRun:
    """One run: start or restart, all increments, end.

    recipe : of the model's mesh;  sequence : load states of the run;  kept : those on the meshes of
    the start
    begin : time.perf_counter() at the run's start
    """

    def __init__(
        self,
        model: DriveModel,
        recipe: MeshRecipe,
        sequence: LoadSequence,
        recorder: Recorder,
        kept: StartStates,
        on_increment: Callable[[], None],
        begin: float,
    ) -> None:
        self.sequence, self.kept = sequence, kept
        self.model = model
        self.recipe = recipe
        self.recorder = recorder
        self.stepper = LoadStepper(model)
        self.on_increment, self.begin = on_increment, begin
        self.earlier_seconds, self.ended_early = 0.0, False
        self.coarse: tuple[MeshRecipe, Mapping[str, Sequence[float]]] | None = None
        counts = model.counts()
        logger.info(
            "%d elements, %d nodes in the whole drive; %d unknowns modelled%s; %d ranks",
            model.n_elements(),
            sum(b["nodes_whole"] for b in counts.values()),
            sum(b["dofs"] for b in counts.values()),
            model.part_remark,
            model.comm.size,
        )
        recorder.begin()

    @property
    def record(self) -> RunRecord:
        """What is kept of the increments."""
        return self.recorder.record

    @property
    def seconds(self) -> float:
        """Wall seconds of the run, restarts included."""
        return self.earlier_seconds + time.perf_counter() - self.begin

    def resume(self) -> Sequence[LoadState]:
        """Bring back the state of the checkpoint; returns all increments that the run consists
        of."""
        assert isinstance(self.recorder, FolderRecorder)  # a run in memory leaves no checkpoint
        items, self.earlier_seconds = self.recorder.resume(self.stepper)
        logger.info("restarted after increment %d", len(self.record.rows))
        if self.model.design.resolves_root_stress and not self.record.root_stress:
            logger.info(
                "the stress at the teeth is resolved only by the run that computes the loaded state"
            )
        return items

    def start(self) -> Sequence[LoadState]:
        """Reach the loaded state at once if the design asks for it; returns all increments of the
        run."""
        sequence = self.sequence
        if self.record.accuracy is not None:  # the model was loaded when its mesh was chosen
            self.stepper.resume_at(sequence.loaded)
            return sequence.from_loaded
        self.record.starts_loaded = start_at_load(
            self.stepper, self.recipe, sequence, self._keep_coarse, self.kept
        )
        return sequence.from_loaded if self.record.starts_loaded else sequence.states

    def _keep_coarse(self, model: DriveModel, recipe: MeshRecipe) -> None:
        """Keep the largest stresses of a coarser mesh of the drive, to see what the mesh
        changes."""
        loaded = self.sequence.loaded
        places = find_places(model, loaded, model.stresses()[1])
        self.record.coarse = CoarseStresses(places, size_ratio(recipe, self.recipe))
        if model.design.resolves_root_stress:
            try:
                self.coarse = recipe, compared_stresses(model, loaded)
            except (ConvergenceError, InputError) as error:
                logger.info("the error by the mesh of the drive is not known: %s", error)

    def go_through(self, items: Sequence[LoadState], terminal: bool) -> None:
        """Compute and record the increments that are left."""
        stepper, recorder = self.stepper, self.recorder
        loaded = next((item for item in reversed(items) if item.stage == Stage.LOAD), None)
        ratcheting = self.model.design.ratcheting
        with IncrementProgress(
            self.model.comm, len(items), done=len(self.record.rows), terminal=terminal
        ) as progress:
            self.model.solver.monitor = lambda state, its, ratio: progress.newton(
                state.stage.label, np.degrees(state.angle), its, ratio
            )
            for item in items[len(self.record.rows) :]:
                if ratcheting is not None and has_fallen(ratcheting.drop, recorder.program_rows()):
                    break
                start = time.perf_counter()
                if item != stepper.load_state and not self._advance(
                    item
                ):  # a start at once ends with the first one
                    break
                seconds = time.perf_counter() - start
                if self.model.design.resolves_root_stress:
                    self.record.root_stress = self._root_stress(item, item == loaded)
                recorder.keep(stepper, seconds, self.seconds)
                if len(self.record.rows) == 1:
                    self.kept.remove(self.model.comm)
                angle = float(np.degrees(item.angle))
                progress.increment(
                    item.stage.label, angle, stepper.iterations, stepper.residual, seconds
                )
                self.on_increment()
                if terminal:
                    warn_of_unused_options()

    def _advance(self, item: LoadState) -> bool:
        """Compute an increment; False where the output is rotated beyond the strength and finds no
        equilibrium."""
        try:
            self.stepper.advance(item)
            return True
        except ConvergenceError as error:
            if (
                self.model.design.ratcheting is None
                or item.stage != Stage.PROGRAM
                or not self.recorder.program_rows()
            ):
                raise
            logger.warning("the rotation of the output ends here: %s", error)
            self.ended_early = True
            return False

    def _root_stress(self, state: LoadState, loaded: bool) -> RootStress | None:
        """Largest tensile stress at the teeth by windows; the one known before where a window
        cannot be computed."""
        known, sequence = self.record.root_stress, self.sequence
        # of two periods the first one settles
        further = sequence.samples and sequence.periods == 1 and state.stage == Stage.ROTATE
        try:
            with self.model.phases("windows"):
                if loaded:
                    return known or self._resolve_loaded(state)
                return with_angle(known, self.model, state) if known and further else known
        except (ConvergenceError, InputError) as error:
            angle = np.degrees(state.angle)
            logger.warning(
                "the stress at the teeth is not resolved at %.4g degrees: %s", angle, error
            )
            return known

    def _resolve_loaded(self, state: LoadState) -> RootStress:
        found = resolve_root_stress(self.model, state)
        if self.coarse is None:
            return found
        coarse, levels = self.coarse
        least = least_error(self.model, state)
        return replace(
            found, drive_error=drive_error(levels, found, size_ratio(coarse, self.recipe), least)
        )

    def finish(self, recipe_name: str) -> DriveData:
        """Summarise the run."""
        recorder, design, sequence = self.recorder, self.model.design, self.sequence
        rows = self.record.rows
        error = None
        if design.stiffness is not None and design.stiffness.mesh_error:
            with self.model.phases("coarser mesh"):
                error = stiffness_error(
                    design, self.recipe, recorder.program_rows(), self.model.comm
                )
        if design.deviations is not None:
            follow_turns(self.recipe, recorder)
        else:
            recorder.keep_turns(period_rows(sequence, rows))
        if sequence.samples and rows:
            rows = continued(sequence, rows)
        rows = history_rows(sequence.kinematics, rows)
        summary, tables = evaluate_run(
            recorder,
            rows,
            recipe_name,
            self.seconds,
            stiffness_error=error,
            ended_early=self.ended_early,
        )
        if summary.rotation.jammed:
            logger.warning("%s", summary.rotation.jammed)
        return recorder.finish(rows, summary, tables)
