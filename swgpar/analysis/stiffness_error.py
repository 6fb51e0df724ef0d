"""Error of the torsional stiffness by the mesh, from the first position on other ones.

Two groups of counts have an error each: those that are smaller on a coarser mesh, and in the plane
those that are too small to be: along the flanks, in the layers below them, and in the ring gear.
These are doubled on another mesh. The sizes of both errors are added (docs/theory/stiffness.md).
In a cup drive the wall decides with the face width; the coarser mesh has at least 1/1.5 of it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from swgpar.analysis.coarse_start import MeshedDrive
from swgpar.analysis.drive_mesh_error import ORDER, SAFETY, coarser_recipe, smallest_ratio
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import ConvergenceError, InputError
from swgpar.evaluation.program_results import PointRow, point_rows
from swgpar.evaluation.stiffness import CHORDS, NAMES, StiffnessValues, by_position
from swgpar.load.load_sequence import stiffness_program
from swgpar.log import logger
from swgpar.meshing import MeshRecipe
from swgpar.meshing.recipe_counts import (
    body_ratio,
    wall_ratio,
    with_equal_doubled,
    with_wall_rounded_up,
)

LEAST = 0.003
"""Least error of a stiffness, and of the lost motion without the backlash, as a share of it:
contacts move between nodes, and changes may be small by chance."""

CAUTIOUS_ORDER = 1.3
"""Order of displacements in the plane, of which 1 to 2 are seen
(docs/verification/error_sources_plane.md). It takes the place of a factor: both meshes together
change all counts."""

DOUBLED = 1.0 / (1.0 - 2.0**-CAUTIOUS_ORDER)
"""Error of a mesh over the change that twice the elements make."""


def stiffness_error(
    drive: MeshedDrive, recipe: MeshRecipe, rows: Sequence[PointRow]
) -> dict[str, float] | None:
    """Error of every value of `StiffnessValues` on the mesh of `recipe`; None where there is none.

    rows : of program.csv on that mesh. Collective.
    """
    coarser = coarser_recipe(recipe)
    if coarser is None or body_ratio(coarser, recipe) is None:
        logger.info(
            "the error of the stiffness by the mesh is not known: a coarser one would not find the "
            "contacts"
        )
        return None
    first = replace(drive, design=_first_position(drive.design))
    coarse = with_wall_rounded_up(coarser, recipe)
    ratio = min(smallest_ratio(coarse, recipe), wall_ratio(coarse, recipe) or math.inf)
    fine = by_position(stiffness_program(first.design), rows)[0.0]
    try:
        found = _stiffness_on(first, coarse)
        if drive.design.drive.model == "plane":
            doubled = _stiffness_on(first, with_equal_doubled(recipe, coarse))
            changes = [
                _changes(found, fine, 1.0 / (ratio**CAUTIOUS_ORDER - 1.0)),
                _changes(fine, doubled, DOUBLED),
            ]
        else:
            changes = [_changes(found, fine, SAFETY / (ratio**ORDER - 1.0))]
    except (ConvergenceError, InputError) as error:
        logger.info("the error of the stiffness by the mesh is not known: %s", error)
        return None
    elastic = {name: getattr(fine, name) or 0.0 for name in CHORDS}
    if fine.lost_motion is not None and fine.backlash is not None:
        elastic["lost_motion"] = fine.lost_motion - fine.backlash
    return {
        name: max(
            sum(change[name] for change in changes),
            LEAST * abs(elastic.get(name, 0.0)),
        )
        for name in NAMES
        if all(name in change for change in changes)
    }


def _changes(before: StiffnessValues, after: StiffnessValues, factor: float) -> Mapping[str, float]:
    """Sizes of the changes of the values that both have, times a factor."""
    both = {name: (getattr(before, name), getattr(after, name)) for name in NAMES}
    return {
        name: factor * abs(values[1] - values[0])
        for name, values in both.items()
        if None not in values
    }


def _first_position(design: DriveDesign) -> DriveDesign:
    """The design with one position, and without the torques that only a curve or the area of a loop
    needs."""
    section = design.stiffness
    changes = {"positions": 1} if section.loop else {"positions": 1, "points": 1}
    section = section.model_copy(update=changes)
    return design.model_copy(update={"stiffness": section})


def _stiffness_on(drive: MeshedDrive, recipe: MeshRecipe) -> StiffnessValues:
    """The stiffness at the only position of a drive, on another mesh."""
    model = drive.load(recipe)
    try:
        stepper = LoadStepper(model)
        sequence = stepper.sequence
        stepper.resume_at(sequence.loaded)
        rows = [stepper.row()]
        for state in sequence.from_loaded[1:]:
            stepper.advance(state)
            rows.append(stepper.row())
    finally:
        drive.models.give_back(model)
    return by_position(stiffness_program(drive.design), point_rows(sequence, rows))[0.0]
