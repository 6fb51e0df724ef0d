"""The drive with its dimensions: section along the axis, toothed part enlarged, and front view."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from _drafting import (
    CAM,
    INK,
    RING,
    SPLINE,
    angle_mark,
    axis_line,
    dimension,
    extension,
    label,
    leader,
    plane_with,
    reference,
    run,
    turned,
)
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GearName
from swgpar.geometry.cams import EllipticalCam
from swgpar.meshing.cup import meridian
from swgpar.meshing.recipe import load_recipe


def fill(ax: Axes, points: np.ndarray, colour: str, **style: Any) -> None:
    """Closed outline (n, 2), filled."""
    ax.add_patch(
        Polygon(
            points, **{"closed": True, "fc": colour, "ec": INK, "lw": 0.8, "alpha": 0.85, **style}
        )
    )


def parts(design: DriveDesign) -> dict[str, np.ndarray]:
    """Outlines (n, 2) in the plane of z and r, mm, of the undeformed drive; teeth are cut along a
    tooth's middle."""
    recipe = load_recipe("full")
    lines = meridian(design.geometry.cup, recipe.cup)
    inner, outer = lines.inner, lines.outer
    spline, ring = (design.profile(gear) for gear in ("flexible_spline", "ring_gear"))
    half, cam_half = 0.5 * design.drive.face_width, 0.5 * design.wave_generator.face_width
    tip, root = spline.r_tip_circle, spline.r_root_circle
    wall = np.concatenate(
        [[(design.inner_radius, -half)], inner, outer[::-1], [(root, half), (root, -half)]]
    )
    rings = ring.r_tip_circle, ring.r_root_circle, ring.r_root_circle + design.ring_gear.rim

    def box(z0: float, z1: float, r0: float, r1: float) -> np.ndarray:
        return np.array([(z0, r0), (z1, r0), (z1, r1), (z0, r1)])

    return {
        "wall": wall[:, ::-1],
        "tooth": box(-half, half, root, tip),
        "ring tooth": box(-half, half, rings[0], rings[1]),
        "ring": box(-half, half, rings[1], rings[2]),
        "cam": box(-cam_half, cam_half, 0.0, design.inner_radius - 0.5 * design.deflection),
    }


