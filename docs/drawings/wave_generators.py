"""Bearing between cam and flexible spline, clearance of a cam, and two discs along the axis."""

from __future__ import annotations

import numpy as np
from _drafting import (
    CAM,
    INK,
    NOTE,
    RING,
    SPLINE,
    angle_mark,
    arc,
    axis_line,
    canvases,
    dimension,
    label,
    leader,
    plane_with,
    run,
)
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.bearing import ball_lines
from swgpar.geometry.cams.rollers import RollerCam

BEARING = {"balls": 20, "ball_diameter": 2.2, "race_thickness": 0.7, "first_ball": 6.0}
"""Sizes on a drive of 40 and 42 teeth, so few that the bearing shows."""


def small(cam: dict[str, object]) -> DriveDesign:
    """The plane reference drive with 40 and 42 teeth on this cam."""
    teeth = {"teeth_fs": 40, "teeth_rg": 42}
    return plane_with(drive=teeth, wave_generator={"face_width": 10.0, **cam})


def closed(points: np.ndarray) -> np.ndarray:
    """A closed curve (n + 1, 2) through points (n, 2)."""
    return np.concatenate([points, points[:1]])


def inside(design: DriveDesign, depth: float) -> np.ndarray:
    """Curve (n, 2) mm at a depth, mm, inside of the cam's curve."""
    outline = design.cam().outline(720)
    _, normal, _ = design.cam().evaluate(outline)
    return closed(outline - depth * normal)


def across(ax: Axes) -> None:
    """The bearing, seen along the axis."""
    design = small({"type": "elliptical", "bearing": BEARING})
    keys, sizes = design.bearing, design.bearing_sizes
    ax.fill(*inside(design, -design.flexible_spline.rim).T, fc=SPLINE, alpha=0.5, ec=INK, lw=0.6)
    ax.fill(*inside(design, 0.0).T, fc=RING, ec=INK, lw=0.6)
    ax.fill(*inside(design, keys.race_thickness).T, fc="white", ec=INK, lw=0.6)
    cam = inside(design, keys.race_thickness + keys.ball_diameter)
    ax.fill(*cam.T, fc=CAM, ec=INK, lw=0.6)
    turn = np.radians(keys.first_ball) + 2.0 * np.pi * np.arange(keys.balls) / keys.balls
    centres, _, _ = ball_lines(design.cam(), sizes.centre_depth, turn)
    for centre in centres:
        ax.add_patch(Circle(tuple(centre), 0.5 * keys.ball_diameter, fc="white", ec=INK, lw=0.8))
    far = design.major_semi_axis + 2.0
    axis_line(ax, (0.0, -far), (0.0, far))
    axis_line(ax, (-far, 0.0), (far, 0.0))
    middle = float(np.hypot(*centres[0]))
    angle_mark(ax, (0.0, 0.0), 0.62 * middle, 90.0, 90.0 + keys.first_ball, "first_ball", out=1.15)
    ax.plot(*np.transpose([(0.0, 0.0), centres[0]]), color=NOTE, lw=0.6)
    k = 17
    out = centres[k] / np.hypot(*centres[k])
    leader(ax, tuple(centres[k] + 8.5 * out), "ball_diameter", tuple(centres[k]))
    at = np.array([-0.71, 0.71])
    surface = inside(design, 0.5 * keys.race_thickness)
    race = surface[np.argmax(surface @ at)]
    leader(ax, tuple(race + 6.5 * at), "race_thickness", tuple(race))
    label(ax, (0.0, -5.0), "cam with the inner race,\nrigid", color=INK)
    ax.set_title("wave_generator.bearing", fontsize=10)


