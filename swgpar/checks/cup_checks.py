"""Checks that the sizes of the cup fit each other: its wall, contour, closed end or flange.

The mesh of the wall (`swgpar.meshing.cup`) and its section (`swgpar.geometry.cup_wall`) rely on
them.
"""

from __future__ import annotations

import math

from swgpar.checks.contour_checks import (
    END_NAMES,
    ROUND_OFF,
    THINNEST,
    WALL_NAMES,
    Contour,
    check_contour,
    check_corners,
)
from swgpar.checks.end_checks import check_attachment, check_end_contour
from swgpar.design.cup_section import Cup
from swgpar.design.cup_sizes import CupSizes
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.input.require import require
from swgpar.meshing.drive_geometry import THICK_CUP

SHORTEST_WALL = 0.2
"""Length of the wall between the teeth and its turn in modules, at least: there the columns of the
elements become radial. In cups and hats of 40 to 320 teeth their least scaled Jacobian at 0.2 is
0.15 and more, or not below that at 0.6; at 0.1 it is half in most."""

SMALLEST_FILLET = 1.05
"""Radius of the fillet over the thicknesses beside it, at least: its other side is an arc of the
difference."""

SMALLEST_INSIDE = 0.2
"""Radius of the fillet inside over the thinner of wall and end, at least: stresses grow without a
limit with a sharper one."""

KEYS = (
    ("shape", "cup", ("inner_radius",)),
    ("shape", "hat", ("flange_radius",)),
    ("attachment", "clamped", ("clamping_radius",)),
    ("attachment", "bolted", ("bolts", "bolt_circle", "washer_diameter")),
)
"""Keys of the cup that belong to one choice."""


def check_cup(design: DriveDesign) -> None:
    """Raise InputError for the first size of the cup that does not fit the others."""
    cup = design.cup
    condensed = design.solver.condensed_sectors
    allowed = 'only with drive.model = "plane"'
    require(not condensed, "solver.condensed_sectors", condensed, allowed)
    check_corners("cup.contour", cup.contour, WALL_NAMES)
    check_corners("cup.end_contour", cup.end_contour, END_NAMES)
    sizes, rim = design.cup_sizes, design.flexible_spline.rim
    reach = cup.length - sizes.wall_length
    by = "cup.fillet_radius" if reach == cup.fillet_radius else "end_thickness and inside_radius"
    least = reach + SHORTEST_WALL * design.drive.module
    allowed = (
        f"{least:.6g} mm and more ({SHORTEST_WALL:g} modules, {by}): teeth end before the wall "
        "turns into the closed end or flange, which a smaller drive.face_width leaves room for"
    )
    require(cup.length * ROUND_OFF >= least, "cup.length", cup.length, allowed)
    _check_shape(cup)
    _check_wall(sizes, rim)
    _check_end(sizes, rim)
    if cup.end_contour:
        check_end_contour(sizes, rim)
    # narrower splines leave the ring gear's width (docs/verification/stability.md)
    width, narrowest = design.drive.face_width, max(design.axial_travel, 0.5 * rim)
    allowed = f"{narrowest:.4g} mm (axial travel of the teeth, half of the rim) and more"
    require(width >= narrowest, "drive.face_width", width, allowed)
    _check_back(sizes, rim)
    check_attachment(sizes)
    if cup.attachment == "bolted":
        _check_period(design)


def _check_period(design: DriveDesign) -> None:
    """Angles of a period of teeth and bolts show the teeth at as many places."""
    pitches = design.kinematics.pitches
    steps, stiffness = design.steps, design.stiffness
    counts = {"steps.samples": steps.samples}
    if stiffness is not None:
        counts["stiffness.positions"] = stiffness.positions
    for key, count in counts.items():
        allowed = f"numbers without a common divisor with {pitches}, the pitches in a period of "
        allowed += "teeth and bolts: others show the same places of a tooth again"
        require(not count or math.gcd(count, pitches) == 1, key, count, allowed)
    for section in ("fatigue", "losses"):
        samples, given = steps.samples, getattr(design, section) is not None
        allowed = f"{pitches} and more with [{section}], as many as the pitches in a period of "
        allowed += "teeth and bolts: a stress cycle then has a value at every pitch"
        require(not given or not samples or samples >= pitches, "steps.samples", samples, allowed)


