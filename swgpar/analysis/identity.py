"""Identity of what a run computes, by which a restart knows its own files."""

from __future__ import annotations

import hashlib

from swgpar.design.drive_design import DriveDesign
from swgpar.meshing import MeshRecipe
from swgpar.results.atomic import to_json

SOLVER_CHOICES = {
    "linear",
    "keep_factor",
    "far_teeth",
    "iteration_limit",
    "time_limit",
    "memory_limit",
}
"""Keys of [solver] that a restart may change: they are about how systems are solved, and limits."""


def identity(design: DriveDesign, recipe: MeshRecipe, accuracy: float | None) -> str:
    """Identity of what is computed: all but the output, the rotation and how systems are solved.

    The angles of the rotation are compared one by one.
    """
    content = design.model_dump(
        exclude={"output": True, "steps": {"rotation", "samples"}, "solver": SOLVER_CHOICES}
    )
    if design.bearing is not None:
        content["cage_speed"] = design.cage_speed  # follows from steps.samples
    content = {"design": content, "recipe": recipe.model_dump(), "accuracy": accuracy}
    return hashlib.sha256(to_json(content)).hexdigest()
