"""One design from file to results: what `swgpar run` does."""

from __future__ import annotations

import time
from collections.abc import Sequence

from swgpar.analysis.accuracy import require_refinable, with_accuracy
from swgpar.analysis.drive_run import DriveRun
from swgpar.analysis.forecast import forecast, reported_memory, require_memory
from swgpar.analysis.identity import identity
from swgpar.analysis.mesh_refinement import choose_mesh
from swgpar.analysis.recorder import FolderRecorder, MemoryRecorder
from swgpar.analysis.shortcuts import MESHES, with_shortcuts
from swgpar.analysis.start_states import StartStates
from swgpar.checks.remarks import torque_remark
from swgpar.design.drive_design import DriveDesign
from swgpar.drive_results.drive_data import DriveData
from swgpar.errors import ConvergenceError, SwgparError, TimeLimitError
from swgpar.evaluation.period import require_samples
from swgpar.load.load_sequence import LoadSequence, load_sequence
from swgpar.log import logger
from swgpar.meshing import load_recipe, require_sections
from swgpar.model.drive_model import build_drive_model
from swgpar.results.atomic import on_all
from swgpar.results.folder import RECIPE, open_log, prepare
from swgpar.results.lock import releasing
from swgpar.run_options import RunOptions
from swgpar.solve.time_limit import limited


@releasing
def run_drive(design: DriveDesign, options: RunOptions) -> DriveData:
    """Run a design; collective.

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
    recipe, recipe_name = options.recipe, options.recipe_name
    if recipe is None:
        recipe_name = MESHES[design.drive.model]
        recipe = load_recipe(recipe_name)
    require_sections(design.drive.model, recipe)
    if options.accuracy is not None:
        require_refinable(design, options.accuracy)
        design = with_accuracy(design, options.accuracy)
    left_out: tuple[str, ...] = ()
    if not options.plain:
        shortcuts = with_shortcuts(design, recipe, levels=options.accuracy is None)
        design, left_out = shortcuts.design, shortcuts.left_out
    sequence = load_sequence(design)
    require_samples(sequence, [name for name in ("fatigue", "losses") if getattr(design, name)])
    needs = forecast(design, recipe)
    require_memory(needs, design.solver.memory_limit, comm)
    resumed = folder is not None and prepare(folder, comm, options.restart, options.overwrite)
    open_log(folder, comm)
    _log_remarks(sequence, left_out, design.without_windows if design.output.root_stress else "")
    with reported_memory(needs), limited(design.solver.time_limit):
        kept = StartStates(folder)
        if not options.restart:
            kept.remove(comm)
        elif not resumed:
            way = "taking over loaded states" if kept.found(comm) else "starting from the beginning"
            logger.info("no increment was saved: %s", way)
        what = identity(design, recipe, options.accuracy)
        chosen = None
        if options.accuracy is not None:
            if resumed:
                recipe = on_all(comm, lambda: load_recipe(folder / RECIPE))
            else:
                chosen = choose_mesh(design, recipe, sequence, options.accuracy, comm, kept=kept)
                recipe = chosen.recipe
        model = build_drive_model(design, recipe, comm=comm) if chosen is None else chosen.model
        recorder = (
            MemoryRecorder(model, sequence)
            if folder is None
            else FolderRecorder(model, sequence, folder, what)
        )
        try:
            if chosen is not None:
                recorder.keep_choice(chosen, options.accuracy)
            run = DriveRun(model, recipe, sequence, recorder, kept, options.on_increment, begin)
            items = run.resume() if resumed else run.start()
            run.go_through(items, options.terminal)
            result = run.finish(recipe_name)
        except SwgparError as error:
            # collective: all ranks have this error, but perhaps not one of another kind
            model.destroy()
            if (
                isinstance(error, (ConvergenceError, TimeLimitError))
                and recorder.record.rows
                and folder is not None
            ):
                raise type(error)(
                    f"{error}; {len(recorder.record.rows)} increments are saved in {folder}"
                ) from None
            raise
        model.destroy()
    return result


def _log_remarks(sequence: LoadSequence, left_out: Sequence[str], without_windows: str) -> None:
    """Say what the run leaves out, and what of the design may not be meant.

    without_windows : what keeps windows from resolving a stress that is asked for
    """
    remark = torque_remark(sequence.torque, sequence.negligible_torque)
    if remark is not None:
        logger.warning("%s", remark)
    if left_out:
        logger.info("left out: %s; --plain computes all of it", ", ".join(left_out))
    if without_windows and not sequence.points:
        logger.info(
            "the stress at the teeth is not resolved by windows: not available with %s",
            without_windows,
        )
