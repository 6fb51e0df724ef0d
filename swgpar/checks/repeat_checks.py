"""Refusals of what continues or needs one period, where the drive does not repeat."""

from __future__ import annotations

from swgpar.design.drive_design import DriveDesign
from swgpar.input.require import require, require_available


def require_no_period(design: DriveDesign, because: str, otherwise: str) -> None:
    """Raise InputError for the first key that needs a period.

    because : what keeps the drive from repeating;  otherwise : with what it does
    """
    samples, stiffness = design.steps.samples, design.stiffness
    beside = f"{because}, which does not repeat after a pitch"
    require(samples == 0, "steps.samples", samples, f"only 0 with {beside}")
    for section in ("fatigue", "losses"):
        absent = getattr(design, section) is None
        require_available(absent, f"[{section}]", beside, otherwise)
    if stiffness is not None:
        positions = stiffness.positions
        require(positions == 1, "stiffness.positions", positions, f"only 1 with {beside}")
