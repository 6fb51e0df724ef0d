"""Checks that the sizes of the cup fit each other: its wall, contour, closed end or flange.

The mesh of the wall (`swgpar.meshing.cup`) and its section (`swgpar.geometry.cup_wall`) rely on
them.
"""

from __future__ import annotations

import numpy as np

from swgpar.design.cup_section import Cup
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.geometry.drive_geometry import THICK_CUP

THINNEST = 0.1
"""Thickness of a wall over that of the rim, at least."""

SMALLEST_FILLET = 1.05
"""Radius of the fillet over the thicknesses beside it, at least: its other side is an arc of the
difference."""

NARROWEST = 0.1
"""Width of the attached area over the thickness of closed end or flange, at least: points on it are
counted."""

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
    if design.solver.condensed_sectors:
        raise InputError(
            "solver.condensed_sectors = true is out of range: allowed only with drive.model = "
            '"plane"'
        )
    if cup is None:
        raise InputError('cup is missing: allowed only with drive.model = "plane"')
    if cup.length <= cup.fillet_radius:
        _refuse("cup.length", cup.length, f"above {cup.fillet_radius:g} mm (cup.fillet_radius)")
    _check_shape(cup)
    _check_contour(design, cup)
    _check_end(design, cup)
    _check_back(design, cup)
    _check_attachment(design, cup)
    if cup.attachment == "bolted":
        _check_bolted(design)


def _refuse(key: str, value: float, allowed: str) -> None:
    raise InputError(f"{key} = {value:g} is out of range: allowed {allowed}")


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


def _check_contour(design: DriveDesign, cup: Cup) -> None:
    """Every point lies behind the one before, and no surface is steeper than 45 degrees."""
    length, least = cup.length - cup.fillet_radius, THINNEST * design.flexible_spline.rim
    points = design.cup_sizes.points
    for k, (point, before) in enumerate(zip(cup.contour, points, strict=False), 1):
        key, (start, inner, thickness, _) = f"cup.contour.{k}", before
        if not start + least <= point.distance * ROUND_OFF or point.distance > length * ROUND_OFF:
            limits = (
                f"{start + least:g} ({THINNEST:g} rims behind the point before) to {length:g} mm "
                f"(the fillet)"
            )
            _refuse(f"{key}.distance", point.distance, limits)
        step, radius = (point.distance - start) * ROUND_OFF, points[k][1]
        steep = f"no steeper than 45 degrees from {start:g} mm on"
        if abs(radius - inner) > step:
            _refuse(
                f"{key}.radius",
                radius,
                f"{max(inner - step, 0.0):.5g} to {inner + step:.5g} mm ({steep})",
            )
        low, high = max(inner + thickness - step - radius, least), inner + thickness + step - radius
        if not low <= point.thickness <= high:
            _refuse(
                f"{key}.thickness",
                point.thickness,
                f"{low:.5g} to {high:.5g} mm ({steep}, {THINNEST:g} rims)",
            )
    wall = design.cup_sizes.wall
    most = np.minimum(wall.inner.largest_rounding(), wall.outer.largest_rounding())
    for k, point in enumerate(cup.contour, 1):
        limit = (
            most[k - 1] if k <= len(most) else 0.0
        )  # the last point may be where the fillet begins
        if point.rounding > limit * ROUND_OFF:
            _refuse(
                f"cup.contour.{k}.rounding",
                point.rounding,
                f"0 to {limit:.4g} mm (half of the shorter side)",
            )


def _check_end(design: DriveDesign, cup: Cup) -> None:
    """Fillet and closed end or flange."""
    wall = design.cup_sizes.wall
    smallest = SMALLEST_FILLET * wall.thickness
    if cup.fillet_radius * ROUND_OFF < smallest:
        limits = f"{smallest:g} ({SMALLEST_FILLET:g} times the cup's thickness) to inf mm"
        _refuse("cup.fillet_radius", cup.fillet_radius, limits)
    least, most = THINNEST * design.flexible_spline.rim, cup.fillet_radius / SMALLEST_FILLET
    if not least <= wall.end_thickness <= most * ROUND_OFF:
        limits = (
            f"{least:g} ({THINNEST:g} rims) to {most:g} mm (cup.fillet_radius over "
            f"{SMALLEST_FILLET:g})"
        )
        _refuse("cup.end_thickness", wall.end_thickness, limits)
    begin, _ = wall.center
    if wall.outwards and cup.flange_radius <= begin:
        _refuse(
            "cup.flange_radius",
            cup.flange_radius,
            f"above {begin:g} mm (the flange outside cup.fillet_radius)",
        )
    if not wall.outwards and cup.inner_radius >= begin:
        limits = f"above 0 to below {begin:g} mm (the closed end inside cup.fillet_radius)"
        _refuse("cup.inner_radius", cup.inner_radius, limits)


