"""The drive as its whole turns are computed: its mesh, its design, and which of its states Newton's
iteration gives."""

from __future__ import annotations

from swgpar.analysis.shortcuts import finds_contacts
from swgpar.design.deviations import Deviations, gear_deviations
from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GEARS
from swgpar.meshing import MeshRecipe
from swgpar.meshing.recipe_counts import coarsened, coarser

CAM_QUADRATURE, CAM_PENALTY = 2, 1.0
"""Largest number of points per direction and penalty coefficient of the cam on the coarse mesh:
fewer points that come and go save a fifth of the iterations and change the output's angle by a
thousandth of what deviations do."""

WORTH_GUESSES = 40
"""States at one place of a period from which a linear model of the drive pays on two ranks: each
makes it, and it takes as long as some ten states."""

CHECKED, LEAST_CHECKED = 0.05, 50
"""Share of the states at one place that Newton's iteration gives where a linear model gives the
others, and their least number."""

RTOL = 1e-5
"""Newton's tolerance on the coarse mesh, at least: it changes the output's angle by a millionth of
an arc second and the input torque by 1e-4."""

MAX_ITERATIONS = 50
"""Newton iterations before the residual has to halve: small loads on teeth with large deviations
take many."""


def turned_pitches(design: DriveDesign) -> int:
    """Pitches of the standing gear by which the wave generator turns."""
    kinematics = design.kinematics
    return design.deviations.turns * kinematics.teeth(kinematics.standing_gear)


def checked_share(different: int) -> float:
    """Share of the states at one place that Newton's iteration gives, 1 or more for all of them.
    different : of them, by the deviations"""
    return max(CHECKED, LEAST_CHECKED / different)


def turn_mesh(design: DriveDesign, recipe: MeshRecipe) -> MeshRecipe:
    """The mesh of whole turns: that of the recipe, or where `deviations.mesh` is "coarse" the
    coarsest one, by halves, that finds the contacts of the flanks: the output's angle needs no
    more. In the plane also by two thirds; in a cup drive so few elements along the face width
    change the forces of the teeth by a fifth."""
    if design.deviations.mesh != "coarse":
        return recipe
    ways = (coarser, coarsened) if recipe.model == "plane" else (coarser,)
    for fewer in ways:
        simpler = fewer(recipe)
        while simpler != recipe and finds_contacts(simpler):
            recipe, simpler = simpler, fewer(simpler)
    return recipe


def turn_design(design: DriveDesign) -> DriveDesign:
    """The design as its turns are computed: without friction, whose states depend on the path to
    them, with condensed sectors, half of it if deviations allow."""
    deviations, solver, wave = design.deviations, design.solver, design.wave_generator
    contact = design.contact.model_copy(update={"friction": 0.0})
    changes: dict[str, float] = {
        "symmetry": solver.symmetry and _is_twofold(design, deviations),
        "condensed_sectors": design.can_condense,
        "max_iterations": max(solver.max_iterations, MAX_ITERATIONS),
    }
    if deviations.mesh == "coarse":
        changes["rtol"] = max(solver.rtol, RTOL)
        cam = {
            "wg_quadrature": min(contact.wg_quadrature, CAM_QUADRATURE),
            "wg_penalty_coef": min(contact.wg_penalty_coef, CAM_PENALTY),
        }
        contact = contact.model_copy(update=cam)
    solver = solver.model_copy(update=changes)
    steps = design.steps.model_copy(update={"bent_start": True, "samples": 0, "rotation": 0.0})
    if wave.bearing is not None:  # balls that pass would make every pitch another drive
        bearing = wave.bearing.model_copy(update={"cage_speed": 1.0})
        wave = wave.model_copy(update={"bearing": bearing})
    return design.model_copy(
        update={"solver": solver, "steps": steps, "contact": contact, "wave_generator": wave}
    )


def _is_twofold(design: DriveDesign, deviations: Deviations) -> bool:
    """Whether the drive with its deviations equals itself rotated by 180 degrees."""
    rigid = (deviations.wave_generator, deviations.cup)
    if any(part.eccentricity or part.tilt for part in rigid):
        return False
    return all(gear_deviations(deviations, gear, design.teeth(gear)).is_twofold() for gear in GEARS)