def _check_shape(cup: Cup) -> None:
    """Each shape and each attachment has its keys."""
    for choice, kind, keys in KEYS:
        for key in keys:
            value, chosen = getattr(cup, key), getattr(cup, choice) == kind
            if value is None and chosen:
                raise InputError(f'cup.{key} is missing: it is needed with cup.{choice} = "{kind}"')
            if value is not None and not chosen:
                raise InputError(
                    f"cup.{key} = {value:g} is not available: allowed only with cup.{choice} = "
                    f'"{kind}"'
                )
    preload, friction = cup.bolt_preload, cup.joint_friction
    allowed = 'only with cup.attachment = "bolted"'
    require(preload is None or cup.attachment == "bolted", "cup.bolt_preload", preload, allowed)
    if preload is not None and friction is None:
        raise InputError("cup.joint_friction is missing: it is needed with cup.bolt_preload")
    allowed = "only with cup.bolt_preload"
    require(friction is None or preload is not None, "cup.joint_friction", friction, allowed)


def _check_wall(sizes: CupSizes, rim: float) -> None:
    """Points of the wall."""
    check_contour(
        Contour(
            key="cup.contour",
            given=sizes.section.contour,
            points=sizes.points,
            lines=sizes.wall,
            length=sizes.wall_length,
            first=1,
            names=WALL_NAMES,
            distance=float,
            radius=float,
            least=THINNEST * rim,
            lowest=0.0,
            to="the fillet",
            beside="the wall",
            opposite="inside",
        )
    )


def _check_end(sizes: CupSizes, rim: float) -> None:
    """Fillet and closed end or flange."""
    cup, wall = sizes.section, sizes.wall
    fillet, end, (begin, _) = cup.fillet_radius, wall.end_thickness, wall.center
    least = THINNEST * rim
    if cup.inside_radius is None:
        smallest = SMALLEST_FILLET * wall.thickness
        allowed = (
            f"{smallest:g} mm ({SMALLEST_FILLET:g} times the cup's thickness) and more, smaller "
            "ones with cup.inside_radius"
        )
        require(fillet * ROUND_OFF >= smallest, "cup.fillet_radius", fillet, allowed)
        most = fillet / SMALLEST_FILLET
        allowed = f"{least:g} ({THINNEST:g} rims) to {most:g} mm (cup.fillet_radius over "
        fits = least <= end <= most * ROUND_OFF
        allowed += f"{SMALLEST_FILLET:g}), and thicker ones with cup.inside_radius"
        require(fits, "cup.end_thickness", end, allowed)
    else:
        _check_corner(sizes, least)
    if wall.outwards:
        allowed = f"above {begin:g} mm (the flange outside cup.fillet_radius)"
        require(cup.flange_radius > begin, "cup.flange_radius", cup.flange_radius, allowed)
    else:
        allowed = f"above 0 to below {begin:g} mm (the closed end inside cup.fillet_radius)"
        require(cup.inner_radius < begin, "cup.inner_radius", cup.inner_radius, allowed)


def _check_corner(sizes: CupSizes, least: float) -> None:
    """Radii on both sides of the turn into closed end or flange. least : mm, thickness"""
    cup, end = sizes.section, sizes.end_thickness
    thinner = min(sizes.wall.thickness, end)
    require(end >= least, "cup.end_thickness", end, f"{least:g} mm ({THINNEST:g} rims) and more")
    inside, smallest = cup.inside_radius, SMALLEST_INSIDE * thinner
    allowed = f"{smallest:g} mm ({SMALLEST_INSIDE:g} times the thinner of wall and end) and more"
    require(inside * ROUND_OFF >= smallest, "cup.inside_radius", inside, allowed)
    most = inside + thinner
    allowed = f"0 to {most:g} mm (cup.inside_radius and the thinner of wall and end)"
    require(cup.fillet_radius <= most * ROUND_OFF, "cup.fillet_radius", cup.fillet_radius, allowed)


def _check_back(sizes: CupSizes, rim: float) -> None:
    """Fillet at the back of the teeth."""
    cup, wall = sizes.section, sizes.wall
    key, fillet = "cup.back_fillet", cup.back_fillet
    step = rim - sizes.thickness if cup.thickness_coef <= THICK_CUP else 0.0
    most = min(step, 0.5 * sizes.wall_length)
    thick = f"only 0 with cup.thickness_coef above {THICK_CUP:g}"
    require(fillet <= most * ROUND_OFF, key, fillet, f"0 to {most:.4g} mm (rim less wall; {thick})")
    most = min(wall.inner.straight, wall.outer.straight)
    allowed = f"0 to {most:.4g} mm (as far as cup.contour is straight)"
    require(fillet <= most * ROUND_OFF, key, fillet, allowed)
