"""What a design may have and what deserves a word: teeth that overlap, torques that are too small to be resolved."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:  # a design's load states ask for its torque
    from swgpar.design.drive_design import DriveDesign

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

RING_FLEXIBILITY = 0.25 * np.pi - 2.0 / np.pi
"""Change of the diameter of a ring under two opposed forces F, over F r^3 / (E I) (Timoshenko)."""

NEGLIGIBLE = 1e-4
"""Share of the bending force up to which a force on the teeth counts as none.

Newton's iteration balances it together with the forces that bend the flexible spline: far below them, the flanks that
carry it do not settle. The stresses by bending are larger by the same ratio.
"""


def negligible_torque(design: DriveDesign) -> float:
    """Output torque (N·mm) up to which a drive counts as unloaded: that of `NEGLIGIBLE` at the spline's radius.

    The bending force is that of a ring with the section of the rim, between two opposed forces.
    """
    rim, radius = design.flexible_spline.rim, design.inner_radius + 0.5 * design.flexible_spline.rim
    stiffness = design.material.E * design.drive.face_width * rim**3 / 12.0
    force = design.deflection * stiffness / (RING_FLEXIBILITY * radius**3)
    return NEGLIGIBLE * force * radius


def torque_remark(design: DriveDesign) -> str | None:
    """A sentence where the torque counts as none."""
    given, least = 1000.0 * design.load.torque, negligible_torque(design)
    if not 0.0 < given <= least:
        return None
    return (
        f"load.torque = {design.load.torque:g} N·m counts as none: up to {0.001 * least:.3g} N·m it is too small "
        "beside the bending of the flexible spline"
    )


def remarks(design: DriveDesign, derived: Mapping[str, float]) -> list[str]:
    """Sentences about what is allowed and may not be meant. derived : of `derived_geometry`"""
    allowed = design.contact.penetration_tolerance * design.drive.module
    found = [
        f"interference: {name} = {derived[name]:.3g}: teeth overlap before they are loaded, and the drive may jam"
        for name in CLEARANCES
        if derived.get(name, 0.0) < -allowed
    ]
    return [*found, *filter(None, [torque_remark(design)])]
