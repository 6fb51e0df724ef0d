"""The run of a drive from its design to the result."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

from swgpar.analysis.accuracy import require_refinable, with_accuracy
from swgpar.analysis.coarse_start import MeshedDrive
from swgpar.analysis.drive_run import DriveRun
from swgpar.analysis.forecast import forecast, reported_memory, require_memory
from swgpar.analysis.identity import RunContent
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.mesh_refinement import choose_mesh
from swgpar.analysis.model_sources import NEW_MODELS, ModelSource
from swgpar.analysis.recorder import FolderRecorder, MemoryRecorder
from swgpar.analysis.saved_state import StartStates
from swgpar.analysis.shortcuts import MESHES, with_shortcuts
from swgpar.checks.remarks import remarks
from swgpar.design.drive_design import DriveDesign
from swgpar.drive_results.drive_data import DriveData
from swgpar.errors import ConvergenceError, SwgparError, TimeLimitError
from swgpar.evaluation.period import require_samples
from swgpar.load.load_sequence import load_sequence
from swgpar.log import logger
from swgpar.meshing import MeshRecipe, load_recipe, require_sections
from swgpar.results.atomic import on_all
from swgpar.results.folder import DRIVE_RESULTS, RECIPE, open_log, prepare
from swgpar.results.lock import releasing
from swgpar.run_options import RunOptions
from swgpar.solve.eigenmodes import require_slepc
from swgpar.solve.time_limit import limited


def _require(design: DriveDesign, recipe: MeshRecipe) -> None:
    """Refuse a recipe or an installation that lacks what the design needs."""
    require_sections(design.drive.model, recipe)
    if design.frequencies is not None:
        require_slepc()


def _recipe(design: DriveDesign, options: RunOptions) -> tuple[MeshRecipe, str]:
    """The mesh recipe of a run and its name: that of the options, or that of the model."""
    if options.recipe is not None:
        return options.recipe, options.recipe_name
    name = MESHES[design.drive.model]
    return load_recipe(name), name


def _prepared(
    design: DriveDesign, recipe: MeshRecipe, options: RunOptions
) -> tuple[DriveDesign, tuple[str, ...]]:
    """The design that a run computes, and what it leaves out."""
    if options.accuracy is not None:
        design = with_accuracy(design, options.accuracy)
    if options.plain:
        return design, ()
    shortcuts = with_shortcuts(design, recipe, levels=options.accuracy is None)
    return shortcuts.design, shortcuts.left_out


def keep_mesh_of(design: DriveDesign, options: RunOptions, models: ModelSource) -> None:
    """The next choice of a mesh begins with that which an earlier run in the folder of the options
    has chosen, as it does after that run; collective."""
    folder, accuracy = options.out, options.accuracy
    if folder is None or accuracy is None:
        return
    recipe, _ = _recipe(design, options)
    chosen = on_all(options.comm, lambda: load_recipe(folder / RECIPE))
    models.keep_mesh(_prepared(design, recipe, options)[0], recipe, accuracy, chosen)


@releasing
def run_drive(
    design: DriveDesign, options: RunOptions, models: ModelSource = NEW_MODELS
) -> DriveData:
    """Run a design; collective. models : where those of all its meshes come from

    Raises
    ------
    InputError, OutputError, ConvergenceError, TimeLimitError
        On all ranks. After the last two everything up to the last converged increment is in the
        folder and can be continued with `options.restart`.
    OutOfMemoryError
        On the rank whose allocation has failed.
    """
    begin = time.perf_counter()
    folder, comm = options.out, options.comm
    recipe, recipe_name = _recipe(design, options)
    _require(design, recipe)
    if options.accuracy is not None:
        require_refinable(design, options.accuracy)
    design, left_out = _prepared(design, recipe, options)
    sequence, said = load_sequence(design), remarks(design)
    require_samples(sequence, [name for name in ("fatigue", "losses") if getattr(design, name)])
    needs = forecast(design, recipe)
    require_memory(needs, design.solver.memory_limit, comm)
    resumed = folder is not None and prepare(
        folder,
        comm,
        DRIVE_RESULTS if options.accuracy is None else (*DRIVE_RESULTS, RECIPE),
        restart=options.restart,
        overwrite=options.overwrite,
        inputs=[*design.files, Path(recipe_name)],
    )
    open_log(folder, comm)
    _log_remarks(said, left_out)
    with reported_memory(needs), limited(design.solver.time_limit):
        kept = StartStates(folder)
        if not options.restart:
            kept.remove(comm)
        elif not resumed:
            way = "begins with its loaded states" if kept.found(comm) else "begins at the start"
            logger.info("%s has no increment to continue: the run %s", folder, way)
        what = RunContent.of(design.decisive_keys, recipe, options.accuracy)
        drive, chosen = MeshedDrive(design, comm, models), None
        if options.accuracy is not None:
            if resumed:
                asked, recipe = recipe, on_all(comm, lambda: load_recipe(folder / RECIPE))
                models.keep_mesh(design, asked, options.accuracy, recipe)
            else:
                first = models.first_mesh(design, recipe, options.accuracy)
                chosen = choose_mesh(drive, first, options.accuracy, kept=kept)
                models.keep_mesh(design, recipe, options.accuracy, chosen.model.recipe)
        model = models.take(design, recipe, comm) if chosen is None else chosen.model
        stepper = LoadStepper(model)
        recorder = (
            MemoryRecorder(stepper) if folder is None else FolderRecorder(stepper, folder, what)
        )
        try:
            if chosen is not None:
                recorder.keep_choice(chosen, options.accuracy)
            run = DriveRun(recorder, drive, kept, options, begin)
            run.go_through(run.resume() if resumed else run.start())
            result = run.finish(recipe_name)
        except SwgparError as error:
            # collective: all ranks have this error, but perhaps not one of another kind
            models.drop(model)
            saved = len(recorder.record.rows) if folder is not None else 0
            if not saved or not isinstance(error, (ConvergenceError, TimeLimitError)):
                raise
            raise type(error)(f"{error}; {saved} increments are saved in {folder}") from None
        models.give_back(model)
    return result


def _log_remarks(remarks: Sequence[str], left_out: Sequence[str]) -> None:
    """Say what the run leaves out, and what of the design may not be meant.

    remarks : about the design
    """
    for remark in remarks:
        logger.warning("%s", remark)
    if left_out:
        logger.info("left out: %s; --plain computes all of it", ", ".join(left_out))
