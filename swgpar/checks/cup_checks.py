"""Checks that the sizes of the cup fit each other: its wall, contour, closed end or flange.

The mesh of the wall (`swgpar.meshing.cup`) and its section (`swgpar.geometry.cup_wall`) rely on
them.
"""

from __future__ import annotations

import math

import numpy as np

from swgpar.design.cup_section import Cup
from swgpar.design.cup_sizes import CupSizes
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.geometry.cup_wall import WallPoint
from swgpar.input.require import require
from swgpar.meshing.drive_geometry import THICK_CUP

THINNEST = 0.1
"""Thickness of a wall over that of the rim, at least."""

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

NARROWEST = 0.1
"""Width of the attached area over the thickness of closed end or flange, at least: points on it are
counted."""

STEEP, STEEPEST = 45.0, 80.0
"""Slope (degrees) of a surface, at most: with both corners of a point at the same distance, and
with a corner outside of its own."""

LARGEST_LEAN = 50.0
"""Angle (degrees) of the line between both corners of a point from square to the wall, at most:
elements have these lines as sides."""

KEYS = (
    ("shape", "cup", ("inner_radius",)),
    ("shape", "hat", ("flange_radius",)),
    ("attachment", "clamped", ("clamping_radius",)),
    ("attachment", "bolted", ("bolts", "bolt_circle", "washer_diameter")),
)
"""Keys of the cup that belong to one choice."""

ROUND_OFF = 1.0 + 1e-9
"""Factor on largest values that follow from others."""


def check_cup(design: DriveDesign) -> None:
    """Raise InputError for the first size of the cup that does not fit the others."""
    cup = design.cup
    condensed = design.solver.condensed_sectors
    allowed = 'only with drive.model = "plane"'
    require(not condensed, "solver.condensed_sectors", condensed, allowed)
    _check_corners(cup)
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
    _check_contour(sizes, rim)
    _check_end(sizes, rim)
    # narrower splines leave the ring gear's width (docs/verification/stability.md)
    width, narrowest = design.drive.face_width, max(design.axial_travel, 0.5 * rim)
    allowed = f"{narrowest:.4g} mm (axial travel of the teeth, half of the rim) and more"
    require(width >= narrowest, "drive.face_width", width, allowed)
    _check_back(sizes, rim)
    _check_attachment(sizes)
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


def _check_corners(cup: Cup) -> None:
    """A point has a thickness or a corner outside."""
    for k, point in enumerate(cup.contour, 1):
        key = f"cup.contour.{k}"
        if point.outer_radius is None:
            if point.thickness is None:
                raise InputError(f"{key}.thickness is missing: it is needed without outer_radius")
            allowed = "only with outer_radius"
            require(
                point.outer_distance is None, f"{key}.outer_distance", point.outer_distance, allowed
            )
        else:
            allowed = "only without outer_radius"
            require(point.thickness is None, f"{key}.thickness", point.thickness, allowed)


def _check_contour(sizes: CupSizes, rim: float) -> None:
    """Every point lies behind the one before, and no surface is too steep."""
    cup, wall, points = sizes.section, sizes.wall, sizes.points
    length, least = sizes.wall_length, THINNEST * rim
    for k, (point, before) in enumerate(zip(cup.contour, points, strict=False), 1):
        key, at = f"cup.contour.{k}", point.distance
        first = before.distance + least
        allowed = f"{first:g} ({THINNEST:g} rims behind the point before) to {length:g} mm"
        behind = first <= at * ROUND_OFF and at <= length * ROUND_OFF
        require(behind, f"{key}.distance", at, f"{allowed} (the fillet)")
        corner = points[k]
        if point.outer_radius is None and before.outer_distance == before.distance:
            _check_slopes(f"{key}", corner, before, STEEP, least)
        else:
            _check_slopes(f"{key}", corner, before, STEEPEST, least)
            _check_outside(f"{key}", corner, before, length, least)
    for k, (point, (before, corner, after)) in enumerate(
        zip(cup.contour, _neighbours(points), strict=False), 1
    ):
        if point.outer_radius is not None:
            _check_lean(f"cup.contour.{k}", before, corner, after)
    inside, outside = wall.inner.largest_rounding(), wall.outer.largest_rounding()
    # the last point may be where the fillet begins
    for k, (point, *limits) in enumerate(
        zip(cup.contour, [*inside.tolist(), 0.0], [*outside.tolist(), 0.0], strict=False), 1
    ):
        own = point.outer_rounding is not None
        radii = (point.rounding, point.outer_rounding if own else point.rounding)
        for name, radius, limit in zip(("rounding", "outer_rounding"), radii, limits, strict=True):
            key = f"cup.contour.{k}.{name if own else 'rounding'}"
            allowed = f"0 to {limit:.4g} mm (half of the shorter side)"
            require(radius <= limit * ROUND_OFF, key, radius, allowed)


def _neighbours(points: list[WallPoint]) -> list[tuple[WallPoint, WallPoint, WallPoint]]:
    """Every point behind the first one, between those beside it; the last one has itself."""
    return list(zip(points, points[1:], [*points[2:], points[-1]], strict=False))