def section() -> Figure:
    """Section of the reference cup drive along its axis, undeformed, upper half."""
    design = reference()
    outline, cup, half = parts(design), design.cup, 0.5 * design.drive.face_width
    figure, ax = plt.subplots(figsize=(9.5, 8.6))
    ax.set_aspect("equal")
    ax.axis("off")
    fill(ax, outline["cam"], CAM)
    fill(ax, outline["wall"], SPLINE)
    fill(ax, outline["tooth"], SPLINE, alpha=0.45)
    fill(ax, outline["ring tooth"], RING, alpha=0.45)
    fill(ax, outline["ring"], RING)
    end, outside = half + cup.length, design.inner_radius + design.cup_sizes.thickness
    axis_line(ax, (-16.0, 0.0), (end + 12.0, 0.0))
    axis_line(ax, (0.0, -3.0), (0.0, 74.0))
    ax.annotate(
        "",
        xy=(end + 13.0, 0),
        xytext=(end + 8.0, 0),
        arrowprops={"arrowstyle": "-|>", "color": INK},
    )
    label(ax, (end + 15.0, 0.0), "z", color=INK, fontsize=10)
    label(ax, (0.0, 75.5), "z = 0, middle of the face width", color=INK)
    label(ax, (0.0, 30.0), "wave\ngenerator", color=INK)
    label(ax, (30.0, 63.5), "flexible spline (cup)", color=INK)
    label(ax, (-15.0, 67.0), "ring gear", color=INK)
    ax.plot([-10.5, -4.5], [66.4, 63.4], color=INK, lw=0.6)
    ax.plot([30.0, 28.0], [62.5, outside], color=INK, lw=0.6)
    # axial dimensions
    for z, top in ((-half, 71.5), (half, 71.5), (end, 71.5)):
        extension(ax, (z, 57.0 if z == end else 64.0), (z, top))
    dimension(ax, (-half, 70.5), (half, 70.5), "$F_w$  drive.face_width", at=(-11.5, 72.3))
    dimension(ax, (half, 70.5), (end, 70.5), "$l_c$  cup.length", at=(0.5 * (half + end), 72.3))
    cam_half = 0.5 * design.wave_generator.face_width
    dimension(ax, (-cam_half, 46.0), (cam_half, 46.0), "", at=(0.0, 46.0))
    leader(ax, (-15.5, 42.0), "wave_generator\n.face_width", (-0.6 * cam_half, 45.9))
    # radii
    dimension(ax, (22.0, 0.0), (22.0, design.inner_radius), "$r_{fs}$ (derived)", rotation=90)
    extension(ax, (half, design.inner_radius), (23.0, design.inner_radius))
    half_bore = 0.5 * cup.inner_radius
    dimension(
        ax,
        (end + 5.0, 0.0),
        (end + 5.0, 2.0 * half_bore),
        "$r_{ci}$  cup\n.inner_radius",
        at=(end + 11.0, half_bore),
    )
    extension(ax, (end - 0.2, cup.inner_radius), (end + 6.0, cup.inner_radius))
    corner = end - cup.fillet_radius, outside - cup.fillet_radius
    touch = (
        corner[0] + cup.fillet_radius * np.sqrt(0.5),
        corner[1] + cup.fillet_radius * np.sqrt(0.5),
    )
    leader(ax, (end + 9.0, 64.0), "$r_{cf}$  cup.fillet_radius\n(outside of the wall)", touch)
    leader(
        ax,
        (38.0, 48.0),
        "$c_c t_r$  cup.thickness_coef\ntimes flexible_spline.rim",
        (33.0, design.inner_radius + 0.3),
    )
    leader(
        ax,
        (38.0, 10.0),
        "closed end: the coupling\nacts on the bore",
        (end - 0.4, cup.inner_radius + 0.3),
    )
    leader(ax, (-16.0, 54.0), "open end", (-half, design.inner_radius + 0.4))
    ax.set_xlim(-22.0, end + 19.0)
    ax.set_ylim(-4.0, 78.0)
    return figure


