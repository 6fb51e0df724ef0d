"""Sizes of a drive from which its meshes are made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from swgpar.geometry.cup_wall import CupWall, decay_length
from swgpar.profiles import ToothProfile

THICK_CUP = 0.85
"""Cup over rim thickness above which the cup continues the layers below the root as well."""


@dataclass(frozen=True)
class GearGeometry:
    """A gear.

    profile : exact flank;  rim : mm, thickness below the root circle;  ends : mm, of teeth along z
    """

    profile: ToothProfile
    rim: float
    ends: tuple[float, float]

    @property
    def outer_radius(self) -> float:
        """Outer radius (mm) of a ring gear, without a housing."""
        return self.profile.r_root_circle + self.rim


@dataclass(frozen=True)
class CupGeometry:
    """The cup behind the teeth of the flexible spline.

    wall : its section;  thickness_coef : thickness at the back of the teeth over that of the rim
    back_fillet : mm, radius at the back of the teeth;  clamping_radius : mm, of a clamped ring, or
    None
    attached_ring : mm, radii between which closed end or flange is clamped or bolted, or None
    """

    wall: CupWall
    thickness_coef: float
    back_fillet: float
    clamping_radius: float | None
    attached_ring: tuple[float, float] | None

    @property
    def has_washers(self) -> bool:
        """Whether closed end or flange is bolted."""
        return self.attached_ring is not None and self.clamping_radius is None

    @property
    def continues_root(self) -> bool:
        """Whether the wall continues the layers of elements below the root as well."""
        return self.thickness_coef > THICK_CUP


@dataclass(frozen=True)
class FlankCrowning:
    """Crowning of the flexible spline's flanks: mm at |z| = width / 2, curve (see `crowning`)."""

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

    @property
    def cup_thickness(self) -> float:
        """Thickness (mm) of the wall at the back of the teeth; that of the rim without a cup."""
        share = 1.0 if self.cup is None else self.cup.thickness_coef
        return share * self.gears["flexible_spline"].rim

    @property
    def wall_decay(self) -> float:
        """Length (mm) over which a disturbance of the wall decays at the back of the teeth."""
        return decay_length(self.inner_radius, self.cup_thickness)

    @property
    def outer_radius(self) -> float:
        """Outer radius of the ring gear, mm, or of its housing."""
        return self.gears["ring_gear"].outer_radius + self.housing

    @property
    def largest_radius(self) -> float:
        """Largest radius of any part of the drive, mm: ring gears, housing, wall and flange."""
        rings = [gear.outer_radius for gear in self.gears.values() if not gear.profile.external]
        radii = [self.outer_radius, *rings]
        if self.cup is not None:
            radii += [self.cup.wall.edge, float(self.cup.wall.outer.points[:, 1].max())]
        return max(radii)
