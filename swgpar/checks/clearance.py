"""Clearance of the rigid teeth between the minor axes, for each ring gear."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from swgpar.design.sections import GearName
from swgpar.profiles.mesh_gap import NearestPlace
from swgpar.profiles.rigid_teeth import RigidTeeth

WORDS = {
    "ring_gear": "smallest flank clearance, kinematic (mm)",
    "dynamic_spline": "clearance in the dynamic spline (mm)",
}
"""Names of the clearances in `derived_geometry`."""

TAKEN_UP = 2e-3
"""Overlap over the module that teeth take up by their deflection: for a pair of steel teeth, of
some 14 N/(mm µm), with 28 N/mm at a module of 1 mm, which is of the order of rated loads."""


@dataclass(frozen=True)
class Clearance:
    """Smallest distance of the undeformed teeth from those of the gear `ring`.

    allowed : mm, the overlap that the teeth take up, below 0
    """

    ring: GearName
    nearest: NearestPlace
    allowed: float

    @property
    def overlaps(self) -> bool:
        """Whether teeth overlap by more than they take up."""
        return self.nearest.distance < self.allowed

    @property
    def angle_deg(self) -> float:
        """Angle of the tooth from the tip of the lobe, degrees."""
        return float(np.degrees(self.nearest.psi))

    @property
    def place(self) -> str:
        """Where it is."""
        return (
            f"{abs(self.angle_deg):.1f}° from the tip of a lobe, {self.nearest.spline} of the "
            f"flexible spline to {self.nearest.ring} of the {self.ring.replace('_', ' ')}"
        )

    @property
    def remark(self) -> str:
        """A sentence where teeth overlap, else an empty one."""
        if not self.overlaps:
            return ""
        return (
            f"interference: {WORDS[self.ring]} = {self.nearest.distance:.3g}, {self.place}: teeth "
            "overlap before they are loaded, and the drive may jam"
        )


def clearances(teeth: Mapping[GearName, RigidTeeth]) -> list[Clearance]:
    """Of the flexible spline in each ring gear. teeth : of both, by the name of the ring gear"""
    return [
        Clearance(ring, pair.nearest_place(), -TAKEN_UP * pair.module)
        for ring, pair in teeth.items()
    ]


def smallest_clearance(teeth: Mapping[GearName, RigidTeeth]) -> Clearance:
    """Of the flexible spline in all ring gears. teeth : of both, by the name of the ring gear"""
    return min(clearances(teeth), key=lambda one: one.nearest.distance)
