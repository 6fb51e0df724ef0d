"""Checks of the contour of closed end or flange, and of what is attached to it."""

from __future__ import annotations

import numpy as np

from swgpar.checks.contour_checks import END_NAMES, ROUND_OFF, THINNEST, Contour, check_contour
from swgpar.design.cup_sizes import CupSizes
from swgpar.geometry.cup_wall import CupWall
from swgpar.geometry.paired_lines import SAME, RoundedLine
from swgpar.input.require import require

NARROWEST = 0.1
"""Width of the attached area over the thickness of closed end or flange, at least: points on it are
counted."""

FLAT = 1e-6
"""mm, by which the height of a flat face changes."""

SAMPLES = 200
"""Places on a face, and on the wall, at which is asked whether they meet."""


def check_end_contour(sizes: CupSizes, rim: float) -> None:
    """Raise InputError for the first point of closed end or flange that does not fit."""
    cup, wall = sizes.section, sizes.wall
    begin, side = wall.center[0], 1.0 if wall.outwards else -1.0
    first = sizes.end_points[0]
    given = abs(first.radius - begin) <= SAME  # files of faces begin where the fillet ends
    if given:
        _check_first(sizes)
    contour = Contour(
        key="cup.end_contour",
        given=cup.end_contour[int(given) :],
        points=wall.plate_points,
        lines=wall.plate,
        length=abs(wall.edge - begin),
        first=1 + int(given),
        names=END_NAMES,
        distance=lambda way: begin + side * way,
        radius=lambda height: cup.length - height,
        least=THINNEST * rim,
        lowest=-np.inf,
        to=f"the edge of the {_name(wall)}",
        beside=f"the {_name(wall)}",
        opposite="on the far face",
    )
    check_contour(contour)
    _check_room(sizes, contour)


def _name(wall: CupWall) -> str:
    return "flange" if wall.outwards else "closed end"


def _check_first(sizes: CupSizes) -> None:
    """A point where the fillet ends is the one that is known."""
    wall, point, length = sizes.wall, sizes.end_points[0], sizes.section.length
    for key, height, known, of in (
        ("distance", point.height, 0.0, "cup.length"),
        (
            "near_distance",
            point.near_height,
            wall.end_thickness,
            "cup.length less cup.end_thickness",
        ),
    ):
        allowed = f"{length - known:.7g} mm ({of}) where the fillet ends"
        fits = abs(height - known) < FLAT
        require(fits, f"cup.end_contour.1.{key}", length - height, allowed)
    near, begin = point.near_radius, wall.center[0]
    allowed = f"{begin:.7g} mm, where the fillet ends"
    require(abs(near - begin) < FLAT, "cup.end_contour.1.near_radius", near, allowed)


def _check_room(sizes: CupSizes, contour: Contour) -> None:
    """The near face lies behind the teeth, and does not meet the wall."""
    wall, plate = sizes.wall, sizes.wall.plate
    deepest = max(range(1, len(contour.given) + 1), key=lambda k: contour.points[k].outer_radius)
    by_corner = contour.value(deepest, "outer_radius") is not None
    key = contour.key_of(deepest, "outer_radius" if by_corner else "thickness")
    value = contour.value(deepest, "outer_radius" if by_corner else "thickness")
    way = np.linspace(0.0, plate.length, SAMPLES)
    r, z = wall.off_plate(way, plate.outer.radius(way)).T
    low = float(z.min()) - wall.back
    allowed = (
        f"a near face behind the teeth, where this one is {-low:.4g} mm in front of their back"
    )
    require(low > 0.0, key, value, allowed)
    s = np.linspace(min(low, wall.length), wall.length, SAMPLES)
    line = wall.outer if wall.outwards else wall.inner
    room = (r[:, None] - line.radius(s)) * (1.0 if wall.outwards else -1.0)
    meets = (room <= 0.0) & (s >= z[:, None] - wall.back)
    require(not meets.any(), key, value, "a near face that does not meet the wall")


