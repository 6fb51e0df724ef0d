"""A mesh for an accuracy: refined until the estimated error of the largest tensile stress is below what is asked for.

The drive is assembled and loaded on a mesh with few elements; every finer one starts from the state before. The error
of the loaded state is estimated from the last three meshes, so that the time goes into one mesh that suffices.
Compressive stress is no measure: where edges carry, its largest value has no limit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.design import SECTOR_BEND, DriveDesign
from swgpar.error_estimate import ORDER
from swgpar.errors import InputError
from swgpar.incremental import DriveModel
from swgpar.log import logger
from swgpar.meshing import MeshRecipe
from swgpar.multilevel import CoarserLevel, coarser, level_of, load, recounted
from swgpar.steps import Scene

MEASURE = "fs_s1"
"""Stress whose accuracy is asked for."""

LOWEST, HIGHEST = 1e-3, 0.2
"""Accuracies that may be asked for."""

SAMPLES = ((0.02, 4), (0.005, 8), (0.0, 16))
"""Angles in a period for accuracies from the first number on. Four instead of eight change the means of the plane half
turn by 0.3 %, those of the cup drive by 0.5 %; what half of a run's own angles would give is in its summary."""

RTOL = 1e-5
"""Newton's tolerance: its part in the error of the stresses is below the lowest accuracy by decades."""

BEND = 0.2
"""Share of an accuracy up to which condensed sectors, which leave out a part of the bending strain, are used: of the
largest stress, which a notch raises, that part is less than half as much."""

STEPS = (1.5, 2.0)
"""Refinements of all counts to choose from."""

LARGEST = {2: 400_000, 3: 700_000}
"""Elements of the whole drive, plane and solid, beyond which no finer mesh is taken: some 20 GB."""


@dataclass(frozen=True)
class Chosen:
    """The model on the mesh chosen, in its loaded state, and the level below it. error : relative, estimated"""

    model: DriveModel
    recipe: MeshRecipe
    below: CoarserLevel
    error: float


def with_accuracy(design: DriveDesign, accuracy: float) -> DriveDesign:
    """The design with the angles, tolerance and sectors that suit an accuracy, where it does not say them itself.

    Raises InputError where the accuracy is out of range or cannot be had.
    """
    if not LOWEST <= accuracy <= HIGHEST:
        raise InputError(f"--accuracy {accuracy:g} is out of range: allowed {LOWEST:g} to {HIGHEST:g}")
    if design.contact.friction:
        raise InputError(
            f"--accuracy needs contact.friction = 0, not {design.contact.friction:g}: with friction the loaded state "
            "depends on the way to it and cannot be taken over from a coarser mesh"
        )
    changes: dict[str, Any] = {}
    solver: dict[str, Any] = {}
    whole_period = design.steps.rotation >= np.degrees(design.pitch)
    if "samples" not in design.steps.model_fields_set and whole_period:
        samples = next(count for least, count in SAMPLES if accuracy >= least)
        changes["steps"] = design.steps.model_copy(update={"samples": samples})
    if "rtol" not in design.solver.model_fields_set:
        solver["rtol"] = RTOL
    small = design.drive.model == "plane" and design.sector_bend <= min(BEND * accuracy, SECTOR_BEND)
    if "condensed_sectors" not in design.solver.model_fields_set and small:
        solver["condensed_sectors"] = True
    return design.model_copy(update={**changes, "solver": design.solver.model_copy(update=solver)})


def refined(recipe: MeshRecipe, factor: float) -> MeshRecipe:
    """The recipe with every count times `factor`, rounded up; raises InputError beyond bounds."""
    return recounted(recipe, lambda name, value: -int(-factor * value // 1))


def relative_error(levels: list[CoarserLevel], dimensions: int) -> float:
    """Estimated relative error of the largest tensile stress on the last of several meshes.

    As `estimate`, but with the larger of the last two slopes over the element size: where a mesh is too coarse to see
    the stress, a difference that is small by chance would pass for convergence.
    """
    size = [level.elements ** (-1.0 / dimensions) for level in levels]
    stress = [level.stresses[MEASURE] for level in levels]
    slopes = [(b - a) / (h - k) for a, b, h, k in zip(stress, stress[1:], size, size[1:]) if h > k]
    if len(slopes) < len(levels) - 1 or not slopes:
        return 1.0
    error = max(map(abs, slopes[-2:])) * size[-1]
    return error / (abs(stress[-1]) + error)


def choose(design: DriveDesign, recipe: MeshRecipe, items: list[Scene], accuracy: float, comm: MPI.Comm) -> Chosen:
    """Refine `recipe` until the estimated relative error of the largest tensile stress is at most `accuracy`.

    items : all increments of the run. Ends with the finest mesh below the largest size where the accuracy is out of
    reach, and says so. Raises ConvergenceError or InputError like a run on one of the meshes.
    """
    model = load(design, coarser(recipe), items, comm)
    seen = [level_of(model)]
    while True:
        model = load(design, recipe, items, comm, model)
        dimensions = model.partition.dims
        below, here = seen[-1], level_of(model)
        seen.append(here)
        error = relative_error(seen, dimensions) + model.bend_left_out() / abs(here.stresses[MEASURE])
        logger.info(
            "%d elements: s1 %.1f MPa under load, estimated error %.2g %%",
            here.elements,
            here.stresses[MEASURE],
            100.0 * error,
        )
        factor = STEPS[0] if error <= STEPS[0] ** ORDER * accuracy else STEPS[1]
        if error <= accuracy:
            return Chosen(model, recipe, below, error)
        if here.elements * factor**dimensions > LARGEST[dimensions]:
            factor = STEPS[0]
        if here.elements * factor**dimensions > LARGEST[dimensions]:
            logger.info("no finer mesh is taken beyond %d elements", LARGEST[dimensions])
            return Chosen(model, recipe, below, error)
        try:
            recipe = refined(recipe, factor)
        except InputError as limit:
            logger.info("no finer mesh can be had: %s", limit)
            return Chosen(model, recipe, below, error)