def _check_slopes(
    key: str, point: WallPoint, before: WallPoint, degrees: float, least: float
) -> None:
    """Both surfaces between two points. degrees : of the steepest;  least : mm, thickness"""
    steep = float(np.tan(np.radians(degrees))) * ROUND_OFF
    step = (point.distance - before.distance) * steep
    more = "" if degrees == STEEPEST else f", {STEEPEST:g} with outer_distance and outer_radius"
    words = f"no steeper than {degrees:g} degrees from {before.distance:g} mm on{more}"
    low, high = max(before.radius - step, 0.0), before.radius + step
    fits = abs(point.radius - before.radius) <= step
    require(fits, f"{key}.radius", point.radius, f"{low:.5g} to {high:.5g} mm ({words})")
    if degrees == STEEPEST:
        return
    thickness, outer = point.outer_radius - point.radius, before.outer_radius
    low, high = max(outer - step - point.radius, least), outer + step - point.radius
    allowed = f"{low:.5g} to {high:.5g} mm ({words}, {THINNEST:g} rims)"
    require(
        low <= thickness * ROUND_OFF and thickness <= high, f"{key}.thickness", thickness, allowed
    )


def _check_outside(
    key: str, point: WallPoint, before: WallPoint, length: float, least: float
) -> None:
    """The corner outside. length : mm, of the wall;  least : mm, thickness and distance"""
    at, first = point.outer_distance, before.outer_distance + least
    last = length if point.distance < length else point.distance
    low = last if point.distance >= length else first
    fits = low <= at * ROUND_OFF and at <= last * ROUND_OFF
    allowed = f"{low:g} to {last:g} mm (behind the point before, as far as the fillet)"
    require(fits, f"{key}.outer_distance", at, allowed)
    step = (at - before.outer_distance) * float(np.tan(np.radians(STEEPEST))) * ROUND_OFF
    low, high = before.outer_radius - step, before.outer_radius + step
    allowed = f"{low:.5g} to {high:.5g} mm (no steeper than {STEEPEST:g} degrees)"
    fits = low <= point.outer_radius <= high
    require(fits, f"{key}.outer_radius", point.outer_radius, allowed)
    reach = float(np.hypot(*point.across))
    allowed = f"a corner {least:g} mm ({THINNEST:g} rims) or more from that inside"
    require(reach * ROUND_OFF >= least, f"{key}.outer_radius", point.outer_radius, allowed)


def _check_lean(key: str, before: WallPoint, point: WallPoint, after: WallPoint) -> None:
    """The line between both corners is about square to the wall on both sides of it."""
    across = complex(*point.across)
    for other, way in ((before, 1.0), (after, -1.0)):
        for wall in (
            complex(point.distance - other.distance, point.radius - other.radius),
            complex(
                point.outer_distance - other.outer_distance,
                point.outer_radius - other.outer_radius,
            ),
        ):
            if wall == 0.0:
                continue
            lean = 90.0 - float(np.degrees(np.angle(across / (way * wall))))
            if abs(lean) > LARGEST_LEAN:
                raise InputError(
                    f"{key}: the line between its corners leans by {abs(lean):.3g} degrees from "
                    f"square to the wall beside it: allowed up to {LARGEST_LEAN:g} degrees, by "
                    "outer_distance and outer_radius on the bisector of both sides"
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


def _check_attachment(sizes: CupSizes) -> None:
    """What is attached lies on the flat part of closed end or flange; washers lie beside each
    other."""
    cup, (begin, _) = sizes.section, sizes.wall.center
    low, high = sorted((begin, cup.edge))
    flat = f"the flat part of the {'flange' if cup.shape == 'hat' else 'closed end'}"
    narrowest = NARROWEST * sizes.end_thickness
    if cup.attachment == "clamped":
        radius = cup.clamping_radius
        allowed = f"{low:g} to {high:g} mm ({flat}), {narrowest:g} mm or more from its edge"
        fits = low <= radius <= high and abs(cup.edge - radius) >= narrowest
        require(fits, "cup.clamping_radius", radius, allowed)
    if cup.attachment == "bolted":
        washer, circle = cup.washer_diameter, cup.bolt_circle
        allowed = f"{narrowest:g} to {high - low:g} mm ({flat})"
        fits = narrowest <= washer <= (high - low) * ROUND_OFF
        require(fits, "cup.washer_diameter", washer, allowed)
        least, most = 2.0 * low + washer, 2.0 * high - washer
        allowed = f"{least:g} to {most:g} mm (washers on {flat})"
        fits = least <= circle * ROUND_OFF and circle <= most * ROUND_OFF
        require(fits, "cup.bolt_circle", circle, allowed)
        most_bolts = int(np.pi / np.arcsin(washer / circle))
        allowed = f"3 to {most_bolts} (washers beside each other)"
        fits = circle * np.sin(np.pi / cup.bolts) >= washer
        require(fits, "cup.bolts", cup.bolts, allowed)
