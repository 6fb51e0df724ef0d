"""The largest stresses of a drive on a coarser mesh, which show the errors of those on its own."""

from __future__ import annotations

from swgpar.errors import ConvergenceError, InputError
from swgpar.largest_stress.place_errors import CoarseStresses
from swgpar.largest_stress.places import find_places
from swgpar.largest_stress.wall_stress import CoarseWall, ring_stresses
from swgpar.load.load_states import LoadState
from swgpar.log import logger
from swgpar.meshing import MeshRecipe
from swgpar.meshing.recipe_counts import wall_ratio
from swgpar.model.drive_model import DriveModel
from swgpar.model.regions import resolves_wall


def coarse_stresses(
    model: DriveModel, state: LoadState, coarse: MeshRecipe, fine: MeshRecipe, ratio: float
) -> CoarseStresses:
    """The largest stresses of the loaded model on the coarser of two meshes; collective.

    ratio : of the element sizes that decide about nodal averages
    """
    places = find_places(model, state, model.stresses()[1])
    wall, of_wall = None, wall_ratio(coarse, fine)
    if resolves_wall(model.design) and of_wall is not None:
        try:
            wall = CoarseWall(ring_stresses(model, state), of_wall)
        except (ConvergenceError, InputError) as error:
            logger.info("the error of the wall by the mesh of the drive is not known: %s", error)
    return CoarseStresses(places, ratio, wall)
