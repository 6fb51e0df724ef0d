"""Drawings of a drive with its dimensions: along the axis, the teeth at the major axis, the section
of the cup.

The flexible spline is drawn as the wave generator deflects it before it is loaded: an inextensible
ring, whose teeth move as rigid bodies. Profiles, cam and walls are the exact curves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import NamedTuple

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GEARS
from swgpar.geometry.paired_lines import thicknesses
from swgpar.meshing.cup import meridian
from swgpar.meshing.recipe import CupRecipe
from swgpar.presentation.body_curves import body_curves
from swgpar.profiles import ToothProfile

SIZE = 560.0
"""Width of a drawing, pixels; it shrinks with the page."""

Pixels = tuple[float, float]


class FilledPath(NamedTuple):
    """Closed curves as the path of SVG, filled between them in the colour of the body."""

    path: str
    body: str


class DrawnLine(NamedTuple):
    """A line in pixels. style : class of the style sheet"""

    start: Pixels
    end: Pixels
    style: str = "dim"


class Text(NamedTuple):
    """A text at pixels. anchor : which part of it is there"""

    x: float
    y: float
    text: str
    anchor: str = "middle"


@dataclass
class Sheet:
    """Pixels of a drawing and what lies on it: (x, y) in mm is at (left + scale x, top - scale
    y)."""

    scale: float
    left: float
    top: float
    height: float
    width: float = SIZE
    caption: str = ""
    outlines: list[FilledPath] = field(default_factory=list)
    lines: list[DrawnLine] = field(default_factory=list)
    texts: list[Text] = field(default_factory=list)

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Pixels of a point in mm."""
        return self.left + self.scale * x, self.top - self.scale * y

    def outline(self, points: Sequence[np.ndarray], body: str) -> None:
        """Closed curves of a body, each (n, 2) mm, filled between them."""
        path = " ".join(
            "M" + "L".join("{:.2f} {:.2f}".format(*self.at(*p)) for p in curve) + "Z"
            for curve in points
        )
        self.outlines.append(FilledPath(path, body))

    def axis(self, start: Pixels, end: Pixels) -> None:
        """A line of an axis between points in mm."""
        self.lines.append(DrawnLine(self.at(*start), self.at(*end), "axis"))

    def across(self, x1: float, x2: float, y_from: float, y: float, text: str) -> None:
        """A horizontal dimension from x1 to x2 mm at the height y (pixels), with lines from y_from
        mm."""
        (a, start), (b, _) = self.at(x1, y_from), self.at(x2, y_from)
        for x in (a, b):
            self.lines.append(DrawnLine((x, start), (x, y + (4 if y > start else -4)), "thin"))
        self.lines.append(DrawnLine((a, y), (b, y)))
        self.texts.append(Text(0.5 * (a + b), y - 4, text))

    def upright(
        self, y1: float, y2: float, x_from: float, x: float, text: str, anchor: str = "start"
    ) -> None:
        """A vertical dimension from y1 to y2 mm at x (pixels), with lines from x_from mm."""
        (start, a), (_, b) = self.at(x_from, y1), self.at(x_from, y2)
        for y in (a, b):
            self.lines.append(DrawnLine((start, y), (x + (4 if x > start else -4), y), "thin"))
        self.lines.append(DrawnLine((x, a), (x, b)))
        x += 6 if anchor == "start" else -6
        self.texts.append(Text(x, 0.5 * (a + b) + 4, text, anchor))


def draw_drive(design: DriveDesign) -> list[Sheet]:
    """All drawings of a design."""
    curves = body_curves(design.geometry, design.tooth_motion(), design.cam())
    sheets = [_front(design, curves), _teeth(design, curves)]
    return [*sheets, _meridian(design)] if design.has_cup else sheets


