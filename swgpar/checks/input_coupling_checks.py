"""Checks of the coupling at the input."""

from __future__ import annotations

from swgpar.design.drive_design import DriveDesign
from swgpar.design.input_coupling import InputCoupling
from swgpar.errors import InputError
from swgpar.input.require import require_available


def check_input_coupling(design: DriveDesign, coupling: InputCoupling) -> None:
    """Raise InputError for a coupling that does nothing, or that no shaft turns."""
    beside, allowed = 'drive.layout = "wave_generator_fixed"', '"ring_fixed" or "spline_fixed"'
    turns = not design.kinematics.wave_generator_is_fixed
    require_available(turns, "[input_coupling]", beside, allowed)
    if coupling.stiffness is None and coupling.play == 0.0:
        raise InputError(
            "input_coupling.stiffness is missing: give it (above 0 N·m/rad), or "
            "input_coupling.play above 0 deg"
        )
