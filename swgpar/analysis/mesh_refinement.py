"""Meshes for an accuracy: of the drive, and of the windows at its teeth.

The drive is loaded on a mesh and on a coarser one. The change of the stress in a window between
them gives the error of the drive's mesh, the order seen on three windows that of the window's mesh.
The larger of both is reduced until they are small enough together (docs/theory/meshes.md).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from swgpar.analysis.accuracy import ROUGH
from swgpar.analysis.coarse_start import MeshedDrive
from swgpar.analysis.coarse_wall import coarse_wall
from swgpar.analysis.compare_meshes import compare_meshes
from swgpar.analysis.drive_mesh_error import (
    MeshComparison,
    coarser_mesh,
    coarser_recipe,
    least_error,
)
from swgpar.analysis.forecast import fits, forecast
from swgpar.analysis.saved_state import StartStates
from swgpar.errors import ConvergenceError, InputError, SwgparError
from swgpar.evaluation.contact_error_shares import ContactErrorShares
from swgpar.flank_pressure.pair_contact import pair_contacts
from swgpar.largest_stress.root_stress import RootStress, resolve_root_stress
from swgpar.largest_stress.wall_stress import CoarseWall
from swgpar.largest_stress.window_recipes import FEWEST_LEVELS, LEVELS, MOST_LEVELS, by_model
from swgpar.load.load_sequence import load_sequence
from swgpar.log import logger
from swgpar.meshing import MeshRecipe, build_sector_meshes
from swgpar.meshing.recipe_counts import ROUND_OFF, refined
from swgpar.model.drive_model import DriveModel

LARGEST = by_model(1_500_000, 700_000)
"""Elements of the whole drive beyond which no finer mesh is taken; they need about 7 and 12 GB."""


@dataclass(frozen=True)
class ChosenMesh:
    """The model on the mesh chosen, in its loaded state.

    root_stress : with both errors;  error : relative
    coarse_wall : stresses of the wall on a coarser mesh, where they are known
    contact_errors : of the contacts of flanks;  bearing_errors : see `bearing_errors`
    """

    model: DriveModel
    root_stress: RootStress
    error: float
    coarse_wall: CoarseWall | None
    contact_errors: ContactErrorShares
    bearing_errors: dict[str, float]


@dataclass(frozen=True)
class Refined:
    """What a mesh gives in comparison with a coarser one.

    coarse_wall : stresses of the wall on that one, where they are known
    found : by windows, with both errors
    """

    comparison: MeshComparison
    coarse_wall: CoarseWall | None
    found: RootStress


class Refinement:
    """The loaded drive on one mesh after the other, with windows.

    Parameters
    ----------
    drive : on any mesh
    recipe : the first mesh, compared with a coarser one, or where that would not find the contacts
        with a finer one
    largest : elements of the whole drive beyond which no mesh is taken
    kept : loaded states of an earlier run, to which those of this one are added
    levels : windows on the first mesh; None for the usual ones

    Attributes
    ----------
    model, known : the present mesh and what it gives
    """

    def __init__(
        self,
        drive: MeshedDrive,
        recipe: MeshRecipe,
        largest: int,
        kept: StartStates | None = None,
        levels: int | None = None,
    ) -> None:
        self.drive, self.design, self.largest, self.kept = drive, drive.design, largest, kept
        self.loaded, self.kind = load_sequence(self.design).loaded, self.design.drive.model
        self.levels = levels or LEVELS[self.kind]
        coarser = coarser_recipe(recipe)
        if coarser is None:
            coarser, recipe = recipe, refined(recipe)
        self.model = self._solved(coarser)
        try:
            self.known = self._refined(recipe)
        except SwgparError:
            drive.models.drop(self.model)
            raise

    def _refined(self, recipe: MeshRecipe, before: RootStress | None = None) -> Refined:
        """Go from the present mesh to a finer one.

        before : stress on the present mesh with its error, if it is known
        """
        compared = coarse_wall(self.model, self.loaded, recipe)
        coarser = coarser_mesh(self.model, self.loaded, windows=True)
        self._replace(recipe)
        found = resolve_root_stress(self.model, self.loaded, self.levels)
        contacts = pair_contacts(self.model, self.loaded)
        comparison = compare_meshes(self.model, self.loaded, contacts, coarser, before)
        found = comparison.with_errors(found)
        self._log(found)
        return Refined(comparison, compared, found)

    def _log(self, found: RootStress) -> None:
        def share(error: float | None) -> str:
            return "not known" if error is None else f"{100.0 * error / found.s1:.2g} %"

        logger.info(
            "%d elements: s1 %.1f MPa under load; error by the windows %s, by the mesh of the "
            "drive %s",
            self.model.n_elements(),
            found.s1,
            share(found.error),
            share(found.drive_error),
        )

    def _solved(self, recipe: MeshRecipe, coarse: DriveModel | None = None) -> DriveModel:
        """The loaded model on a mesh, from the state of a coarser one if it is given."""
        return self.drive.load(recipe, coarse, self.kept)

    def _replace(self, recipe: MeshRecipe) -> None:
        """Take the model on this mesh, from the present one's state where its path is of no
        account."""
        if self.design.contact.friction:
            self.drive.models.give_back(self.model)
            self.model = self._solved(recipe)
            return
        try:
            self.model = self._solved(recipe, self.model)
        except (ConvergenceError, InputError) as error:
            logger.info("the state of another mesh does not lead to that of this one: %s", error)
            self.model = self._solved(recipe)

    def refine_windows(self) -> bool:
        """Resolve the stress with a finer window; False where there is none."""
        if self.levels == MOST_LEVELS[self.kind]:
            logger.info("no finer window is taken: there are %d", self.levels)
            return False
        try:
            found = resolve_root_stress(self.model, self.loaded, self.levels + 1)
        except (ConvergenceError, InputError) as error:
            logger.warning("no finer window: %s", error)
            return False
        self.levels += 1
        self.known = replace(self.known, found=self.known.comparison.with_errors(found))
        self._log(self.known.found)
        return True

    def _has_least_error(self, finer: MeshRecipe) -> bool:
        """Whether the error by the mesh is the least one that a finer mesh of the drive would have
        too."""
        found, contacts = self.known.found, self.known.comparison.contacts
        least = least_error(finer, contacts, found.part) * abs(found.s1)
        reached = found.drive_error is not None and found.drive_error <= least * (1.0 + ROUND_OFF)
        if reached:
            logger.info("no finer mesh is taken: the error by that of the drive is the least one")
        return reached

    def refine_drive(self) -> bool:
        """Take a finer mesh of the drive; False where there is none, where it is too large, or
        where it would have no smaller error."""
        recipe, limit = self.known.comparison.recipe, self.design.solver.memory_limit
        try:
            finer = refined(recipe)
            if self._has_least_error(finer):
                return False
            needs = forecast(self.design, finer)
            if needs.elements > self.largest or not fits(needs, limit, self.drive.comm):
                logger.info(
                    "no finer mesh is taken: the drive has at most %d elements, and its run fits "
                    "into the memory",
                    self.largest,
                )
                return False
            build_sector_meshes(self.design.geometry, finer)
        except InputError as error:
            logger.info("no finer mesh is taken: %s", error)
            return False
        try:
            self.known = self._refined(finer, self.known.found)
        except (ConvergenceError, InputError) as error:
            logger.warning("no finer mesh of the drive: %s", error)
            self.drive.models.give_back(self.model)
            self.model = self._solved(recipe)
            return False
        return True


def choose_mesh(
    drive: MeshedDrive,
    recipe: MeshRecipe,
    accuracy: float,
    *,
    largest: int | None = None,
    kept: StartStates | None = None,
) -> ChosenMesh:
    """Refine `recipe` and the windows until the estimated relative error of the root's stress is at
    most `accuracy`.

    largest : elements of the whole drive beyond which no finer mesh is taken; None for `LARGEST`
    kept : see `Refinement`

    Ends with the best mesh where the accuracy is out of reach, and says so. Raises ConvergenceError
    or InputError like a run on one of the first two meshes.
    """
    kind = drive.design.drive.model
    largest = LARGEST[kind] if largest is None else largest
    levels = FEWEST_LEVELS[kind] if accuracy >= ROUGH else None
    present = Refinement(drive, recipe, largest, kept, levels)
    refine = {"windows": present.refine_windows, "mesh": present.refine_drive}
    while relative_error(present.known.found) > accuracy:
        errors = {
            "windows": _bound(present.known.found.error),
            "mesh": _bound(present.known.found.drive_error),
        }
        allowed = accuracy * present.known.found.s1
        if not refine or any(errors[part] > allowed for part in errors.keys() - refine.keys()):
            break
        # a finer window costs least, and may be enough where the mesh is fine enough alone
        enough = "windows" in refine and errors["mesh"] <= allowed
        part = "windows" if enough else max(refine, key=lambda part: errors[part])
        if not refine[part]():
            del refine[part]
    known = present.known
    return ChosenMesh(
        present.model,
        known.found,
        relative_error(known.found),
        known.coarse_wall,
        known.comparison.contact_errors,
        known.comparison.bearing_errors,
    )


def relative_error(found: RootStress) -> float:
    """Error over the stress."""
    return _bound(found.total_error) / abs(found.s1) if found.s1 else 1.0


def _bound(error: float | None) -> float:
    """The error, without end where it is not known."""
    return math.inf if error is None else error
