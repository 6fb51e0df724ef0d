"""One flank from given points: of a flank, of a whole space between two teeth, or of a whole tooth.

The axis of the gear is the origin. A flank belongs to a tooth on +y, a space or a tooth may lie
anywhere: it is turned to its place by its own axis of symmetry.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from swgpar.errors import InputError
from swgpar.geometry.arrays import Complex, Floats
from swgpar.input.quantities import show
from swgpar.profiles.keys import Points
from swgpar.profiles.polyline import clockwise_from_y, first_crossing, largest_distance

FEWEST = 4
"""Points, at least."""

LOWEST = 0.1
"""Height of the teeth, modules, at least: less is a gear whose axis is not the origin."""

ON_CIRCLE = 1e-7
"""Modules by which points of the top land and of the root land may be off their circle, beside the
tolerance."""

UNLIKE = 1e-3
"""Modules by which both flanks of a space or of a tooth may differ, at least."""

UNLIKE_TOLERANCES = 10.0
"""The same, over the tolerance of the points."""


@dataclass(frozen=True)
class _Gear:
    """What the points have to fit.  name : section of the design file"""

    keys: Points
    n_teeth: int
    external: bool
    module: float
    name: str

    @property
    def half_pitch(self) -> float:
        """Angle from the middle of a tooth to that of a space, rad."""
        return np.pi / self.n_teeth

    def refuse(self, what: str, allowed: str) -> InputError:
        """The sentence that refuses the points."""
        return InputError(f"{self.name}.points {what}: allowed {allowed}")


def place(point: complex) -> str:
    """A point x + i y, mm, in words."""
    return f"({point.real:.6g}, {point.imag:.6g}) mm"


@lru_cache(maxsize=32)
def flank_points(keys: Points, n_teeth: int, external: bool, module: float, name: str) -> Complex:
    """Points x + i y (n,), mm, of the flank at x > 0 of a tooth on +y, from tip to root.

    Raises InputError, with the place, for points that cross themselves, go back, are not
    symmetric, or lie beside the tooth.
    """
    gear = _Gear(keys, n_teeth, external, module, name)
    points = _in_order(gear)
    radius = np.abs(points)
    tip, root = (radius.max(), radius.min()) if external else (radius.min(), radius.max())
    if abs(tip - root) < LOWEST * module:
        raise gear.refuse(
            f"lie within {abs(tip - root):.4g} mm of one radius",
            f"are teeth of {LOWEST * module:.4g} mm and more about the axis of the gear at (0, 0)",
        )
    share = (radius - root) / (tip - root)
    begins, ends = share[0] > 0.5, share[-1] > 0.5
    if begins == ends:
        flank = _half(gear, points, share, space=bool(begins))
    else:
        flank = points if begins else points[::-1]
        if flank.real.mean() < 0.0:
            flank = -np.conj(flank)
    flank = _without_lands(gear, flank)
    _check_course(gear, flank)
    return flank


def _in_order(gear: _Gear) -> Complex:
    """The given points x + i y (n,), mm, without repeated ones; they do not cross themselves."""
    for number, point in enumerate(gear.keys.points, 1):
        if len(point) != 2:
            key = f"{gear.name}.points.{number}"
            raise InputError(f"{key} has {len(point)} numbers: allowed two, x and y")
    points = gear.keys.scale * (np.array(gear.keys.points).reshape(-1, 2) @ (1.0, 1j))
    if len(points) > 1:
        keep = np.append(True, np.abs(np.diff(points)) > 1e-9 * np.abs(points).max())
        points = points[keep]
    if len(points) < FEWEST:
        raise gear.refuse(f"are {len(points)} different points", f"{FEWEST} and more, or a file")
    crossing = first_crossing(points)
    if crossing is not None:
        raise gear.refuse(
            f"cross themselves at {place(crossing)}", "are points in their order along the flank"
        )
    return points


def _half(gear: _Gear, points: Complex, share: Floats, space: bool) -> Complex:
    """The flank of a whole space, or of a whole tooth, from tip to root in its place."""
    noun = "space" if space else "tooth"
    above = share > 0.5
    crossings = np.flatnonzero(above[1:] != above[:-1])
    if len(crossings) != 2:
        raise gear.refuse(
            f"pass the middle of the tooth height {len(crossings)} times",
            "are one flank, one space between two teeth, or one tooth",
        )
    angle = np.unwrap(clockwise_from_y(points))
    sides = [
        angle[k] + (angle[k + 1] - angle[k]) * (0.5 - share[k]) / (share[k + 1] - share[k])
        for k in crossings
    ]
    middle, target = 0.5 * sum(sides), gear.half_pitch if space else 0.0
    points, angle = points * np.exp(1j * (middle - target)), angle - middle
    if sides[0] > sides[1]:
        points, angle = points[::-1], angle[::-1]
    # where the symmetry line is passed between the flanks
    between = np.flatnonzero((angle[1:] >= 0.0) & (angle[:-1] < 0.0))
    cut = int(between[np.argmin(np.abs(between - 0.5 * crossings.sum()))]) + 1
    before, after = points[:cut], points[cut:][::-1]
    # the other flank as its mirror image about the symmetry line
    if space:
        flank, mirrored = before, -np.conj(after) * np.exp(-2j * target)
    else:
        flank, mirrored = after[::-1], -np.conj(before[::-1])
    allowed = max(UNLIKE * gear.module, UNLIKE_TOLERANCES * gear.keys.tolerance)
    apart, at = largest_distance(flank, mirrored)
    if apart > allowed:
        raise gear.refuse(
            f"have two flanks of the {noun} that differ by {apart:.3g} mm at {place(at)}",
            f"up to {allowed:.3g} mm, mirror images about the middle of the {noun}",
        )
    return flank


def _without_lands(gear: _Gear, flank: Complex) -> Complex:
    """The flank (n,) without the points of the top land and of the root land."""
    radius = np.abs(flank)
    off = ON_CIRCLE * gear.module + gear.keys.tolerance
    tip = np.abs(radius - radius[0]) <= off
    root = np.abs(radius - radius[-1]) <= off
    first = len(radius) if tip.all() else int(np.argmin(tip))
    last = int(np.argmin(root[::-1]))
    return flank[max(first - 1, 0) : len(flank) - max(last - 1, 0)]


def _check_course(gear: _Gear, flank: Complex) -> None:
    """From tip to root without a way back, between the middles of tooth and space."""
    inwards = -np.diff(np.abs(flank)) * (1.0 if gear.external else -1.0)
    at = int(inwards.argmin())
    if inwards[at] < -(1e-9 * np.abs(flank[0]) + gear.keys.tolerance):
        raise gear.refuse(
            f"go back towards the tip at {place(flank[at])}",
            "are points in their order from tip to root, each nearer to the root than the last",
        )
    angle = clockwise_from_y(flank)
    for at in (int(angle.argmin()), int(angle.argmax())):
        if not 0.0 < angle[at] < gear.half_pitch:
            raise gear.refuse(
                f"reach {np.degrees(angle[at]):.4g} degrees from the middle of the tooth at "
                f"{place(flank[at])}",
                f"above 0 to below {np.degrees(gear.half_pitch):.4g} (half a pitch), with the "
                "tooth of a single flank on +y",
            )


def heights(
    keys: Points, n_teeth: int, external: bool, module: float, name: str
) -> tuple[float, float]:
    """Addendum and dedendum of the points, mm.

    Raises InputError where the pitch circle does not cross the teeth, beside the reasons of
    `flank_points`.
    """
    flank = flank_points(keys, n_teeth, external, module, name)
    tip, root = float(np.abs(flank[0])), float(np.abs(flank[-1]))
    pitch, side = 0.5 * n_teeth * module, 1.0 if external else -1.0
    if side * (tip - pitch) < -1e-9 * pitch or side * (pitch - root) <= 0.0:
        low, high = sorted((tip, root))
        raise InputError(
            f"{name}.points reach from {low:.6g} to {high:.6g} mm from the axis: allowed are teeth "
            f"that the pitch circle ({show(pitch)} mm) crosses"
        )
    return side * (tip - pitch), side * (pitch - root)
