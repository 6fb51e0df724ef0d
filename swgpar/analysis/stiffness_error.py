"""Error of the torsional stiffness by the mesh, from the first position on a coarser one."""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI

from swgpar.analysis.coarse_start import solve_to_load
from swgpar.analysis.drive_mesh_error import ORDER, SAFETY, coarser_recipes
from swgpar.analysis.load_stepping import LoadStepper
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import ConvergenceError, InputError
from swgpar.evaluation.program_results import PointRow, point_rows
from swgpar.evaluation.stiffness import NAMES, Stiffness, by_position
from swgpar.load.load_program import stiffness_program
from swgpar.log import logger
from swgpar.meshing import MeshRecipe
from swgpar.meshing.recipe_counts import body_ratio


def stiffness_error(
    design: DriveDesign, recipe: MeshRecipe, rows: Sequence[PointRow], comm: MPI.Comm
) -> dict[str, float] | None:
    """Error of every value of `Stiffness` on the mesh of `recipe`; None where it is not known.

    rows : of program.csv on that mesh. Collective.
    """
    coarser = coarser_recipes(recipe)
    ratio = body_ratio(coarser[0], recipe) if coarser else None
    if ratio is None:
        logger.info(
            "the error of the stiffness by the mesh is not known: a coarser one would not find the "
            "contacts"
        )
        return None
    first = _first_position(design)
    try:
        found = _stiffness_on(first, coarser[0], comm)
    except (ConvergenceError, InputError) as error:
        logger.info("the error of the stiffness by the mesh is not known: %s", error)
        return None
    fine = by_position(stiffness_program(first), rows)[0.0]
    both = {name: (getattr(fine, name), getattr(found, name)) for name in NAMES}
    return {
        name: SAFETY * abs(values[0] - values[1]) / (ratio**ORDER - 1.0)
        for name, values in both.items()
        if None not in values
    }


def _first_position(design: DriveDesign) -> DriveDesign:
    section = design.stiffness.model_copy(update={"positions": 1})
    return design.model_copy(update={"stiffness": section})


def _stiffness_on(design: DriveDesign, recipe: MeshRecipe, comm: MPI.Comm) -> Stiffness:
    """The stiffness at the only position of a design, on another mesh."""
    model = solve_to_load(design, recipe, comm)
    try:
        stepper = LoadStepper(model)
        sequence = stepper.sequence
        stepper.resume_at(sequence.loaded)
        rows = [stepper.row()]
        for state in sequence.from_loaded[1:]:
            stepper.advance(state)
            rows.append(stepper.row())
    finally:
        model.destroy()
    points = point_rows(sequence.points, sequence.kinematics, rows)
    return by_position(stiffness_program(design), points)[0.0]
