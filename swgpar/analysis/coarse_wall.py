"""The largest stresses of the wall of a drive on a coarser mesh, which show the errors of those on
its own."""

from __future__ import annotations

from swgpar.errors import ConvergenceError, InputError
from swgpar.largest_stress.wall_stress import CoarseWall, ring_stresses
from swgpar.load.load_states import LoadState
from swgpar.log import logger
from swgpar.meshing import MeshRecipe
from swgpar.meshing.recipe_counts import wall_ratio
from swgpar.model.drive_model import DriveModel


def coarse_wall(model: DriveModel, state: LoadState, fine: MeshRecipe) -> CoarseWall | None:
    """The largest stresses of the wall of the loaded model beside those on a finer mesh, None where
    they are not known; collective."""
    ratio = wall_ratio(model.recipe, fine)
    if not model.design.resolves_wall or ratio is None:
        return None
    try:
        return CoarseWall(ring_stresses(model, state), ratio)
    except (ConvergenceError, InputError) as error:
        logger.info("the error of the wall by the mesh of the drive is not known: %s", error)
        return None
