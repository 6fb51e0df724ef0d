"""The small drive: overrides that shorten its run and that make it plane."""

from __future__ import annotations

PLANE = (
    "drive.model=plane",
    "load.torque=0.2",
    *(f"micro_geometry.{key}=0" for key in ("wg_crowning", "wg_slope", "fs_crowning")),
)
"""Overrides that make the plane model of the small drive; it carries a tenth of the torque."""

NO_SHORTCUTS = (
    "steps.bent_start=false",
    "steps.samples=0",
    "steps.start_levels=0",
    "solver.rtol=1e-9",
)
"""Overrides that set the keys of all shortcuts."""

SHORT = ("steps.rotation=4.0", "steps.increment=2.0")
