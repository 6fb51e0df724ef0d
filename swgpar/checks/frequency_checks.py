"""Checks of what natural frequencies need."""

from __future__ import annotations

from swgpar.checks.inertia import require_density
from swgpar.design.drive_design import DriveDesign
from swgpar.input.require import require, require_available

FREQUENCIES = "[frequencies]"


def check_frequencies(design: DriveDesign) -> None:
    """Raise InputError where the loaded state has no natural frequencies, or a mass is missing."""
    require_available(
        not design.has_program,
        FREQUENCIES,
        "a load program, [stiffness] or [ratcheting]",
        "with one torque",
    )
    friction = design.contact.friction
    require(friction == 0.0, "contact.friction", friction, f"only 0 with {FREQUENCIES}")
    condensed = design.solver.condensed_sectors
    require(not condensed, "solver.condensed_sectors", condensed, f"only false with {FREQUENCIES}")
    least = design.negligible_torque_Nm
    allowed = f"above {least:.3g} N·m with {FREQUENCIES}: without a load the teeth have play"
    require(design.load.torque > least, "load.torque", design.load.torque, allowed)
    for body in design.materials:
        require_density(design, body, FREQUENCIES)
