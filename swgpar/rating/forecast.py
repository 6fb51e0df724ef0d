"""How long a rating takes, before anything is meshed."""

from __future__ import annotations

import math

from swgpar.analysis.forecast import forecast
from swgpar.meshing import MeshRecipe
from swgpar.rating.planned_runs import RatingPlan


def rating_seconds(plan: RatingPlan, recipe: MeshRecipe) -> float:
    """Wall seconds on two cores of all runs of a sheet, by their forecasts; without an accuracy,
    which refines meshes. Raises InputError where the recipe gives no mesh of a run."""
    designs = [run.design for run in plan.runs if run.design is not None]
    return math.fsum(forecast(design, recipe).seconds for design in designs)
