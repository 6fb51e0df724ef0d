"""Start with the loaded state: from the bent shape, or on coarser meshes with interpolation.

Most Newton iterations of a start find out which points touch. On a mesh with half of the elements
in every direction they cost an eighth or less. Its loaded state is so close that a few iterations
remain on the finer mesh. Without friction the loaded state does not depend on the path to it, so
that the result is the same to the solver's tolerance.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from mpi4py import MPI

from swgpar.analysis.bent_start import bend
from swgpar.analysis.drive_mesh_error import coarser_recipes, with_finer_flanks
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.analysis.saved_state import StartStates
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import ConvergenceError, InputError, SwgparError
from swgpar.fem.vectors import read_field, write_field
from swgpar.geometry.rotation import rotated
from swgpar.log import logger
from swgpar.meshing import MeshRecipe
from swgpar.meshing.interpolation import interpolation
from swgpar.meshing.recipe_counts import coarser
from swgpar.model.drive_model import DriveModel, build_drive_model
from swgpar.petsc import PETSc


def transfer(coarse: DriveModel, x: PETSc.Vec, fine: DriveModel, y: PETSc.Vec) -> None:
    """Set y of the fine model to x of the coarse one, sector by sector, on the same ranks."""
    for body, layout in fine.partition.layouts.items():
        sectors = fine.partition.owned_indices(body)
        angle = layout.chain_angle(sectors)
        local = rotated(read_field(coarse.partition, body, sectors, x), -angle[:, None])
        matrix = interpolation(coarse.partition.layouts[body].mesh, layout.mesh)
        values = np.zeros((len(local), matrix.shape[0], 3))
        for own, sector in enumerate(local):
            values[own] = matrix @ sector
        write_field(fine.partition, body, rotated(values, angle[:, None]), y)
    if fine.comm.rank == fine.comm.size - 1:
        n = fine.partition.n_multipliers
        y.array[-n:] = x.array_r[-n:]


def levels(design: DriveDesign, recipe: MeshRecipe) -> list[MeshRecipe]:
    """Recipes of the coarser meshes of a start, the coarsest first.

    None with friction, because the loaded state then depends on the path to it.
    """
    recipes = [recipe]
    while len(recipes) <= design.steps.start_levels and not design.contact.friction:
        simpler = coarser(recipes[0])
        if simpler == recipes[0]:
            break
        recipes.insert(0, simpler)
    return recipes[:-1]


def solve_to_load(
    design: DriveDesign,
    recipe: MeshRecipe,
    comm: MPI.Comm,
    coarse: DriveModel | None = None,
    *,
    kept: StartStates | None = None,
) -> DriveModel:
    """The loaded drive on one mesh, from the loaded state of the model `coarse`, which is released.

    kept : loaded states of an earlier run, to which this one is added

    Raises ConvergenceError or InputError where a mesh does not allow it.
    """
    model = None
    try:
        model = build_drive_model(design, recipe, comm=comm)
        stepper = LoadStepper(model)
        taken_over = kept is not None and kept.restore(model, recipe)
        if taken_over:
            if coarse is not None:
                coarse.destroy()
            iterations = [_settle(stepper)]
        elif coarse is not None:
            iterations = [take_over(coarse, stepper)]
        else:
            iterations = _reach_load(stepper)
        if kept is not None and not taken_over:
            kept.save(model, recipe)
            _settle(stepper)  # so that the forces are those of a run that takes this state over
    except SwgparError:
        for one in (coarse, model):
            if one is not None:
                one.destroy()
        raise
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


def starts_bent(design: DriveDesign) -> bool:
    """Whether a run begins with the bent shape; not with friction, as `levels`."""
    return design.steps.bent_start and not design.contact.friction


def _reach_load(stepper: LoadStepper) -> list[int]:
    """From the bent shape if that is asked for and works, else step by step; Newton iterations."""
    if starts_bent(stepper.design):
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
    recipe: MeshRecipe,
    on_coarse: Callable[[DriveModel, MeshRecipe], None],
    kept: StartStates,
) -> bool:
    """Reach the loaded state on coarser meshes or from the bent shape; False if that is not asked
    for, or fails.

    recipe : of the stepper's mesh;  for the others see `start_loaded`
    """
    coarser_ones, compares = levels(stepper.design, recipe), stepper.design.resolves_root_stress
    ways: list[tuple[list[MeshRecipe], list[MeshRecipe]]] = []
    if coarser_ones:
        last = coarser_ones.pop()
        ways.append((coarser_ones, with_finer_flanks(last, recipe) if compares else [last]))
    if starts_bent(stepper.design):
        if compares and not ways and (compared := coarser_recipes(recipe)):
            ways.append(([], compared))
        ways.append(([], []))
    for recipes, compared in ways:
        try:
            start_loaded(stepper, recipes + compared, on_coarse, kept, len(compared))
            return True
        except (ConvergenceError, InputError) as error:
            what = "on coarser meshes" if compared else "from the bent shape"
            logger.info("no start %s: %s", what, error)
            stepper.reset()
    return False


def start_loaded(
    stepper: LoadStepper,
    recipes: list[MeshRecipe],
    on_coarse: Callable[[DriveModel, MeshRecipe], None] = lambda model, recipe: None,
    kept: StartStates | None = None,
    compared: int = 0,
) -> None:
    """Bring `stepper` to the loaded state by way of coarser meshes, the coarsest of `recipes`
    first, or bent at once.

    on_coarse : called with the model on each of the last `compared` ones of the coarser meshes, and
        its recipe; it raises nothing
    kept : see `solve_to_load`

    Raises ConvergenceError or InputError where a mesh does not allow it; `stepper` is then to be
    reset.
    """
    target, coarse = stepper.model, None
    with target.phases("start"):
        if not recipes:
            _jump(stepper)
            return
        for left, recipe in zip(range(len(recipes), 0, -1), recipes):
            coarse = solve_to_load(target.design, recipe, target.comm, coarse, kept=kept)
            if left <= compared:
                on_coarse(coarse, recipe)
        take_over(coarse, stepper)


def take_over(coarse: DriveModel, stepper: LoadStepper) -> int:
    """Take over the loaded state of the model on another mesh, which is released, and solve;
    Newton iterations."""
    loaded = stepper.sequence.loaded
    try:
        transfer(coarse, coarse.problem.x, stepper.model, stepper.problem.x)
    finally:
        coarse.destroy()
    stepper.load_state = loaded
    stepper.advance(loaded)
    return stepper.iterations
