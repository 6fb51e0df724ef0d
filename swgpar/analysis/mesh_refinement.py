"""A mesh for an accuracy: refined until the estimated error of the largest tensile stress is below what is asked for.

The drive is assembled and loaded on a mesh with few elements. Every further mesh starts from the loaded state of the
one before. The part of each group of counts in the error of the loaded state is estimated, and the group with the
largest part for its elements is refined. Compressive stress is no measure: under edge contact its largest value has no
limit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from mpi4py import MPI

from swgpar.analysis.coarse_start import LoadedState, loaded_state, solve_to_load
from swgpar.analysis.drive_model import DriveModel
from swgpar.analysis.error_estimate import ORDER
from swgpar.design.drive_design import DriveDesign
from swgpar.design.fit_checks import OMITTED_BENDING
from swgpar.design.load_states import LoadState
from swgpar.errors import ConvergenceError, InputError
from swgpar.log import logger
from swgpar.meshing import MeshRecipe, build_sector_meshes
from swgpar.meshing.recipe_counts import coarser, doubled

MEASURE = "fs_s1"
"""Stress whose accuracy is asked for."""

LOWEST, HIGHEST = 1e-3, 0.2
"""Accuracies that may be asked for."""

SAMPLES = ((0.02, 4), (0.005, 8), (0.0, 16))
"""Smallest accuracy and number of angles in a period. Four instead of eight change the means of the plane half
turn by 0.3 %, those of the cup drive by 0.5 %; the summary of a run has the
change by half of its own angles."""

RTOL = 1e-7
"""Newton's tolerance. Its part in the error of the stresses is far below the lowest accuracy. At 1e-5 the input torque
of a fine plane mesh has an error of 0.6 %, and a solve takes one iteration less."""

BEND = 0.2
"""Share of an accuracy up to which condensed sectors, which leave out a part of the bending strain, are used: of the
largest stress, which a notch raises, that part is less than half as much."""

Counts = dict[str, tuple[str, ...]]
"""Names of counts by section of the recipe."""

Doublings = tuple[int, ...]
"""How many times every group of counts is doubled."""

GROUPS: dict[str, Counts] = {
    "root and rim": {"flexible_spline": ("root", "under", "rim")},
    "flanks and ring gear": {
        "flexible_spline": ("tip", "layers", "flank"),
        "ring_gear": ("tip", "layers", "flank", "root", "under", "rim"),
    },
    "length": {"face_width": ("elements",), "cup": ("cylinder", "fillet", "closed_end")},
}
"""Counts that are refined together. The largest tension sits in the root or at the inner surface below it, and most of
its error comes from the counts there (docs/verification/accuracy.md, plane drive)."""

LARGEST = {2: 1_500_000, 3: 700_000}
"""Elements of the whole drive, plane and solid, beyond which no finer mesh is taken; they need about 7 and 12 GB."""


@dataclass(frozen=True)
class ChosenMesh:
    """The model on the mesh chosen, in its loaded state. error : relative, estimated;  stresses : errors of all, MPa"""

    model: DriveModel
    recipe: MeshRecipe
    error: float
    stresses: dict[str, float]


def with_accuracy(design: DriveDesign, accuracy: float) -> DriveDesign:
    """The design with the angles, tolerance and sectors that suit an accuracy, where it does not say them itself.

    Raises InputError where the accuracy is out of range or cannot be had.
    """
    if not LOWEST <= accuracy <= HIGHEST:
        raise InputError(f"--accuracy {accuracy:g} is out of range: allowed {LOWEST:g} to {HIGHEST:g}")
    if design.contact.friction:
        raise InputError(
            f"--accuracy needs contact.friction = 0, not {design.contact.friction:g}: with friction the loaded state "
            "depends on the path to it and cannot be taken over from a coarser mesh"
        )
    changes: dict[str, Any] = {}
    solver: dict[str, Any] = {}
    whole_period = design.steps.rotation >= np.degrees(design.period_angle)
    if "samples" not in design.steps.model_fields_set and whole_period:
        samples = next(count for least, count in SAMPLES if accuracy >= least)
        changes["steps"] = design.steps.model_copy(update={"samples": samples})
    if "rtol" not in design.solver.model_fields_set:
        solver["rtol"] = RTOL
    small = design.drive.model == "plane" and design.omitted_bending <= min(BEND * accuracy, OMITTED_BENDING)
    if "condensed_sectors" not in design.solver.model_fields_set and small:
        solver["condensed_sectors"] = True
    return design.model_copy(update={**changes, "solver": design.solver.model_copy(update=solver)})


def error_after(change: float, before: float = 0.0) -> float:
    """Error after a doubling, by Richardson from what it changed, and at least from what the one before it did.

    Where a mesh is too coarse to see the stress, a change that is small by chance would pass for convergence.
    """
    return max(abs(change), abs(before) / 2.0**ORDER) / (2.0**ORDER - 1.0)


def relative(error: float, stress: float) -> float:
    """Error over the stress without it; 1 where nothing is known."""
    return error / (abs(stress) + error) if np.isfinite(error) else 1.0


class RefinedLevels(Protocol):
    """Loaded states on recipes with some groups of counts doubled: what `refine` works on.

    groups : names of the groups;  largest : elements beyond which no mesh is taken
    doublings : of the last state;  levels, omitted_stress : states, and stresses (MPa) left out, by their doublings
    """

    groups: Sequence[str]
    largest: int
    doublings: Doublings
    levels: dict[Doublings, LoadedState]
    omitted_stress: dict[Doublings, float]

    def size(self, doublings: Doublings) -> int:
        """Elements of the whole drive; 0 where there is no such mesh, or where it is too large."""

    def load(self, doublings: Doublings) -> LoadedState:
        """Bring the drive to its loaded state there."""


class Refinement:
    """The loaded drive on recipes with some groups of counts doubled.

    Parameters
    ----------
    design, load_states, comm : the drive, all increments of its run, communicator
    recipe : what is refined; coarsened where a group could not be doubled below the largest size
    largest : elements of the whole drive beyond which no mesh is taken
    """

    def __init__(
        self,
        design: DriveDesign,
        recipe: MeshRecipe,
        load_states: list[LoadState],
        comm: MPI.Comm,
        *,
        largest: int,
    ) -> None:
        self.design, self.load_states, self.comm, self.largest = design, load_states, comm, largest
        self.groups = [name for name in GROUPS if design.drive.model != "plane" or name != "length"]
        self.base, self.doublings = recipe, (0,) * len(self.groups)
        while not all(self.size(doubled_once(self.doublings, k)) for k in range(len(self.groups))):
            if coarser(self.base) == self.base:
                break
            self.base = coarser(self.base)
        self.levels: dict[Doublings, LoadedState] = {}
        self.omitted_stress: dict[Doublings, float] = {}
        self.model: DriveModel | None = None

    def recipe(self, doublings: Doublings) -> MeshRecipe:
        """With every group doubled as many times as `doublings` says."""
        recipe = self.base
        for name, times in zip(self.groups, doublings):
            recipe = doubled(recipe, GROUPS[name], times)
        return recipe

    def size(self, doublings: Doublings) -> int:
        """Elements of the whole drive; 0 where there is no such mesh, or where it is too large."""
        try:
            meshes = build_sector_meshes(self.design, self.recipe(doublings)).values()
        except InputError:
            return 0
        elements = sum(len(mesh.hexes) * mesh.n_sectors for mesh in meshes)
        return elements if elements <= self.largest else 0

    def load(self, doublings: Doublings) -> LoadedState:
        """Bring the drive to its loaded state there, from that of the last mesh, or else from the start."""
        if self.model is None:
            self.model = solve_to_load(self.design, coarser(self.base), self.load_states, self.comm)
        recipe, coarse = self.recipe(doublings), self.model
        try:
            self.model = solve_to_load(self.design, recipe, self.load_states, self.comm, coarse)
        except (ConvergenceError, InputError) as error:
            logger.info("the state of another mesh does not lead to that of this one: %s", error)
            self.model = solve_to_load(self.design, recipe, self.load_states, self.comm)
        self.doublings, self.levels[doublings] = doublings, loaded_state(self.model)
        self.omitted_stress[doublings] = self.model.omitted_bending_stress()
        return self.levels[doublings]


def doubled_once(doublings: Doublings, group: int) -> Doublings:
    """Doublings with another doubling of one group."""
    return tuple(count + (k == group) for k, count in enumerate(doublings))


def choose_mesh(
    design: DriveDesign,
    recipe: MeshRecipe,
    load_states: list[LoadState],
    accuracy: float,
    comm: MPI.Comm,
    *,
    largest: int | None = None,
) -> ChosenMesh:
    """Refine `recipe` until the estimated relative error of the largest tensile stress is at most `accuracy`.

    load_states : all increments of the run
    largest : elements of the whole drive beyond which no mesh is taken; None for those of `LARGEST`

    Ends below the largest size where the accuracy is out of reach, and says so. Raises ConvergenceError or InputError
    like a run on one of the meshes.
    """
    if largest is None:
        largest = LARGEST[2 if design.drive.model == "plane" else 3]
    refinement = Refinement(design, recipe, load_states, comm, largest=largest)
    doublings, error, stresses = refine(refinement, accuracy)
    return ChosenMesh(refinement.model, refinement.recipe(doublings), error, stresses)


def refine(refinement: RefinedLevels, accuracy: float) -> tuple[Doublings, float, dict[str, float]]:
    """Double groups until the estimated relative error of the largest tensile stress is at most `accuracy`.

    Every group of counts has an error, first from what doubling it alone changes; then the group is doubled that has
    the largest error for the elements of the finer mesh.

    Returns the doublings of the last state loaded, its relative error, and the errors (MPa) of all stresses.
    """
    doublings, groups = refinement.doublings, range(len(refinement.groups))
    level, changes = refinement.load(doublings), []
    for k in groups:
        one_more = doubled_once(doublings, k)
        trial = refinement.load(one_more).stresses if refinement.size(one_more) else None
        # what the doubling before this one would have changed
        changes.append(
            {name: 2.0**ORDER * (trial[name] - value) if trial else np.inf for name, value in level.stresses.items()}
        )
    errors = [{name: error_after(value) for name, value in change.items()} for change in changes]
    while True:
        stress = level.stresses[MEASURE]
        omitted = refinement.omitted_stress[doublings]
        error = relative(sum(one[MEASURE] for one in errors) + omitted, stress)
        parts = ", ".join(
            f"{name} {100.0 * relative(one[MEASURE], stress):.2g}" for name, one in zip(refinement.groups, errors)
        )
        logger.info("%d elements: s1 %.1f MPa under load, estimated errors (%%): %s", level.elements, stress, parts)
        if error <= accuracy:
            break
        sizes = [refinement.size(doubled_once(doublings, k)) for k in groups]
        stays = omitted + sum(one[MEASURE] for one, size in zip(errors, sizes) if not size)
        if relative(stays, stress) > accuracy or not any(sizes):
            logger.info("no finer mesh that helps is taken up to %d elements", refinement.largest)
            break
        k = max((k for k in groups if sizes[k]), key=lambda k: errors[k][MEASURE] / sizes[k])
        doublings, before = doubled_once(doublings, k), level.stresses
        level = refinement.levels[doublings] if doublings in refinement.levels else refinement.load(doublings)
        change = {name: value - before[name] for name, value in level.stresses.items()}
        errors[k] = {name: error_after(value, changes[k][name]) for name, value in change.items()}
        changes[k] = change
    if refinement.doublings != doublings:
        refinement.load(doublings)
    total = {name: sum(one[name] for one in errors) for name in level.stresses}
    return doublings, error, {name: value for name, value in total.items() if np.isfinite(value)}