def _front(design: DriveDesign, curves: dict[str, list[np.ndarray]]) -> Sheet:
    outer = design.geometry.outer_radius
    sheet = Sheet(215.0 / outer, 250.0, 265.0, 545.0)
    for name, closed in curves.items():
        sheet.outline(closed, name)
    reach = 1.04 * outer
    sheet.axis((-reach, 0.0), (reach, 0.0))
    sheet.axis((0.0, -reach), (0.0, reach))
    cam = np.concatenate(curves["wave_generator"])
    width, low, high = float(cam[:, 0].max()), float(cam[:, 1].min()), float(cam[:, 1].max())
    sheet.across(-outer, outer, 0.0, 20.0, f"⌀ {2 * outer:.4g}")
    sheet.across(-width, width, 0.0, 525.0, f"cam {2 * width:.5g}")
    sheet.upright(low, high, 0.0, 478.0, f"{high - low:.5g}")
    drive = design.drive
    sheet.caption = (
        f"Along the axis, in mm: {drive.teeth_fs} teeth of the flexible spline (bore "
        f"{2 * design.inner_radius:.5g}), {drive.teeth_rg} of the ring gear, module "
        f"{drive.module:g}, deflection {design.deflection:.4g}; "
        f"{design.wave_generator.type.replace('_', ' ')} cam. Before it is loaded."
    )
    return sheet


def _teeth(design: DriveDesign, curves: dict[str, list[np.ndarray]]) -> Sheet:
    pitch = np.pi * design.drive.module
    spline, ring = (design.profile(gear) for gear in GEARS)
    low = design.major_semi_axis - 0.3 * pitch
    high = ring.r_root_circle + min(design.ring_gear.rim, 0.5 * pitch)
    half = max(1.6 * pitch, 0.5 * (high - low))
    scale = 0.5 * (SIZE - 210.0) / half
    sheet = Sheet(scale, 0.5 * SIZE, 25.0 + scale * high, 50.0 + scale * (high - low))
    for name, closed in curves.items():
        near = [curve for curve in closed if _near(curve, half).any()]
        if near and name != "housing":  # which is beyond the window
            sheet.outline([_cut(curve, half, low, high) for curve in near], name)
    # dimensions of the spline are drawn where its tooth is deflected to
    moved, edge = 0.5 * design.deflection, SIZE - 90.0
    root, tip = spline.r_root_circle + moved, spline.r_tip_circle + moved
    rim = f"{design.flexible_spline.rim:.4g} rim"
    sheet.upright(root, tip, 0.0, edge, f"{_height(spline):.4g} spline")
    sheet.upright(design.major_semi_axis, root, 0.0, edge, rim)
    depth = f"{_height(ring):.4g} ring"
    sheet.upright(ring.r_tip_circle, ring.r_root_circle, -half, 90.0, depth, "end")
    sheet.caption = (
        f"Teeth at the major axis, in mm: {design.flexible_spline.profile.type.replace('_', ' ')} "
        f"on {design.ring_gear.profile.type.replace('_', ' ')}, backlash "
        f"{max(round(design.backlash, 6), 0.0):.3g} at the pitch circle, face width "
        f"{design.drive.face_width:g}."
    )
    return sheet


def _height(profile: ToothProfile) -> float:
    return abs(profile.r_tip_circle - profile.r_root_circle)


def _near(curve: np.ndarray, half: float) -> np.ndarray:
    """Which points (n,) of a curve are at the top of a drive, in the window or beside it."""
    return (np.abs(curve[:, 0]) < 1.3 * half) & (curve[:, 1] > 0.0)


def _cut(curve: np.ndarray, half: float, low: float, high: float) -> np.ndarray:
    """The part of a closed curve at the top of a drive, closed below the window and clipped to
    it."""
    curve = np.roll(curve, -int(curve[:, 1].argmin()), axis=0)
    near = curve[_near(curve, half)]
    below = np.array([[near[-1, 0], low], [near[0, 0], low]])
    return np.clip(np.concatenate([near, below]), [-half, low], [half, high])


