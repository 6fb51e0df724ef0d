"""Sizes of a drive from which its meshes are made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from swgpar.geometry.cup_wall import CupWall
from swgpar.geometry.profiles import ToothProfile

THICK_CUP = 0.85
"""Cup thickness over rim thickness above which the cup continues the layers below the root as
well."""


@dataclass(frozen=True)
class GearGeometry:
    """A gear.

    profile : exact flank, with the number of teeth;  rim : mm, thickness below the root circle
    ends : mm, of the teeth along z
    """

    profile: ToothProfile
    rim: float
    ends: tuple[float, float]


@dataclass(frozen=True)
class CupGeometry:
    """The cup behind the teeth of the flexible spline.

    wall : its section;  thickness_coef : thickness at the back of the teeth over that of the rim
    back_fillet : mm, radius at the back of the teeth;  clamping_radius : mm, of a clamped ring, or
    None
    """

    wall: CupWall
    thickness_coef: float
    back_fillet: float
    clamping_radius: float | None

    @property
    def continues_root(self) -> bool:
        """Whether the wall continues the layers of elements below the root as well."""
        return self.thickness_coef > THICK_CUP


@dataclass(frozen=True)
class FlankCrowning:
    """Crowning of the flexible spline's flanks: mm at |z| = width / 2, mm, curve ("parabolic" or
    "circular")."""

    amount: float
    width: float
    shape: str


@dataclass(frozen=True, kw_only=True)
class DriveGeometry:
    """A drive.

    gears : by name, the flexible spline first
    module, face_width, cam_width : mm;  inner_radius : mm, of the undeformed flexible spline
    crowning : of the flexible spline;  cup : None without one
    housing : mm, thickness of that around the ring gear; 0 without one
    """

    model: Literal["cup", "plane", "pancake"]
    gears: Mapping[str, GearGeometry]
    module: float
    face_width: float
    cam_width: float
    inner_radius: float
    crowning: FlankCrowning
    cup: CupGeometry | None
    housing: float
