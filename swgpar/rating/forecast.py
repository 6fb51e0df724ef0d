"""How long a rating takes, before anything is meshed."""

from __future__ import annotations

from swgpar.analysis.forecast import forecast
from swgpar.design.drive_design import DriveDesign
from swgpar.meshing import MeshRecipe
from swgpar.rating.planned_runs import plan_runs


def rating_seconds(design: DriveDesign, recipe: MeshRecipe) -> float:
    """Wall seconds on two cores of all runs of the sheet, by their forecasts; without an accuracy,
    which refines meshes. Raises InputError without [rating] or a torque, and where the recipe gives
    no mesh of the design."""
    runs = (run.design for run in plan_runs(design).runs)
    return sum(forecast(one, recipe).seconds for one in runs if one is not None)