def teeth() -> Figure:
    """Toothed part of the section, enlarged."""
    design = reference()
    outline, half = parts(design), 0.5 * design.drive.face_width
    spline, ring = (design.profile(gear) for gear in ("flexible_spline", "ring_gear"))
    pitch = [0.5 * n * design.drive.module for n in (design.drive.teeth_fs, design.drive.teeth_rg)]
    figure, ax = plt.subplots(figsize=(9.5, 6.4))
    ax.set_aspect("equal")
    ax.axis("off")
    fill(ax, np.array([(-half, 56.6), (half, 56.6), (half, 57.2), (-half, 57.2)]), CAM)
    for name, colour, alpha in (
        ("wall", SPLINE, 0.85),
        ("tooth", SPLINE, 0.45),
        ("ring tooth", RING, 0.45),
        ("ring", RING, 0.85),
    ):
        fill(ax, outline[name], colour, alpha=alpha)
    label(ax, (0.0, 56.9), "wave generator (at the minor axis)", color=INK)
    label(ax, (0.0, 58.7), "rim of the flexible spline", color=INK)
    label(ax, (0.0, 63.0), "rim of the ring gear", color=INK)
    for radius, text in zip(pitch, ("pitch circle, $N_{fs} m/2$", "pitch circle, $N_{rg} m/2$")):
        ax.plot(
            [-half - 0.3, half + 0.3], [radius, radius], color=INK, lw=0.7, dashes=(12, 3, 2, 3)
        )
        label(ax, (0.0, radius), text, color=INK)
    left, right = -half - 0.6, half + 0.7
    inner, root, tip = design.inner_radius, spline.r_root_circle, spline.r_tip_circle
    for z, radii in (
        (left, (inner, root, tip)),
        (right, (design.inner_radius + design.cup_sizes.thickness,)),
    ):
        for radius in radii:
            extension(ax, (np.sign(z) * half, radius), (z - 0.2 if z < 0 else z + 0.2, radius))
    dimension(
        ax,
        (left, inner),
        (left, root),
        "$t_r$  flexible_spline.rim",
        at=(left - 2.4, 0.5 * (inner + root)),
    )
    text = "$h_d m$  drive.dedendum_coef"
    dimension(ax, (left, root), (left, pitch[0]), text, at=(left - 2.7, 0.5 * (root + pitch[0])))
    text = "$h_a m$  drive.addendum_coef"
    dimension(ax, (left, pitch[0]), (left, tip), text, at=(left - 2.7, 0.5 * (tip + pitch[0])))
    extension(ax, (-half, pitch[0]), (left - 0.2, pitch[0]))
    text = "$c_c t_r$, thickness of the cup"
    dimension(
        ax,
        (right, inner),
        (right, inner + design.cup_sizes.thickness),
        text,
        at=(right + 2.2, inner + 0.35),
        ha="center",
    )
    low, top, out = ring.r_tip_circle, ring.r_root_circle, ring.r_root_circle + design.ring_gear.rim
    for radius in (low, pitch[1], top, out):
        extension(ax, (half, radius), (right + 0.2, radius))
    dimension(
        ax, (right, low), (right, pitch[1]), "$h_a m$", at=(right + 0.7, 0.5 * (low + pitch[1]))
    )
    dimension(
        ax, (right, pitch[1]), (right, top), "$h_d m$", at=(right + 0.7, 0.5 * (top + pitch[1]))
    )
    dimension(ax, (right, top), (right, out), "ring_gear.rim", at=(right + 1.5, 0.5 * (top + out)))
    for z, radius, text in (
        (0.5, root, "$r_D$"),
        (0.5, tip, "$r_A$"),
        (1.5, low, "$r_A$"),
        (1.5, top, "$r_D$"),
    ):
        label(ax, (half - z, radius), text, fontsize=8)
    ax.set_xlim(-half - 6.0, half + 5.0)
    ax.set_ylim(56.4, out + 0.3)
    return figure


def front_design() -> DriveDesign:
    """The reference teeth on 40 and 42 instead of 120 and 122, so that they can be seen."""
    return plane_with(drive={"teeth_fs": 40, "teeth_rg": 42})


def outline_of_gear(design: DriveDesign, gear: GearName, n: int = 24) -> np.ndarray:
    """All teeth of a gear (n_teeth, points, 2), mm, undeformed, tooth 0 of the spline and slot 0 of
    the ring on +y."""
    profile = design.profile(gear)
    flank = profile.point(np.linspace(profile.length, 0.0, n))
    tooth = np.concatenate([flank * (-1.0, 1.0), flank[::-1]])
    phase = 0.0 if gear == "flexible_spline" else np.pi / profile.n_teeth
    angles = -phase - 2.0 * np.pi * np.arange(profile.n_teeth) / profile.n_teeth
    return np.array([turned(tooth, angle) for angle in angles])


def deflected(design: DriveDesign, points: np.ndarray) -> np.ndarray:
    """Points (n, 2) of the undeformed spline on an inextensible ring: w = d/2 cos 2 psi, v = -d/4
    sin 2 psi."""
    r = design.inner_radius + 0.5 * design.flexible_spline.rim
    psi = np.arctan2(-points[:, 0], points[:, 1])
    w, v = 0.5 * design.deflection * np.cos(2 * psi), -0.25 * design.deflection * np.sin(2 * psi)
    tilt = psi + (v + design.deflection * np.sin(2 * psi)) / r
    middle = (r + w) * np.array([-np.sin(psi + v / r), np.cos(psi + v / r)])
    height = np.hypot(*points.T) - r
    return (middle + height * np.array([-np.sin(tilt), np.cos(tilt)])).T