def _flat(line: RoundedLine) -> list[tuple[float, float]]:
    """Ways (mm) between which a face is flat."""
    return [
        (float(start[0]), float(end[0]))
        for start, end, center in line.pieces()
        if center is None and abs(end[1] - start[1]) < FLAT
    ]


def flat_parts(wall: CupWall) -> list[tuple[float, float]]:
    """Radii (mm) between which both faces of closed end or flange are flat, from the axis on."""
    far, near = (_flat(line) for line in (wall.plate.inner, wall.plate.outer))
    shared = [
        (max(one[0], other[0]), min(one[1], other[1]))
        for one in far
        for other in near
        if min(one[1], other[1]) > max(one[0], other[0])
    ]
    return sorted(_radii(wall, part) for part in shared)


def _radii(wall: CupWall, part: tuple[float, float]) -> tuple[float, float]:
    ends = sorted(float(wall.off_plate(np.array(way), np.zeros(()))[0]) for way in part)
    return ends[0], ends[1]


def check_attachment(sizes: CupSizes) -> None:
    """Raise InputError unless what is attached lies on a flat part of closed end or flange, and
    washers lie beside each other."""
    cup, wall = sizes.section, sizes.wall
    if cup.attachment == "clamped":
        _check_clamped(sizes)
    if cup.attachment == "bolted":
        washer, circle = cup.washer_diameter, cup.bolt_circle
        parts, flat = flat_parts(wall), f"the flat part of the {_name(wall)}"
        if cup.end_contour:
            flat = f"a part of the {_name(wall)} whose faces are both flat"
        narrowest = NARROWEST * wall.thickness_at(0.5 * circle)
        widest = max((high - low for low, high in parts), default=0.0)
        allowed = f"{narrowest:g} to {widest:g} mm ({flat})"
        fits = narrowest <= washer <= widest * ROUND_OFF
        require(fits, "cup.washer_diameter", washer, allowed)
        ranges = [
            (2.0 * low + washer, 2.0 * high - washer)
            for low, high in parts
            if high - low >= washer / ROUND_OFF
        ]
        allowed = " or ".join(f"{least:g} to {most:g}" for least, most in ranges)
        fits = any(
            least <= circle * ROUND_OFF and circle <= most * ROUND_OFF for least, most in ranges
        )
        require(fits, "cup.bolt_circle", circle, f"{allowed} mm (washers on {flat})")
        most_bolts = int(np.pi / np.arcsin(washer / circle))
        allowed = f"3 to {most_bolts} (washers beside each other)"
        fits = circle * np.sin(np.pi / cup.bolts) >= washer
        require(fits, "cup.bolts", cup.bolts, allowed)


def _check_clamped(sizes: CupSizes) -> None:
    """The clamped ring lies on a face that is flat as far as the edge."""
    cup, wall, radius = sizes.section, sizes.wall, sizes.section.clamping_radius
    parts = [part for line in (wall.plate.inner, wall.plate.outer) for part in _flat(line)]
    to_edge = [part[0] for part in parts if part[1] >= wall.plate.length - FLAT]
    flat = f"a face of the {_name(wall)} that is flat as far as its edge"
    require(bool(to_edge), "cup.clamping_radius", radius, f"only with {flat}")
    low, high = _radii(wall, (min(to_edge), wall.plate.length))
    narrowest = NARROWEST * wall.thickness_at(radius)
    if not cup.end_contour:
        flat = f"the flat part of the {_name(wall)}"
    allowed = f"{low:g} to {high:g} mm ({flat}), {narrowest:g} mm or more from its edge"
    fits = low <= radius * ROUND_OFF and radius <= high * ROUND_OFF
    fits = fits and abs(cup.edge - radius) >= narrowest
    require(fits, "cup.clamping_radius", radius, allowed)
