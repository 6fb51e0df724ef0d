"""What a design may have and what deserves a word: teeth that overlap, torques that are too small
to be resolved."""

from __future__ import annotations

from collections.abc import Mapping

from swgpar.design.drive_design import DriveDesign
from swgpar.load.negligible_torque import negligible_torque

CLEARANCES = (
    "tip of spline to root of ring, major axis (mm)",
    "tip of ring to root of spline, major axis (mm)",
    "tips at the minor axis (mm)",
    "smallest flank clearance, kinematic (mm)",
    "tip of spline to root of dynamic spline (mm)",
    "tip of dynamic spline to root of spline (mm)",
    "clearance in the dynamic spline (mm)",
)
"""Names of `derived_geometry` whose values are negative where teeth overlap."""


def torque_remark(torque: float, negligible: float) -> str | None:
    """A sentence where a torque counts as none. torque : N·m;  negligible : N·mm"""
    if not 0.0 < 1000.0 * torque <= negligible:
        return None
    return (
        f"load.torque = {torque:g} N·m counts as none: up to {0.001 * negligible:.3g} N·m it is "
        f"too small "
        "beside the bending of the flexible spline"
    )


def remarks(design: DriveDesign, derived: Mapping[str, float]) -> list[str]:
    """Sentences about what is allowed and may not be meant. derived : of `derived_geometry`"""
    allowed = design.contact.penetration_tolerance * design.drive.module
    overlaps = [
        f"interference: {name} = {derived[name]:.3g}: teeth overlap before they are loaded, and "
        f"the drive may jam"
        for name in CLEARANCES
        if derived.get(name, 0.0) < -allowed
    ]
    return [
        *overlaps,
        *filter(None, [torque_remark(design.load.torque, negligible_torque(design))]),
    ]