def front() -> Figure:
    """Front view of a drive with 40 and 42 teeth, seen from the closed end, the cup cut away."""
    design = front_design()
    ring, spline = (
        outline_of_gear(design, gear).reshape(-1, 2) for gear in ("ring_gear", "flexible_spline")
    )
    outer = design.profile("ring_gear").r_root_circle + design.ring_gear.rim
    figure, ax = plt.subplots(figsize=(9.0, 8.6))
    ax.set_aspect("equal")
    ax.axis("off")
    circle = np.linspace(0.0, 2.0 * np.pi, 361)
    unit = np.column_stack([np.sin(circle), np.cos(circle)])
    ax.fill(*(outer * unit).T, fc=RING, ec=INK, lw=0.8)
    ax.fill(*ring.T, fc="white", ec=INK, lw=0.7)
    ax.fill(*deflected(design, spline).T, fc=SPLINE, ec=INK, lw=0.7, alpha=0.9)
    ax.fill(*deflected(design, design.inner_radius * unit).T, fc="white", ec=INK, lw=0.6)
    cam = EllipticalCam(design.major_semi_axis, design.minor_semi_axis).outline(720)
    ax.fill(*cam.T, fc=CAM, ec=INK, lw=0.8, alpha=0.75)
    ax.plot(*(design.inner_radius * unit).T, color=INK, lw=0.7, ls="--")
    far = outer + 3.0
    axis_line(ax, (0.0, -far), (0.0, far))
    axis_line(ax, (-far, 0.0), (far, 0.0))
    label(ax, (3.5, far + 0.8), "+y, major axis at 0 degrees", color=INK)
    label(ax, (far + 0.6, 0.0), "+x,\nminor\naxis", color=INK)
    dimension(
        ax, (0.0, 0.0), (0.0, design.major_semi_axis), "a", at=(0.7, 0.55 * design.major_semi_axis)
    )
    dimension(
        ax, (0.0, 0.0), (design.minor_semi_axis, 0.0), "b", at=(0.55 * design.minor_semi_axis, 0.8)
    )
    direction = np.array([np.sin(np.radians(-52.0)), np.cos(np.radians(-52.0))])
    tip = tuple(design.inner_radius * direction)
    dimension(
        ax,
        (0.0, 0.0),
        tip,
        "$r_{fs}$, undeformed",
        at=tuple(0.55 * design.inner_radius * direction),
        rotation=-38,
    )
    angle_mark(ax, (0.0, 0.0), 6.0, 90.0, 128.0, "wave generator\nturns", out=1.45)
    angle_mark(
        ax, (0.0, 0.0), outer + 1.2, 52.0, 40.0, "flexible spline turns\n(ring gear fixed)", out=1.2
    )
    label(ax, (0.0, -0.45 * design.major_semi_axis), "wave generator", color=INK)
    leader(
        ax,
        (-outer - 1.5, -outer + 2.0),
        "ring gear",
        tuple(0.96 * outer * np.array([-0.72, -0.69])),
    )
    inside = design.inner_radius + 0.5
    leader(
        ax, (outer + 1.0, -outer + 2.0), "flexible spline", tuple(inside * np.array([0.69, -0.72]))
    )
    leader(
        ax,
        (-9.5, far),
        "teeth mesh at both\nends of the major axis",
        (-0.8, 0.5 * design.drive.teeth_rg),
    )
    leader(
        ax,
        (far - 0.5, 8.5),
        "teeth are apart\nat the minor axis",
        (0.5 * design.drive.teeth_fs - 0.7, 2.2),
    )
    ax.set_xlim(-far - 1.0, far + 5.5)
    ax.set_ylim(-far - 0.5, far + 1.6)
    return figure