def along(ax: Axes) -> None:
    """A section through one ball: conformities and widths."""
    diameter, inner, outer, width = 2.2, 0.56, 0.60, 4.6
    race, rim = 0.7, 0.8
    ax.add_patch(Rectangle((-2.8, 1.1 + race), 5.6, rim, fc=SPLINE, alpha=0.5, ec=INK, lw=0.6))
    for sign, radius, fc, depth in ((1.0, outer, RING, race), (-1.0, inner, CAM, 2.4)):
        r = radius * diameter
        groove = arc((0.0, sign * (0.5 * diameter - r)), r, 90.0 - 38.0, 90.0 + 38.0)
        groove = groove if sign > 0.0 else groove * (1.0, -1.0)
        y = sign * (0.5 * diameter + depth)
        half = 0.5 * width
        edge = [(-half, groove[-1, 1]), (-half, y), (half, y), (half, groove[0, 1])]
        ax.fill(*np.concatenate([groove, edge]).T, fc=fc, ec=INK, lw=0.6)
        to = groove[20]
        name = "outer_conformity" if sign > 0.0 else "inner_conformity"
        leader(ax, (3.6, sign * 0.8), f"groove: {name}\n· ball_diameter", tuple(to))
    ax.add_patch(Circle((0.0, 0.0), 0.5 * diameter, fc="white", ec=INK, lw=0.8))
    dimension(ax, (-0.5 * width, 2.9), (0.5 * width, 2.9), "race_width")
    outside, taper = 0.5 * diameter + race, 0.16
    ends = np.array([(-0.5 * width, outside + taper), (0.5 * width, outside - taper)])
    ax.plot(*ends.T, color=NOTE, lw=0.9)
    leader(ax, (-3.1, 3.4), "race_taper, at the open end", tuple(ends[0]))
    axis_line(ax, (-3.4, -4.0), (3.4, -4.0))
    ax.set_xlim(-3.4, 5.2)
    ax.set_ylim(-4.4, 3.7)
    ax.set_title("section through a ball (grooves exaggerated)", fontsize=10)


def bearing() -> Figure:
    """The bearing across and along the axis."""
    figure, axes = canvases(11.0, 5.4, 1, 2)
    across(axes[0])
    along(axes[1])
    return figure


def offset(ax: Axes) -> None:
    """Cam, its parallel curve, and the undeformed spline."""
    design = small({"type": "elliptical", "offset": 1.5})
    surface, inner = inside(design, 0.0), inside(design, 1.5)
    ax.fill(*surface.T, fc=RING, alpha=0.5, ec=INK, lw=0.8)
    ax.fill(*inner.T, fc=CAM, ec=INK, lw=0.8)
    ring = arc((0.0, 0.0), design.inner_radius, 0.0, 360.0)
    ax.plot(*ring.T, color=SPLINE, lw=0.9, ls="--")
    a, b = design.major_semi_axis, design.minor_semi_axis
    axis_line(ax, (0.0, -a - 2.0), (0.0, a + 2.0))
    axis_line(ax, (-b - 3.0, 0.0), (b + 3.0, 0.0))
    dimension(ax, (0.0, design.inner_radius), (0.0, a), "")
    leader(ax, (7.5, a + 1.4), "deflection", (0.1, 0.5 * (a + design.inner_radius)))
    dimension(ax, (b - 1.5, 0.0), (b, 0.0), "", at=(b, 0.0))
    leader(ax, (b + 2.5, 3.0), "offset", (b - 0.7, 0.1))
    dimension(ax, (-3.0, -a + 1.5), (-3.0, a - 1.5), "major_axis", rotation=90)
    dimension(ax, (-b + 1.5, -4.0), (b - 1.5, -4.0), "minor_axis")
    ax.set_title("surface on the spline: a parallel curve of the cam", fontsize=10)


def discs(ax: Axes) -> None:
    """Two discs beside each other along the axis."""
    design = small({"type": "two_roller", "r_2": 9.0})
    cam = design.cam()
    assert isinstance(cam, RollerCam)
    width, distance = 4.0, 6.0  # the plane model has no axial sizes
    for side in (1.0, -1.0):
        low, middle = side * cam.reach - cam.radius, 0.5 * side * distance
        corner = (middle - 0.5 * width, low)
        ax.add_patch(Rectangle(corner, width, 2.0 * cam.radius, fc=CAM, ec=INK, lw=0.8))
        axis_line(ax, (middle - 3.0, side * cam.reach), (middle + 3.0, side * cam.reach))
        wall = (-7.0, side * design.inner_radius - (1.0 if side < 0.0 else 0.0))
        ax.add_patch(Rectangle(wall, 14.0, 1.0, fc="none", ec=SPLINE, lw=0.9, ls="--"))
    axis_line(ax, (-9.0, 0.0), (9.0, 0.0))
    top = design.major_semi_axis + 2.6
    dimension(ax, (-0.5 * distance, top), (0.5 * distance, top), "distance")
    dimension(ax, (1.0, -top), (5.0, -top), "face_width")
    dimension(ax, (3.0, cam.reach), (3.0, cam.reach + cam.radius), "r_2")
    ax.set_xlim(-9.5, 9.5)
    ax.set_ylim(-top - 1.5, top + 1.5)
    ax.set_title('type = "two_roller" with distance', fontsize=10)


def sizes() -> Figure:
    """Sizes of cams, and two discs."""
    figure, axes = canvases(11.0, 5.6, 1, 2)
    offset(axes[0])
    discs(axes[1])
    return figure


if __name__ == "__main__":
    run({"bearing": bearing, "cam_sizes": sizes})
