"""How long a run and a rating of a design take, in words."""

from __future__ import annotations

from pathlib import Path

from swgpar.analysis.forecast import duration_text, forecast
from swgpar.analysis.shortcuts import MESHES
from swgpar.api.runs import load_mesh
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import SwgparError
from swgpar.rating.forecast import rating_seconds
from swgpar.rating.planned_runs import plan_runs


def durations(design: DriveDesign, mesh: str, folder: Path) -> str:
    """Forecast for two cores that do nothing else; empty where the mesh does not fit the design. It
    knows no bearing, which takes longer.

    mesh : recipe of the package or name of one in the folder, empty for that of a command without a
    mesh
    """
    name = mesh or MESHES[design.drive.model]
    try:
        recipe = load_mesh(folder / name if name.endswith(".toml") else name)
        said = f"run: about {duration_text(forecast(design, recipe).seconds)}"
        if design.rating is not None:
            said += f"; rating: about {duration_text(rating_seconds(plan_runs(design), recipe))}"
    except SwgparError:
        return ""
    longer = "; longer with the bearing" if design.bearing else ""
    return f"{said}, on two free cores{longer}"