def pancake() -> Figure:
    """The pancake drive: section along its axis, and the rigid tooth of the flexible spline in both
    of its slots."""
    design = reference("pancake")
    figure, (ax, *slots) = plt.subplots(1, 3, figsize=(11.0, 4.4), width_ratios=(1.5, 1.0, 1.0))
    inner, half = design.inner_radius, 0.5 * design.drive.face_width
    names: dict[GearName, str] = {
        "flexible_spline": SPLINE,
        "ring_gear": RING,
        "dynamic_spline": RING,
    }
    cam = design.major_semi_axis
    fill(ax, np.array([(-half, cam - 5.0), (half, cam - 5.0), (half, cam), (-half, cam)]), CAM)
    label(ax, (0.0, cam - 2.5), "wave generator", color=INK)
    for gear, colour in names.items():
        profile, (low, high) = design.profile(gear), design.axial_range(gear)
        lift = 0.5 * design.deflection if gear == "flexible_spline" else 0.0
        ends = (inner + lift, profile.r_tip_circle + lift)
        if gear != "flexible_spline":
            ends = (profile.r_tip_circle, design.geometry.gears[gear].outer_radius)
        box = np.array([(low, ends[0]), (high, ends[0]), (high, ends[1]), (low, ends[1])])
        fill(ax, box, colour, alpha=0.6)
        text = {
            "ring_gear": "ring gear\n122 teeth, fixed",
            "dynamic_spline": "dynamic spline\n120 teeth, output",
        }
        if gear in text:
            label(ax, (0.5 * (low + high), ends[1] - 2.2), text[gear], color=INK)
    outer = max(design.geometry.gears[gear].outer_radius for gear in design.gears[1:])
    label(ax, (0.0, inner + 1.6), "flexible spline, 120 teeth", color=INK)
    label(ax, (0.0, outer + 0.8), "gap", color=INK)
    ax.set(xlim=(-half - 1.0, half + 1.0), ylim=(cam - 5.5, outer + 1.6))
    ax.set(xlabel="z, mm", ylabel="r at the major axis, mm")
    ax.set_aspect("equal")
    _slot(slots[0], design, "ring_gear")
    _slot(slots[1], design, "dynamic_spline")
    figure.tight_layout()
    return figure


def _slot(ax: Axes, design: DriveDesign, ring: GearName) -> None:
    """A slot of a ring gear with the rigid tooth of the flexible spline at angles around the major
    axis."""
    spline, facing = design.profile("flexible_spline"), design.profile(ring)
    flank = facing.point(np.linspace(facing.length, 0.0, 40))
    tooth = np.concatenate([flank * (-1.0, 1.0), flank[::-1]])
    for side in (-1.0, 1.0):
        fill(ax, turned(tooth, side * np.pi / facing.n_teeth), RING)
    angle = np.linspace(-0.05, 0.05, 41)
    circle = np.column_stack([np.sin(angle), np.cos(angle)])
    fill(
        ax,
        np.concatenate(
            [facing.r_root_circle * circle, (facing.r_root_circle + 1.0) * circle[::-1]]
        ),
        RING,
    )
    flank = spline.point(np.linspace(spline.length, 0.0, 40))
    tooth = np.concatenate([flank * (-1.0, 1.0), flank[::-1]])
    motion, psi = design.tooth_motion(ring=ring), np.radians(np.arange(-50.0, 51.0, 10.0))
    pose = motion.pose(psi)
    for c, angle in zip(pose.c, pose.angle, strict=True):
        moved = c + np.exp(1j * angle) * (tooth[:, 0] + 1j * tooth[:, 1])
        ax.plot(moved.real, moved.imag, color=SPLINE, lw=1.0)
    pitch = 0.5 * design.drive.module * design.drive.teeth_rg
    ax.set(
        xlim=(-2.0, 2.0), ylim=(pitch - 2.4, pitch + 1.6), xlabel="mm", title=ring.replace("_", " ")
    )
    ax.set_aspect("equal")


if __name__ == "__main__":
    run(
        {
            "drive_section": section,
            "drive_teeth": teeth,
            "drive_front": front,
            "drive_pancake": pancake,
        }
    )
