"""Conjugate flank: the envelope of the other gear's flank, and what leads from it to the circles.

A tangent and an arc lead to the root circle. At the tip there may be a rounded edge.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NoReturn

import numpy as np

from swgpar.errors import InputError
from swgpar.geometry.arrays import Floats
from swgpar.geometry.bracketed_root import root_between
from swgpar.geometry.profiles.curved_segment import CurvedSegment, CurvePoints
from swgpar.geometry.profiles.envelope import STATIONS, Envelope
from swgpar.geometry.profiles.flank import Segment, ToothProfile
from swgpar.geometry.profiles.keys import Conjugate
from swgpar.geometry.profiles.mesh_gap import OutlinePair, outline
from swgpar.geometry.profiles.teeth import Teeth
from swgpar.geometry.profiles.tooth_motion import ToothMotion

DEEPEST = 1e-6
"""Overlap of the flanks over the module that counts as interference."""


def _vector(angle: float) -> complex:
    return complex(np.exp(1j * angle))


def _tangent(segment: Segment | CurvedSegment, s: float) -> tuple[complex, float]:
    """Point, mm, and angle of the tangent, rad, at the arc length s, mm."""
    at = np.array([s])
    return complex(*segment.point(at)[0]), float(segment.angle(at)[0])


def _start(point: complex) -> tuple[float, float]:
    return float(point.real), float(point.imag)


@dataclass(frozen=True)
class _Maker:
    """Puts the flank together. sign : +1 for external teeth;  tip, root : mm, radii of the
    circles"""

    envelope: Envelope
    keys: Conjugate
    sign: float
    tip: float
    root: float
    module: float
    name: str

    def normal(self, angle: float) -> complex:
        """Outward normal where the tangent has this angle."""
        return self.sign * 1j * _vector(angle)

    def undercut(self) -> NoReturn:
        s = self.envelope.branch[0]
        if s.size:
            ends = sorted(abs(self.envelope.point(float(at))[0]) for at in (s[0], s[-1]))
            spans = f"it spans radii from {ends[0]:.5g} to {ends[1]:.5g} mm"
        else:
            spans = "the middle of that flank never touches"
        low, high = sorted((self.tip, self.root))
        raise InputError(
            f"{self.name}: the envelope of the other gear's flank ends in an undercut before it "
            f"reaches from the tip to the root ({low:.5g} to {high:.5g} mm), {spans}: allowed are "
            "larger pressure angles, lower teeth and other profiles of the other gear, whose whole "
            "flank comes into contact"
        )

    def crossing(self, radius: float, low: float, high: float) -> float:
        """Arc length of the given flank whose contact lies at `radius`, mm."""

        def beyond(s: float) -> float:
            return abs(self.envelope.point(s)[0]) - radius

        if beyond(low) * beyond(high) > 0.0:
            self.undercut()
        return root_between(beyond, low, high, xtol=1e-13)

    def build(self, low: float, high: float) -> list[Segment | CurvedSegment]:
        """Segments from tip to root; `low`, `high` : arc lengths of the given flank that may
        touch."""
        top = self.crossing(self.tip, low, high)
        bottom, ending = self._root(low, top)
        base = self.envelope.pieces(bottom, top)
        return (self._rounded(base) if self.keys.r_tip else base) + ending

    def _arc(
        self, name: str, radius: float, begin: float, end: float, convex: bool, center: complex
    ) -> Segment:
        """Arc about `center` between tangents of two angles, rad; refused when it would run
        backwards."""
        curvature = (-self.sign if convex else self.sign) / radius
        turn = float(np.angle(np.exp(1j * (end - begin))))
        if turn * curvature < 0.0:
            raise InputError(
                f"{self.name}.r_{name} = {radius:g}: the {name} arc would run backwards: allowed "
                f"are other radii"
            )
        start = center + (1.0 if convex else -1.0) * radius * self.normal(begin)
        return Segment(name, _start(start), begin, curvature, turn / curvature)

    def _root(self, low: float, top: float) -> tuple[float, list[Segment | CurvedSegment]]:
        """Where the envelope ends, and the tangent and the arc from there to the dedendum
        circle."""
        radius, reach = self.keys.r_root, self.root + self.sign * self.keys.r_root

        def center(s: float) -> tuple[complex, float]:
            point, angle = self.envelope.point(s)
            return point + radius * self.normal(angle), angle

        def missing(s: float) -> float:
            return self.sign * (abs(center(s)[0]) - reach)

        bottom, length = low, 0.0
        if missing(low) < 0.0:
            if missing(top) < 0.0:
                self._refuse_root()
            bottom = root_between(missing, low, top, xtol=1e-13)
        middle, angle = center(bottom)
        line = _vector(angle)
        if bottom == low:
            along = (np.conj(line) * middle).real
            rest = along**2 - abs(middle) ** 2 + reach**2
            if rest < 0.0:
                self._refuse_root()
            length = float(-along - np.sqrt(rest) if self.sign > 0.0 else -along + np.sqrt(rest))
        middle += length * line
        outward = self.sign * middle / abs(middle)
        end = float(np.angle(outward / (self.sign * 1j)))
        ending: list[Segment | CurvedSegment] = [
            self._arc("root", radius, angle, end, False, middle)
        ]
        if length > 1e-9 * self.module:
            ending.insert(
                0, Segment("tangent", _start(self.envelope.point(bottom)[0]), angle, 0.0, length)
            )
        return bottom, ending

    def _refuse_root(self) -> NoReturn:
        raise InputError(
            f"{self.name}.r_root = {self.keys.r_root:g} is out of range: allowed are smaller "
            "radii, whose arc reaches the dedendum circle from the flank"
        )

    def _rounded(self, base: list[Segment | CurvedSegment]) -> list[Segment | CurvedSegment]:
        """The segments with their tip edge replaced by an arc that is tangent to the addendum
        circle."""
        radius = self.keys.r_tip
        for index, segment in enumerate(base):

            def short(s: float, segment: Segment | CurvedSegment = segment) -> float:
                point, angle = _tangent(segment, s)
                return self.sign * (abs(point - radius * self.normal(angle)) - self.tip) + radius

            if short(segment.length) > 0.0:
                continue
            if short(0.0) < 0.0:
                break
            cut = root_between(short, 0.0, segment.length, xtol=1e-13)
            point, angle = _tangent(segment, cut)
            center = point - radius * self.normal(angle)
            begin = float(np.angle(self.sign * center / abs(center) / (self.sign * 1j)))
            return [
                self._arc("tip", radius, begin, angle, True, center),
                _shortened(segment, cut),
                *base[index + 1 :],
            ]
        raise InputError(
            f"{self.name}.r_tip = {radius:g} is out of range: allowed are smaller radii, whose arc "
            "touches the flank and the addendum circle"
        )


def _shortened(segment: Segment | CurvedSegment, cut: float) -> Segment | CurvedSegment:
    """The segment without its first part of the length `cut`, mm."""
    if isinstance(segment, Segment):
        start, direction = _tangent(segment, cut)
        length = segment.length - cut
        return Segment(segment.name, _start(start), direction, segment.curvature, length)
    first = float(segment.parameter(np.array([cut]))[0])

    def evaluate(t: Floats) -> CurvePoints:
        curve = segment.evaluate(first + (1.0 - first) * t)
        return CurvePoints(
            curve.point, curve.angle, (1.0 - first) * curve.speed, (1.0 - first) * curve.angle_rate
        )

    return CurvedSegment(segment.name, evaluate)


@lru_cache(maxsize=16)
def conjugate(
    keys: Conjugate, teeth: Teeth, given: ToothProfile, motion: ToothMotion, name: str = "profile"
) -> ToothProfile:
    """Build the flank that touches `given`, the other gear's, in every position of `motion`.

    name : section of the design file, for messages. Raises InputError for undercut, interference,
    and radii that do not fit.
    """
    sign = teeth.sign
    tip, root = teeth.r_pitch + sign * teeth.addendum, teeth.r_pitch - sign * teeth.dedendum
    envelope = Envelope(given, motion, 0.5 * keys.backlash / teeth.r_pitch)
    maker = _Maker(envelope, keys, sign, tip, root, teeth.module, name)
    known = envelope.branch[0]
    # a rounded tip edge only touches at the major axis: the flank below it is what works
    low = given.tip_end
    if not known.size or known[0] > low + given.length / (STATIONS - 1):
        maker.undercut()
    segments = maker.build(max(low, float(known[0])), float(known[-1]))
    profile = ToothProfile(tuple(segments), teeth.external, tip, root, teeth.n_teeth)
    external, internal = (profile, given) if teeth.external else (given, profile)
    deepest = OutlinePair(outline(external), outline(internal), motion).nearest_place()
    if deepest.distance < -DEEPEST * teeth.module:
        raise InputError(
            f"{name}: at {np.degrees(deepest.psi):.1f} degrees from the major axis the teeth "
            f"overlap by {-deepest.distance:.3g} mm: allowed are lower teeth, larger pressure "
            "angles and other profiles of the other gear, whose other parts stay clear of the "
            "envelope"
        )
    return profile
