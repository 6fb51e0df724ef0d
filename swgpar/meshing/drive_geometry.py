"""Sizes of a drive from which its meshes are made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from swgpar.geometry.arrays import Floats
from swgpar.geometry.cup_wall import CupWall, decay_length
from swgpar.geometry.micro_geometry import NO_CROWNING, FlankCrowning
from swgpar.profiles import ToothProfile

THICK_CUP = 0.85
"""Cup over rim thickness above which the cup continues the layers below the root as well."""


@dataclass(frozen=True)
class GearGeometry:
    """A gear.

    profile : exact flank;  rim : mm, thickness below the root circle;  ends : mm, of teeth along z
    crowning : of its flanks
    """

    profile: ToothProfile
    rim: float
    ends: tuple[float, float]
    crowning: FlankCrowning = NO_CROWNING

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
    def plate_length(self) -> float:
        """Length (mm) of closed end or flange from the fillet to the edge, see `CupWall`."""
        return float(self.wall.plate_scale[1][-1])

    def plate_length_at(self, radius: Floats) -> Floats:
        """Lengths (n,) mm from the fillet to radii (n,) mm of closed end or flange."""
        way, _ = self.wall.on_plate(radius, np.zeros_like(radius))
        lengths: Floats = np.interp(way, *self.wall.plate_scale)
        return lengths

    def plate_stations(self, usual: Floats) -> Floats:
        """Ways (n,) mm from the fillet of stations on closed end or flange, among them its corners.
        The edges of what is attached stay.

        usual : (m,) mm, lengths from 0 to `plate_length`
        """
        plate = self.wall.plate
        if not any(np.ptp(line.points[:, 1]) for line in (plate.inner, plate.outer)):
            return usual  # flat: to the last bit those without a contour
        ways = np.interp(usual, *self.wall.plate_scale[::-1])
        return plate.stations(ways, np.append(ways[:1], self.ring_ways))

    @property
    def ring_ways(self) -> Floats:
        """Ways (n,) mm from the fillet to the edges of what is attached, but for those at the edge
        of closed end or flange."""
        ring = np.array(self.attached_ring or ())
        ways, _ = self.wall.on_plate(ring, np.zeros_like(ring))
        return ways[ways < self.wall.plate.length]

    @cached_property
    def beside_ring(self) -> tuple[float, float] | None:
        """Thicknesses (mm) of closed end or flange at both edges of what is attached."""
        if self.attached_ring is None:
            return None
        low, high = self.attached_ring
        return self.wall.thickness_at(low), self.wall.thickness_at(high)

    @property
    def continues_root(self) -> bool:
        """Whether the wall continues the layers of elements below the root as well."""
        return self.thickness_coef > THICK_CUP


@dataclass(frozen=True, kw_only=True)
class DriveGeometry:
    """A drive.

    gears : by name, the flexible spline first
    module, face_width, cam_width : mm;  inner_radius : mm, of the undeformed flexible spline
    cup : None without one
    housing : mm, thickness of that around the ring gear; 0 without one
    """

    model: Literal["cup", "plane", "pancake"]
    gears: Mapping[str, GearGeometry]
    module: float
    face_width: float
    cam_width: float
    inner_radius: float
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
