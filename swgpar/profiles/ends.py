"""Ends of a flank that is a smooth curve: the edge at the addendum circle, and the root.

A curve from tip to root begins on the addendum circle or beyond it. It is cut there, or where an
arc touches both of them. The root arc touches the curve and the dedendum circle. A curve that ends
before is continued by its tangent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NoReturn

import numpy as np

from swgpar.errors import InputError
from swgpar.geometry.arrays import Floats
from swgpar.geometry.bracketed_root import root_between
from swgpar.profiles.flank import FlankSegment, Segment, ToothProfile

SAMPLES = 257
"""Places of the curve between which the ends are looked for."""

SAME = 1e-9
"""Length over the module that counts as none."""


def with_ends(
    curve: ToothProfile, module: float, r_tip: float, r_root: float, name: str = "profile"
) -> ToothProfile:
    """The flank with an edge, sharp or rounded, and a root.

    curve : its segments lead from tip to root, its circles are those to be reached
    module, r_tip, r_root : mm, radii of the rounded tip edge (0: sharp) and of the root arc
    name : section of the design file, for messages

    Raises InputError where the curve does not reach the addendum circle, or an arc does not fit.
    """
    ends = _Ends(curve, module, name)
    begin, tip = ends.tip(r_tip)
    end, root = ends.root(r_root)
    if end - begin < SAME * module:
        raise InputError(
            f"{name}.r_tip = {r_tip:g} with r_root = {r_root:g} leaves no flank between the arcs: "
            "allowed are smaller radii"
        )
    return replace(curve, segments=(*tip, *_cut(curve, begin, end, SAME * module), *root))


def _cut(curve: ToothProfile, begin: float, end: float, least: float) -> list[FlankSegment]:
    """The segments between two arc lengths, mm; parts shorter than `least` are left out."""
    parts: list[FlankSegment] = []
    for start, segment in zip(curve.breaks[:-1], curve.segments, strict=True):
        first, last = max(begin - start, 0.0), min(end - start, segment.length)
        if last - first > least:
            whole = first == 0.0 and last == segment.length
            parts.append(segment if whole else segment.part(first, last))
    return parts


@dataclass(frozen=True)
class _Ends:
    """Ends of `curve`. module : mm;  name : section of the design file, for messages"""

    curve: ToothProfile
    module: float
    name: str

    def at(self, s: float) -> tuple[complex, complex]:
        """Point, mm, and unit normal out of the tooth, at the arc length s, mm."""
        at = self.curve.at(s)
        return complex(*at.point[0]), complex(*self.curve.normals(at.angle)[0])

    @cached_property
    def _samples(self) -> tuple[Floats, Floats, Floats]:
        """Arc lengths (n,) mm, points and unit normals (n, 2) of the curve."""
        s = np.unique(np.append(np.linspace(0.0, self.curve.length, SAMPLES), self.curve.breaks))
        at = self.curve.at(s)
        return s, at.point, self.curve.normals(at.angle)

    def above(self, s: float, offset: float, radius: float) -> float:
        """How far (mm) towards the tip the point `offset` mm along the normal lies from the circle
        of `radius`, mm."""
        point, normal = self.at(s)
        return self.curve.sign * (abs(point + offset * normal) - radius)

    def passing(self, offset: float, radius: float) -> float | None:
        """First arc length, mm, at which that point passes the circle towards the root; None where
        it never does."""
        s, points, normals = self._samples
        above = self.curve.sign * (np.hypot(*(points + offset * normals).T) - radius)
        if abs(above[0]) < SAME * self.module:
            return 0.0
        passed = np.flatnonzero((above[:-1] > 0.0) & (above[1:] <= 0.0))
        if not passed.size:
            return None
        low, high = s[passed[0]], s[passed[0] + 1]
        return root_between(lambda s: self.above(s, offset, radius), low, high, xtol=1e-14)

    def arc(self, name: str, radius: float, centre: complex, normals: Sequence[complex]) -> Segment:
        """Arc about `centre`, mm, between two unit normals out of the tooth; the root is concave.

        Refused where it would run backwards.
        """
        begin, end = normals
        out = -1.0 if name == "root" else 1.0
        start, curvature = centre + out * radius * begin, -out * self.curve.sign / radius
        length = float(np.angle(end / begin)) / curvature
        if length < -SAME * self.module:
            raise InputError(
                f"{self.name}.r_{name} = {radius:g}: the {name} arc would run backwards: allowed "
                "are other radii"
            )
        direction = float(np.angle(begin / (1j * self.curve.sign)))
        return Segment(name, (start.real, start.imag), direction, curvature, length)

    def tip(self, radius: float) -> tuple[float, list[FlankSegment]]:
        """Where the curve begins, mm, and the arc before it."""
        circle = self.curve.r_tip_circle
        if self.above(0.0, 0.0, circle) < -SAME * self.module:
            reached = abs(self.at(0.0)[0])
            raise InputError(
                f"{self.name}: the flank ends at a radius of {reached:.6g} mm, the addendum circle "
                f"has {circle:.6g} mm: allowed are smaller addenda"
            )
        begin = self.passing(-radius, circle - self.curve.sign * radius)
        if begin is None:
            raise InputError(
                f"{self.name}.r_tip = {radius:g} is out of range: allowed are smaller radii, whose "
                "arc touches the flank and the addendum circle"
            )
        if radius == 0.0:
            return begin, []
        point, normal = self.at(begin)
        centre = point - radius * normal
        along = self.curve.sign * centre / abs(centre)
        return begin, [self.arc("tip", radius, centre, (along, normal))]

    def root(self, radius: float) -> tuple[float, list[FlankSegment]]:
        """Where the curve ends, mm, and what leads from there to the dedendum circle."""
        reach = self.curve.r_root_circle + self.curve.sign * radius
        if self.above(0.0, radius, reach) <= 0.0:
            self.refuse_root(radius)
        end = self.passing(radius, reach)
        point, normal = self.at(self.curve.length if end is None else end)
        line, centre, parts = normal / (1j * self.curve.sign), point + radius * normal, []
        if end is None:
            end = self.curve.length
            along = (np.conj(line) * centre).real
            rest = along**2 - abs(centre) ** 2 + reach**2
            length = -along - self.curve.sign * float(np.sqrt(rest)) if rest >= 0.0 else -1.0
            if length < 0.0:
                self.refuse_root(radius)
            start, direction = (point.real, point.imag), float(np.angle(line))
            parts = [Segment("tangent", start, direction, 0.0, length)]
            centre += length * line
        along = self.curve.sign * centre / abs(centre)
        return end, [*parts, self.arc("root", radius, centre, (normal, along))]

    def refuse_root(self, radius: float) -> NoReturn:
        """Refuse a root arc that does not fit."""
        raise InputError(
            f"{self.name}.r_root = {radius:g} is out of range: allowed are smaller radii, whose "
            "arc reaches the dedendum circle from the flank"
        )