def _meridian(design: DriveDesign) -> Sheet:
    cup, wall, width = design.cup, design.cup_sizes.wall, design.drive.face_width
    spline, ring = (design.profile(gear) for gear in GEARS)
    geometry = design.geometry
    outer, ring_outer = geometry.outer_radius, geometry.gears["ring_gear"].outer_radius
    back = 0.5 * width
    end, length = back + cup.length, width + wall.farthest - back
    top = max(outer, wall.edge)
    scale = min((SIZE - 150.0) / length, 420.0 / top)
    sheet = Sheet(scale, 60.0 + scale * back, 55.0 + scale * top, 100.0 + scale * top)
    recipe = CupRecipe(
        cylinder=48 if cup.contour else 1, fillet=24, closed_end=48 if cup.end_contour else 1
    )
    lines = meridian(geometry.cup, recipe)
    tip, bore = spline.r_tip_circle, design.inner_radius
    tooth = [[tip, back], [tip, -back], [bore, -back]]
    boxes = {
        "ring_gear": (ring.r_tip_circle, ring_outer, back),
        "wave_generator": (0.0, bore, 0.5 * design.wave_generator.width),
    }
    if design.housing:
        boxes = {"housing": (ring_outer, outer, back)} | boxes
    for name, (r1, r2, reach) in boxes.items():
        sheet.outline([np.array([[-reach, r1], [reach, r1], [reach, r2], [-reach, r2]])], name)
    body = np.concatenate([lines.inner, lines.outer[::-1], tooth])
    sheet.outline([body[:, ::-1]], "flexible_spline")
    sheet.axis((-0.6 * width, 0.0), (wall.farthest + 0.1 * length, 0.0))
    sheet.across(-back, back, outer, 22.0, f"{width:g}")
    sheet.across(back, end, lines.outer[0, 0], 44.0, f"{cup.length:g}")
    edge = "flange" if wall.outwards else "bore"
    sheet.upright(
        0.0,
        wall.edge,
        wall.faces_at(wall.edge)[1],
        sheet.at(back + length - width, 0.0)[0] + 14.0,
        f"{edge} r {wall.edge:g}",
    )
    sheet.upright(0.0, bore, -back, 40.0, f"r {bore:.4g}", "start")
    if cup.attachment != "edge":
        _draw_attachment(sheet, design)
    lowest = min(point.radius for point in design.cup_sizes.points)
    x, y = sheet.at(back + 0.5 * cup.length, lowest)
    inside = "" if cup.inside_radius is None else f", inside r {cup.inside_radius:g}"
    wall_text = f"wall {_thicknesses(design)}, fillet r {cup.fillet_radius:g}{inside}"
    sheet.texts.append(Text(x, y + 18.0, wall_text))
    sheet.height = sheet.at(0.0, 0.0)[1] + 20.0
    micro = design.micro_geometry
    on_ring = f", of the ring gear {micro.rg_crowning:g}" if micro.rg_crowning else ""
    sheet.caption = (
        "Half section, in mm, undeformed, teeth without their backlash. Micro-geometry: cam "
        f"crowning {micro.wg_crowning:g}, slope {micro.wg_slope:g}; flank crowning "
        f"{micro.fs_crowning:g}{on_ring}."
    )
    return sheet


def _thicknesses(design: DriveDesign) -> str:
    """Thickness of the wall in words: where it changes from place to place, with that of the closed
    end or flange."""
    sizes = design.cup_sizes
    along = thicknesses(sizes.points)
    wall = " / ".join(f"{thickness:.3g}" for thickness, _ in groupby(along))
    end = " / ".join(f"{of:.3g}" for of, _ in groupby(thicknesses(sizes.wall.plate_points)))
    if sizes.end_thickness == along[-1] and not sizes.section.end_contour:
        return wall
    return f"{wall}, {'flange' if sizes.wall.outwards else 'end'} {end}"


def _draw_attachment(sheet: Sheet, design: DriveDesign) -> None:
    """Radius of the clamped ring, or the axis of a bolt with its circle."""
    cup, wall = design.cup, design.cup_sizes.wall
    near, far = wall.faces_at(cup.clamping_radius or 0.5 * cup.bolt_circle)
    x = sheet.at(near, 0.0)[0] - 14.0
    if cup.attachment == "clamped":
        text = f"clamped r {cup.clamping_radius:g}"
        sheet.upright(0.0, cup.clamping_radius, near, x, text, "end")
        return
    radius = 0.5 * cup.bolt_circle
    (x1, y), (x2, _) = sheet.at(near, radius), sheet.at(far, radius)
    sheet.lines.append(DrawnLine((x1 - 12.0, y), (x2 + 12.0, y), "axis"))
    text = f"{cup.bolts} bolts ⌀ {cup.washer_diameter:g}, circle ⌀ {cup.bolt_circle:g}"
    sheet.upright(0.0, radius, near, x, text, "end")
