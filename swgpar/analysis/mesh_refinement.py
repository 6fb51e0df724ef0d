"""Meshes for an accuracy: of the drive, and of the windows at its teeth.

The drive is loaded on a mesh and on a coarser one. The change of the stress in a window between
them gives the error of the drive's mesh, the order seen on three windows that of the window's mesh.
The larger of both is reduced until they are small enough together (docs/theory/meshes.md).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from mpi4py import MPI

from swgpar.analysis.accuracy import ROUGH
from swgpar.analysis.coarse_start import solve_to_load
from swgpar.analysis.forecast import fits, forecast
from swgpar.analysis.saved_state import StartStates
from swgpar.analysis.shortcuts import finds_contacts
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import ConvergenceError, InputError, SwgparError
from swgpar.evaluation.place_errors import CoarseStresses
from swgpar.evaluation.places import find_places
from swgpar.evaluation.windows.root_stress import (
    FEWEST_LEVELS,
    LEVELS,
    MOST_LEVELS,
    RootStress,
    resolve_root_stress,
)
from swgpar.half_space.pair_contact import pair_contacts
from swgpar.load.load_sequence import load_sequence
from swgpar.load.load_states import LoadState
from swgpar.log import logger
from swgpar.meshing import MeshRecipe, build_sector_meshes
from swgpar.meshing.recipe_counts import RATIO, resized
from swgpar.model.drive_model import DriveModel

ORDER = 2
"""Order of the displacements of a mesh."""

COMPARED_LEVELS = 2
"""Windows of which the last one shows what the mesh of the drive changes."""

LEAST = {"plane": 0.004, "cup": 0.01}
"""Least error by the mesh of the drive that two meshes can show, as a share of the stress: on
plane_coarse that error is 0 to 0.6 %, on forces 0.2 to 1.1 % (docs/verification/effectivity.md)."""

LEAST_WITH_EDGES = 0.02
"""The same where a contact lies on an edge. The forces of the teeth move with the mesh: on
plane_coarse by 0.7 to 2.7 % of the stress."""

SMALLEST_RATIO = 1.05
"""Least ratio of element sizes of an error: the smallest recipes can hardly be coarsened."""

LARGEST = {"plane": 1_500_000, "cup": 700_000}
"""Elements of the whole drive beyond which no finer mesh is taken; they need about 7 and 12 GB."""


@dataclass(frozen=True)
class ChosenMesh:
    """The model on the mesh chosen, in its loaded state.

    root_stress : with both errors;  error : relative
    coarse : what the mesh before it gives
    """

    model: DriveModel
    recipe: MeshRecipe
    root_stress: RootStress
    error: float
    coarse: CoarseStresses


def compared_stresses(model: DriveModel, state: LoadState) -> Mapping[str, Sequence[float]]:
    """Stresses (MPa) in the last windows on a coarser mesh of the drive, for `drive_error`."""
    return resolve_root_stress(model, state, COMPARED_LEVELS, COMPARED_LEVELS - 1).by_part


def drive_error(
    coarse: Mapping[str, Sequence[float]],
    fine: RootStress,
    ratio: float,
    least: float,
    before: float | None = None,
) -> float:
    """Error (MPa) of the finer of two meshes of the drive by the stresses in windows of both.

    coarse : s1 (MPa) on the same windows, coarse to fine, by part of the teeth
    ratio : of the element sizes;  least : share of the stress, see `least_error`
    before : error of the coarser mesh, if it is known

    A change that is small by chance is no convergence: the error is at least what remains of that
    before, or else `least` of the stress.
    """
    levels = coarse[fine.part]
    shared = min(len(levels), len(fine.levels)) - 1
    change = abs(fine.levels[shared] - levels[shared]) * abs(fine.s1 / fine.levels[shared])
    remains = least * abs(fine.s1) if before is None else before / ratio**ORDER
    return max(change / (ratio**ORDER - 1.0), remains)


def least_error(model: DriveModel, state: LoadState) -> float:
    """Least error that two meshes of the drive can show, as a share of the stress; collective."""
    edge = any(pair.edge for pair in pair_contacts(model, state))
    return LEAST_WITH_EDGES if edge else LEAST[model.design.drive.model]


def size_ratio(coarse: MeshRecipe, fine: MeshRecipe) -> float:
    """Ratio of the element sizes along the flanks, which decide about the forces of the teeth."""
    return max(fine.flexible_spline.flank / coarse.flexible_spline.flank, SMALLEST_RATIO)


class Refinement:
    """The loaded drive on one mesh after the other, with windows.

    Parameters
    ----------
    recipe : the first mesh, compared with a coarser one, or where that would not find the contacts
        with a finer one
    largest : elements of the whole drive beyond which no mesh is taken
    kept : loaded states of an earlier run, to which those of this one are added
    levels : windows on the first mesh; None for the usual ones

    Attributes
    ----------
    model, recipe, found : the present mesh and the stress by its windows
    coarse, compared : what the mesh before it gives in windows, and at the places
    """

    def __init__(
        self,
        design: DriveDesign,
        recipe: MeshRecipe,
        comm: MPI.Comm,
        largest: int,
        kept: StartStates | None = None,
        levels: int | None = None,
    ) -> None:
        self.design, self.comm, self.largest, self.kept = design, comm, largest, kept
        self.loaded, self.kind = load_sequence(design).loaded, design.drive.model
        self.levels = levels or LEVELS[self.kind]
        coarse = resized(recipe, 1.0 / RATIO)
        if not finds_contacts(coarse):
            coarse, recipe = recipe, resized(recipe, RATIO)
        self.recipe = recipe
        self.model = self._solved(coarse)
        try:
            self.coarse = compared_stresses(self.model, self.loaded)
            self.compared = self._compared(size_ratio(coarse, recipe))
            self._replace(recipe)
            self.found = self._resolve()
        except SwgparError:
            self.model.destroy()
            raise

    def _compared(self, ratio: float) -> CoarseStresses:
        """The largest stresses on the present mesh, coarser than the next one by the ratio."""
        places = find_places(self.model, self.loaded, self.model.stresses()[1])
        return CoarseStresses(places, ratio)

    def _solved(self, recipe: MeshRecipe, coarse: DriveModel | None = None) -> DriveModel:
        """The loaded model on a mesh, from the state of a coarser one if it is given."""
        return solve_to_load(self.design, recipe, self.comm, coarse, kept=self.kept)

    def _replace(self, recipe: MeshRecipe) -> None:
        """Take the model on this mesh, from the present one's state where its path is of no
        account."""
        if self.design.contact.friction:
            self.model.destroy()
            self.model = self._solved(recipe)
            return
        try:
            self.model = self._solved(recipe, self.model)
        except (ConvergenceError, InputError) as error:
            logger.info("the state of another mesh does not lead to that of this one: %s", error)
            self.model = self._solved(recipe)

    def _resolve(self, before: float | None = None) -> RootStress:
        """Windows on the present mesh. before : error (MPa) of the mesh before it"""
        found = resolve_root_stress(self.model, self.loaded, self.levels)
        least = least_error(self.model, self.loaded)
        error = drive_error(self.coarse, found, self.compared.ratio, least, before)
        logger.info(
            "%d elements: s1 %.1f MPa under load; error by the windows %.2g %%, by the mesh of the "
            "drive %.2g %%",
            self.model.n_elements(),
            found.s1,
            100.0 * _bound(found.error) / found.s1,
            100.0 * error / found.s1,
        )
        return replace(found, drive_error=error)

    def refine_windows(self) -> bool:
        """Resolve the stress with a finer window; False where there is none."""
        if self.levels == MOST_LEVELS[self.kind]:
            return False
        try:
            found = resolve_root_stress(self.model, self.loaded, self.levels + 1)
        except (ConvergenceError, InputError) as error:
            logger.warning("no finer window: %s", error)
            return False
        self.levels += 1
        self.found = replace(found, drive_error=self.found.drive_error)
        return True

    def refine_drive(self) -> bool:
        """Take a finer mesh of the drive; False where there is none, or where it is too large."""
        limit = self.design.solver.memory_limit
        try:
            finer = resized(self.recipe, RATIO)
            needs = forecast(self.design, finer)
            if needs.elements > self.largest or not fits(needs, limit, self.comm):
                return False
            build_sector_meshes(self.design.geometry, finer)
        except InputError:
            return False
        earlier = self.coarse, self.compared, self.found
        self.compared = self._compared(size_ratio(self.recipe, finer))
        self.coarse = self.found.by_part
        try:
            self._replace(finer)
            self.found = self._resolve(self.found.drive_error)
        except (ConvergenceError, InputError) as error:
            logger.warning("no finer mesh of the drive: %s", error)
            self.coarse, self.compared, self.found = earlier
            self.model.destroy()
            self.model = self._solved(self.recipe)
            return False
        self.recipe = finer
        return True


def choose_mesh(
    design: DriveDesign,
    recipe: MeshRecipe,
    accuracy: float,
    comm: MPI.Comm,
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
    largest = LARGEST[design.drive.model] if largest is None else largest
    levels = FEWEST_LEVELS[design.drive.model] if accuracy >= ROUGH else None
    drive = Refinement(design, recipe, comm, largest, kept, levels)
    refine = {"windows": drive.refine_windows, "mesh": drive.refine_drive}
    while relative_error(drive.found) > accuracy:
        errors = {
            "windows": _bound(drive.found.error),
            "mesh": _bound(drive.found.drive_error),
        }
        allowed = accuracy * drive.found.s1
        if not refine or any(errors[part] > allowed for part in errors.keys() - refine.keys()):
            logger.info(
                "no finer mesh is taken: the drive has at most %d elements, and its run fits into "
                "the memory",
                drive.largest,
            )
            break
        part = max(refine, key=lambda part: errors[part])
        if not refine[part]():
            del refine[part]
    error = relative_error(drive.found)
    return ChosenMesh(drive.model, drive.recipe, drive.found, error, drive.compared)


def relative_error(found: RootStress) -> float:
    """Error over the stress."""
    return _bound(found.total_error) / abs(found.s1) if found.s1 else 1.0


def _bound(error: float | None) -> float:
    """The error, without end where it is not known."""
    return math.inf if error is None else error
