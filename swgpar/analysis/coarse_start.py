"""Start on coarser meshes: pins, engagement and torque there, the loaded state interpolated onto the finer mesh.

Most Newton iterations of a start find out which points touch. On a mesh with half of the elements in every direction
they cost an eighth and less, and its loaded state is so close that a few iterations remain. Without friction the loaded
state does not depend on the way to it, so that the result is the same to the solver's tolerance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from swgpar.analysis.drive_model import DriveModel, stresses
from swgpar.analysis.load_stepping import LOADED, LoadStepper
from swgpar.design.drive_design import DriveDesign
from swgpar.design.load_states import LoadState
from swgpar.errors import SwgparError
from swgpar.fem.vectors import read_field, write_field
from swgpar.geometry.rotation import rotated
from swgpar.log import logger
from swgpar.meshing import MeshRecipe
from swgpar.meshing.interpolation import interpolation
from swgpar.meshing.recipe_counts import coarser


def transfer(coarse: DriveModel, x: PETSc.Vec, fine: DriveModel, y: PETSc.Vec) -> None:
    """Set y of the fine model to the state x of the coarse one; both on the same ranks, sector by sector."""
    for body, layout in enumerate(fine.partition.layouts):
        first, end = fine.partition.owned_sectors(body)
        sectors = np.arange(first, end)
        angle = layout.sector_angle(layout.first_tooth + sectors)
        local = rotated(read_field(coarse.partition, body, sectors, x), -angle[:, None])
        matrix = interpolation(coarse.partition.layouts[body].mesh, layout.mesh)
        values = np.stack([matrix @ sector for sector in local]) if len(local) else np.zeros((0, matrix.shape[0], 3))
        write_field(fine.partition, body, sectors, rotated(values, angle[:, None]), y)
    if fine.comm.rank == fine.comm.size - 1:
        n = fine.partition.n_multipliers
        y.array[-n:] = x.array_r[-n:]


def levels(design: DriveDesign, recipe: MeshRecipe) -> list[MeshRecipe]:
    """Recipes of the coarser meshes of a start, the coarsest first.

    None with friction, under which the loaded state depends on the way to it.
    """
    found: list[MeshRecipe] = []
    while len(found) < design.steps.start_levels and not design.contact.friction:
        simpler = coarser(found[0] if found else recipe)
        if simpler == (found[0] if found else recipe):
            break
        found.insert(0, simpler)
    return found


def from_loaded(items: list[LoadState]) -> list[LoadState]:
    """The increments from the loaded state on."""
    loaded = max(k for k, item in enumerate(items) if item.step == LOADED)
    return items[loaded:]


@dataclass(frozen=True)
class Level:
    """The loaded state on one mesh. elements : of the whole drive;  stresses : largest ones, MPa"""

    elements: int
    stresses: dict[str, float]


def level_of(model: DriveModel) -> Level:
    """Elements and stresses of a model in its loaded state."""
    return Level(model.elements_whole(), stresses(model)[0])


def load(
    design: DriveDesign, recipe: MeshRecipe, items: list[LoadState], comm: MPI.Comm, below: DriveModel | None = None
) -> DriveModel:
    """The drive on one mesh in its loaded state, from that on another one, the model `below`, which is released.

    items : all increments of the run. Raises ConvergenceError or InputError where a mesh does not allow it.
    """
    way = None
    try:
        way = LoadStepper(DriveModel(design, recipe, comm))
        todo = [item for item in items if item.step <= LOADED]
        if below is not None:
            todo, taken, below = todo[-1:], below, None
            take_over(taken, way, todo[-1])
        iterations = []
        for item in todo:
            way.increment(item)
            iterations.append(way.iterations)
    except SwgparError:
        for model in (below, way and way.model):
            if model is not None:
                model.destroy()
        raise
    counted = " + ".join(map(str, iterations))
    logger.info("loaded on a mesh of %d elements, Newton iterations %s", way.model.elements_whole(), counted)
    return way.model


def start_loaded(runner: LoadStepper, recipes: list[MeshRecipe], items: list[LoadState]) -> Level:
    """Bring `runner` to the loaded state by way of coarser meshes, the coarsest of `recipes` first.

    items : all increments of the run. Raises ConvergenceError or InputError where a mesh does not allow it; `runner` is
    then to be reset.
    """
    target, below = runner.model, None
    loaded = from_loaded(items)[0]
    with target.phases("start"):
        for recipe in recipes:
            below = load(target.design, recipe, items, target.comm, below)
        level = level_of(below)
        take_over(below, runner, loaded)
        runner.increment(loaded)
    return level


def take_over(below: DriveModel, runner: LoadStepper, loaded: LoadState) -> None:
    """Take over the loaded state of the model on another mesh, and release that."""
    try:
        transfer(below, below.equilibrium.x, runner.model, runner.equilibrium.x)
    finally:
        below.destroy()
    runner.scene = loaded
