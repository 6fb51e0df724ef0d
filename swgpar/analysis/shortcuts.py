"""What a run leaves out by itself, and the mesh that it takes when none is named.

Without friction the loaded state does not depend on the path to it, and the state repeats after one
period. So a run needs neither the steps of the assembly nor the angles of further periods, and it
may start on coarser meshes. Digits that no mesh gives are not computed. Keys that the design file
sets are kept.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.load.load_program import begins_with_rotation
from swgpar.load.load_sequence import program_points
from swgpar.meshing import MeshRecipe
from swgpar.meshing.recipe_counts import coarser

MESHES = {"plane": "plane_coarse", "cup": "forces", "pancake": "forces"}
"""Mesh recipes of the package for a run that names none. Windows that they drive are within 1 % of
those that finer meshes drive (docs/verification/windows.md)."""

SAMPLES = {"plane": 6, "cup": 4, "pancake": 4}
"""Angles in a period, one less where two of them would show the same state. In the plane eight
change the means by 0.1 %, the range of the input torque by a twentieth. In the cup six change the
mean of s1 by 0.1 %, that range by a tenth."""

RTOL = {"plane": 1e-6, "cup": 1e-5, "pancake": 1e-5}
"""Newton's tolerance. The stresses of the reference drives keep all digits that are printed, the
input torque of the cup drive changes by 1e-5. At 1e-5 that of a fine plane mesh would change by 0.6
%."""

FEWEST = 4
"""Elements along the flank, and along the face width, below which a coarser mesh does not find its
contacts."""

FEWEST_IN_START = {"plane": FEWEST, "cup": FEWEST, "pancake": 3}
"""The same of a mesh that a start goes by. With 3 elements three pancakes take 0.6 to 0.9 of the
time."""

MOST = 4
"""Coarser meshes at most: the largest value of `steps.start_levels`."""

WORTH = {"plane": 12, "cup": 16, "pancake": 6}
"""Elements along the flank from which a start on coarser meshes saves time. A cup has few
iterations from the bent shape, and a run with windows has a coarser mesh in any case."""


@dataclass(frozen=True)
class Shortcuts:
    """A design with shortcuts.

    design : the design with their keys
    left_out : what they leave out, in words
    """

    design: DriveDesign
    left_out: tuple[str, ...]


def with_shortcuts(design: DriveDesign, recipe: MeshRecipe, *, levels: bool = True) -> Shortcuts:
    """The design with the keys of [steps] and [solver] that save time and do not change the result.

    Keys that the design sets are kept.

    levels : whether the run may start on coarser meshes; with `--accuracy` it has its own
    """
    steps, solver, stiffness = design.steps, design.solver, design.stiffness
    deviations = design.deviations
    points, changes, left_out = program_points(design), {}, []

    # a load from one side stands still: no angle of another period has the same state. The period
    # of teeth and bolts is long, and so few angles do not show it
    repeats = design.repeats and design.kinematics.pitches == 1

    def leave_out(key: str, value: int | bool, words: str) -> None:
        if key not in steps.model_fields_set and value != getattr(steps, key):
            changes[key] = value
            left_out.append(words)

    if not design.contact.friction:
        samples = design.kinematics.apart(SAMPLES[design.drive.model])
        period = float(np.degrees(design.kinematics.period_angle))
        samples_enough = (
            repeats
            and steps.rotation >= 0.999999 * period
            and steps.rotation > (samples - 1) * steps.increment
        )
        if samples_enough and not points:
            beyond = f"{steps.rotation - period:.4g} of {steps.rotation:.4g} degrees"
            leave_out("samples", samples, f"{beyond} ({samples} angles of one period)")
        follows = begins_with_rotation(points)
        # the bent spline lies on the cam that is not turned
        unturned = points[0].angle == 0.0 if points else steps.load_increments == 1
        if follows or unturned:
            leave_out("bent_start", True, "deflection and engagement step by step")
        worth = levels and not follows and recipe.flexible_spline.flank >= WORTH[design.drive.model]
        fewest = FEWEST_IN_START[design.drive.model]
        count = _useful_levels(recipe, fewest) if worth else 0
        leave_out("start_levels", count, f"the assembly on this mesh ({count} coarser)")
        if "rtol" not in solver.model_fields_set:
            rtol = RTOL[design.drive.model]
            solver = solver.model_copy(update={"rtol": rtol})
            left_out.append(f"residuals below {rtol:g} of the contact force")
        if stiffness and "loop" not in stiffness.model_fields_set:
            stiffness = stiffness.model_copy(update={"loop": False})
            left_out.append("the way back of the stiffness loop and positions that mirror others")
    if deviations is not None and "linear_model" not in deviations.model_fields_set:
        # the whole turns say how many angles it gives
        deviations = deviations.model_copy(update={"linear_model": True})
    content: dict[str, Any] = {**steps.model_dump(exclude_unset=True), **changes}
    steps = type(steps).model_validate(content)
    update = {"steps": steps, "solver": solver, "stiffness": stiffness, "deviations": deviations}
    return Shortcuts(design.model_copy(update=update), tuple(left_out))


def _useful_levels(recipe: MeshRecipe, fewest: int) -> int:
    """Number of coarser meshes that resolve the contacts."""
    count, simpler = 0, coarser(recipe)
    while count < MOST and simpler != recipe and finds_contacts(simpler, fewest):
        recipe, simpler, count = simpler, coarser(simpler), count + 1
    return count


def finds_contacts(recipe: MeshRecipe, fewest: int = FEWEST) -> bool:
    """Whether a recipe has elements enough to find the contacts of the flanks."""
    width = recipe.face_width.elements if recipe.face_width else fewest
    return min(recipe.flexible_spline.flank, recipe.ring_gear.flank, width) >= fewest
