"""Sizes of the cup that follow from its section and from those of the teeth."""

from __future__ import annotations

from dataclasses import dataclass

from swgpar.design.cup_section import Cup
from swgpar.geometry.cup_wall import CupWall, EndPoint, end_reach
from swgpar.geometry.paired_lines import WallPoint, ended, rounded_lines
from swgpar.meshing.drive_geometry import CupGeometry


@dataclass(frozen=True)
class CupSizes:
    """The cup behind the teeth.

    section : its keys;  inner_radius, rim : mm, of the undeformed flexible spline
    back : mm, z of the back of the teeth
    """

    section: Cup
    inner_radius: float
    rim: float
    back: float

    @property
    def thickness(self) -> float:
        """Thickness of the wall at the back of the teeth, mm."""
        return self.section.thickness_coef * self.rim

    @property
    def points(self) -> list[WallPoint]:
        """Points of the wall, from the back of the teeth to the fillet."""
        inner, length = self.inner_radius, self.wall_length
        points = [WallPoint(0.0, inner, 0.0, inner + self.thickness, 0.0, 0.0)]
        for p in self.section.contour:
            radius = p.radius or inner
            outer = p.outer_radius or radius + p.thickness
            along = p.outer_distance or p.distance
            rounding = p.rounding if p.outer_rounding is None else p.outer_rounding
            points.append(WallPoint(p.distance, radius, along, outer, p.rounding, rounding))
        return ended(points, length)

    @property
    def end_thickness(self) -> float:
        """Thickness of closed end or flange beside the fillet, mm."""
        cup = self.section
        last = cup.contour[-1].thickness if cup.contour else self.thickness
        return cup.end_thickness or last or self.thickness

    @property
    def end_points(self) -> tuple[EndPoint, ...]:
        """Corners of closed end or flange that are given."""
        points, length = [], self.section.length
        for p in self.section.end_contour:
            far = length - (p.distance or length)
            near = length - p.near_distance if p.near_distance else far + p.thickness
            rounding = p.rounding if p.near_rounding is None else p.near_rounding
            points.append(
                EndPoint(p.radius, far, p.near_radius or p.radius, near, p.rounding, rounding)
            )
        return tuple(points)

    @property
    def wall_length(self) -> float:
        """Distance (mm) from the back of the teeth as far as which the wall goes along the axis."""
        cup = self.section
        return cup.length - end_reach(cup.fillet_radius, cup.inside_radius, self.end_thickness)

    @property
    def rest_plane(self) -> float:
        """z (mm) of the middle of the closed end or flange, where the deflection vanishes."""
        return self.back + self.section.length - 0.5 * self.end_thickness

    @property
    def wall(self) -> CupWall:
        """Section of the wall."""
        cup = self.section
        inner, outer = rounded_lines(self.points)
        return CupWall(
            inner=inner,
            outer=outer,
            back=self.back,
            end=self.back + cup.length,
            fillet=cup.fillet_radius,
            inside=cup.inside_radius,
            end_thickness=self.end_thickness,
            edge=cup.edge,
            outwards=cup.shape == "hat",
            end_contour=self.end_points,
        )

    @property
    def geometry(self) -> CupGeometry:
        """Sizes from which the mesh of the cup is made."""
        cup = self.section
        return CupGeometry(
            self.wall,
            cup.thickness_coef,
            cup.back_fillet,
            cup.clamping_radius,
            cup.attached_ring,
        )
