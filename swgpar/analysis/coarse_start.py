"""Start with the loaded state: from the bent shape, or on coarser meshes with interpolation.

Most Newton iterations of a start find out which points touch. On a mesh with half of the elements
in every direction they cost an eighth or less. Its loaded state is so close that a few iterations
remain on the finer mesh. Without friction the loaded state does not depend on the path to it, so
that the result is the same to the solver's tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from mpi4py import MPI

from swgpar.analysis.bent_start import bend
from swgpar.analysis.drive_mesh_error import coarser_recipe
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.model_sources import NEW_MODELS, ModelSource
from swgpar.analysis.saved_state import StartStates
from swgpar.analysis.transfer import interpolations, transfer
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import ConvergenceError, InputError, SwgparError
from swgpar.log import logger
from swgpar.meshing import MeshRecipe
from swgpar.meshing.recipe_counts import coarser
from swgpar.model.drive_model import DriveModel

LIKE_LOAD = 0.1
"""Difference of two torques, over the larger one, up to which the state under one is a better start
for the other than that of a coarser mesh. In a cup with balls a step from 16 to 34 N·m takes 22
iterations, the way from a coarser mesh 7."""


def levels(count: int, recipe: MeshRecipe) -> list[MeshRecipe]:
    """Recipes of at most so many coarser meshes, the coarsest first."""
    recipes = [recipe]
    while len(recipes) <= count:
        simpler = coarser(recipes[0])
        if simpler == recipes[0]:
            break
        recipes.insert(0, simpler)
    return recipes[:-1]


@dataclass(frozen=True)
class MeshedDrive:
    """A drive that is loaded on one mesh after another.

    models : where the models on its meshes come from
    """

    design: DriveDesign
    comm: MPI.Comm
    models: ModelSource = NEW_MODELS

    def load(
        self,
        recipe: MeshRecipe,
        coarse: DriveModel | None = None,
        kept: StartStates | None = None,
    ) -> DriveModel:
        """The loaded drive on a mesh, from the loaded state of the model `coarse`, which is given
        back; a state of the mesh under another load comes before that. Collective.

        kept : loaded states of an earlier run, to which this one is added

        Raises ConvergenceError or InputError where a mesh does not allow it.
        """
        models, model = self.models, None
        try:
            model = models.take(self.design, recipe, self.comm)
            stepper = LoadStepper(model)
            taken_over = kept is not None and kept.restore(model)
            if taken_over or (known := _from_other_load(stepper, models)) is not None:
                if coarse is not None:
                    models.give_back(coarse)
                    coarse = None
                iterations = [_settle(stepper) if taken_over else known]
            elif coarse is not None:
                iterations = [take_over(coarse, stepper, models)]
                coarse = None
            else:
                iterations = _reach_load(stepper)
            if kept is not None and not taken_over:
                kept.save(model)
                _settle(stepper)  # so that the forces are those of a run that takes this state over
        except SwgparError:
            for one in (coarse, model):
                if one is not None:
                    models.drop(one)
            raise
        models.keep_loaded(stepper)
        counted = " + ".join(map(str, iterations))
        logger.info(
            "loaded on a mesh of %d elements, Newton iterations %s", model.n_elements(), counted
        )
        return model


def _settle(stepper: LoadStepper) -> int:
    """Search the contacts anew at x, that of the loaded state; returns Newton iterations."""
    loaded = stepper.sequence.loaded
    stepper.resume_at(loaded)
    stepper.advance(loaded)
    return stepper.iterations


def _from_other_load(stepper: LoadStepper, models: ModelSource) -> int | None:
    """Reach the load from that of another run; Newton iterations, None where no state is known or
    none leads there."""
    if not models.resume(stepper):
        return None
    try:
        _advance(stepper)
    except ConvergenceError as error:
        logger.info("no start from the state under another load: %s", error)
        stepper.reset()
        return None
    return stepper.iterations


def _advance(stepper: LoadStepper) -> None:
    """To the loaded state from that under another load, or from that of a drive that is near, which
    no step leads to it in halves."""
    loaded = stepper.sequence.loaded
    stepper.advance(loaded, cut_back=stepper.load_state != loaded)


def _reach_load(stepper: LoadStepper) -> list[int]:
    """From the bent shape if that is asked for and works, else step by step; Newton iterations."""
    if stepper.design.starts_bent:
        try:
            _jump(stepper)
            return [stepper.iterations]
        except ConvergenceError as error:
            logger.info("no start from the bent shape: %s", error)
            stepper.reset()
    iterations = []
    for state in stepper.sequence.states:
        stepper.advance(state)
        iterations.append(stepper.iterations)
        if state == stepper.sequence.loaded:
            break
    return iterations


def _jump(stepper: LoadStepper) -> None:
    bend(stepper.model)
    stepper.jump(stepper.sequence.loaded)


def start_at_load(
    stepper: LoadStepper,
    drive: MeshedDrive,
    on_coarse: Callable[[DriveModel], None],
    kept: StartStates,
) -> bool:
    """Reach the loaded state from that under another load, on coarser meshes or from the bent
    shape; False if that is not asked for, or fails.

    drive, on_coarse, kept : see `start_loaded`
    """
    recipe, compares = stepper.model.recipe, drive.design.compares_meshes
    ways: list[list[MeshRecipe]] = []
    if coarser_ones := levels(drive.design.start_levels, recipe):
        ways.append(coarser_ones)
    if drive.design.starts_bent:
        if compares and not ways and (compared := coarser_recipe(recipe)):
            ways.append([compared])
        ways.append([])
    if ways and drive.models.resume(stepper):
        asked = compares or stepper.sequence.samples > 0
        ways.insert(0, ways[0][-1:] if asked else [])
    for recipes in ways:
        try:
            start_loaded(stepper, drive, recipes, on_coarse, kept)
            return True
        except (ConvergenceError, InputError) as error:
            known = stepper.load_state != stepper.sequence.start
            what = "on coarser meshes" if recipes else "from the bent shape"
            logger.info("no start %s: %s", "from another load" if known else what, error)
            stepper.reset()
    return False


def start_loaded(
    stepper: LoadStepper,
    drive: MeshedDrive,
    recipes: list[MeshRecipe],
    on_coarse: Callable[[DriveModel], None] = lambda model: None,
    kept: StartStates | None = None,
) -> None:
    """Bring `stepper` to the loaded state: from that under another load where it has one that is
    `LIKE_LOAD`, by way of coarser meshes, the coarsest of `recipes` first, or bent at once.

    drive : that of the stepper, on any mesh
    on_coarse : called with the model on the last one of the coarser meshes; it raises nothing
    kept : see `MeshedDrive.load`

    Raises ConvergenceError or InputError where a mesh does not allow it; `stepper` is then to be
    reset.
    """
    models, coarse = drive.models, None
    with stepper.model.phases("start"):
        for recipe in recipes:
            coarse = drive.load(recipe, coarse, kept)
        if coarse is not None:
            on_coarse(coarse)
        known = stepper.load_state != stepper.sequence.start  # that under another load
        if coarse is not None and not (known and _is_like_load(stepper)):
            take_over(coarse, stepper, models)
        elif known:
            if coarse is not None:
                models.give_back(coarse)
            _advance(stepper)
        else:
            _jump(stepper)
    models.keep_loaded(stepper)


def _is_like_load(stepper: LoadStepper) -> bool:
    """Whether the torque of the state is nearly that of the loaded one."""
    here, loaded = stepper.load_state.torque, stepper.sequence.loaded.torque
    return math.isclose(here, loaded, rel_tol=LIKE_LOAD)


def take_over(coarse: DriveModel, stepper: LoadStepper, models: ModelSource) -> int:
    """Take over the loaded state of the model on another mesh, which is given back, and solve;
    Newton iterations."""
    loaded = stepper.sequence.loaded
    try:
        matrices = interpolations(coarse, stepper.model)
        transfer(coarse, coarse.problem.x, stepper.model, stepper.problem.x, matrices)
    finally:
        models.give_back(coarse)
    stepper.load_state = loaded
    stepper.advance(loaded)
    return stepper.iterations