def _check_back(design: DriveDesign, cup: Cup) -> None:
    """Face width and fillet at the back of the teeth."""
    # narrower splines leave the ring gear's width (docs/verification/stability.md)
    narrowest = max(design.axial_travel, 0.5 * design.flexible_spline.rim)
    if design.drive.face_width < narrowest:
        allowed = f"{narrowest:.4g} mm (axial travel of the teeth, half of the rim) to inf mm"
        _refuse("drive.face_width", design.drive.face_width, allowed)
    step = (
        design.flexible_spline.rim - design.cup_thickness
        if cup.thickness_coef <= THICK_CUP
        else 0.0
    )
    most = min(step, 0.5 * (cup.length - cup.fillet_radius))
    if cup.back_fillet > most * ROUND_OFF:
        allowed = (
            f"0 to {most:.4g} mm (rim less wall; only 0 with cup.thickness_coef above "
            f"{THICK_CUP:g})"
        )
        _refuse("cup.back_fillet", cup.back_fillet, allowed)
    straight = min(
        line.straight for line in (design.cup_sizes.wall.inner, design.cup_sizes.wall.outer)
    )
    if cup.back_fillet > straight * ROUND_OFF:
        _refuse(
            "cup.back_fillet",
            cup.back_fillet,
            f"0 to {straight:.4g} mm (as far as cup.contour is straight)",
        )


def _check_attachment(design: DriveDesign, cup: Cup) -> None:
    """What is attached lies on the flat part of closed end or flange; washers lie beside each
    other."""
    begin, _ = design.cup_sizes.wall.center
    low, high = sorted((begin, cup.edge))
    flat = f"the flat part of the {'flange' if cup.shape == 'hat' else 'closed end'}"
    narrowest = NARROWEST * design.cup_sizes.end_thickness
    if cup.attachment == "clamped":
        radius = cup.clamping_radius
        if not low <= radius <= high or abs(cup.edge - radius) < narrowest:
            allowed = f"{low:g} to {high:g} mm ({flat}), {narrowest:g} mm or more from its edge"
            _refuse("cup.clamping_radius", radius, allowed)
    if cup.attachment == "bolted":
        washer, circle = cup.washer_diameter, cup.bolt_circle
        if not narrowest <= washer <= (high - low) * ROUND_OFF:
            _refuse("cup.washer_diameter", washer, f"{narrowest:g} to {high - low:g} mm ({flat})")
        least, most = 2.0 * low + washer, 2.0 * high - washer
        if not least <= circle * ROUND_OFF or circle > most * ROUND_OFF:
            _refuse("cup.bolt_circle", circle, f"{least:g} to {most:g} mm (washers on {flat})")
        if circle * np.sin(np.pi / cup.bolts) < washer:
            most_bolts = int(np.pi / np.arcsin(washer / circle))
            _refuse("cup.bolts", cup.bolts, f"3 to {most_bolts} (washers beside each other)")


def _check_bolted(design: DriveDesign) -> None:
    """With bolts the teeth are not alike: the drive does not repeat after a pitch."""
    where = 'with cup.attachment = "bolted", which does not repeat after a pitch'
    if design.steps.samples:
        raise InputError(
            f"steps.samples = {design.steps.samples} is out of range: allowed only 0 {where}"
        )
    for section in ("fatigue", "losses", "deviations"):
        if getattr(design, section) is not None:
            raise InputError(
                f'[{section}] is not available {where}: allowed with "edge" and "clamped"'
            )
    if design.stiffness is not None and design.stiffness.positions > 1:
        raise InputError(
            f"stiffness.positions = {design.stiffness.positions} is out of range: allowed only 1 "
            f"{where}"
        )
