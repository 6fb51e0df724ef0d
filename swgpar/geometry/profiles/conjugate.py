"""Conjugate flank: the envelope of the other gear's flank in the motion that the cam gives its
tooth.

The other flank is z(s), with tangents of angle phi and curvature kappa = dphi/ds, and moves as
c(psi) + exp(i alpha) z (`ToothMotion`). With v = exp(-i alpha) c' + i alpha' z, the velocity in the
moving frame, and its parts v_t along the tangent and v_n across, contact is where v_n(s, psi) = 0.
By implicit differentiation

    psi' = -(alpha' - kappa v_t) / (d v_n / d psi),  arc length rate sigma = 1 + v_t psi',
    curvature = (kappa + alpha' psi') / sigma.

So points, tangents and curvatures are exact. sigma <= 0 is undercut. A tangent and an arc lead to
the root circle. At the tip there may be an arc of relief and a rounded edge.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NoReturn

import numpy as np
import scipy
from numpy.typing import NDArray

from swgpar.errors import InputError
from swgpar.geometry.arrays import Floats
from swgpar.geometry.profiles.curved_segment import CurvedSegment, CurvePoints
from swgpar.geometry.profiles.flank import FlankSegment, Segment, ToothProfile
from swgpar.geometry.profiles.keys import Conjugate
from swgpar.geometry.profiles.mesh_gap import OutlinePair, outline
from swgpar.geometry.profiles.teeth import Teeth
from swgpar.geometry.profiles.tooth_motion import Pose, ToothMotion

STATIONS = 401
"""Stations on the other flank at which the contact is followed."""

GROUP = 16
"""Stations whose contacts are found together."""

PIECE_STATIONS = 65
"""Stations on a segment of the other flank between which the angle of contact is interpolated."""

REACH = np.radians(160.0)
"""Angle from the major axis, to both sides, in which contact is looked for, times the number of
lobes."""

DEEPEST = 1e-6
"""Overlap of the flanks over the module that counts as interference."""


@dataclass(frozen=True)
class Contacts:
    """Points of the given flank, s, at angles psi of the motion.

    psi, psi_rate : (n,) rad and its derivative by s where they touch
    point : (n,) complex, mm;  angle, angle_rate : (n,) rad, of the tangent from tip to root, and
    its derivative by s
    speed : (n,) arc length of the envelope by that of the given flank
    value, slope : (n,) mm, velocity across the flank, 0 where they touch, and its derivative by psi
    """

    psi: Floats
    psi_rate: Floats
    point: np.ndarray
    angle: Floats
    angle_rate: Floats
    speed: Floats
    value: Floats
    slope: Floats


@dataclass(frozen=True)
class Envelope:
    """Envelope of the flank `given` in the frame of the other gear's tooth.

    turn : rad, by which it is rotated towards the tooth's centre line, for backlash
    """

    given: ToothProfile
    motion: ToothMotion
    turn: float

    @property
    def external(self) -> bool:
        """Whether the envelope is a flank of external teeth."""
        return not self.given.external

    def pose(self, psi: Floats) -> Pose:
        """Motion of the given flank."""
        pose = self.motion.pose(psi)
        return pose if self.given.external else pose.inverse()

    def contacts(self, segment: FlankSegment, s: Floats, psi: Floats) -> Contacts:
        """State of the points `s` (n,) mm of a segment of the given flank, at the angles psi (n,)
        rad."""
        x, y = segment.point(s).T
        z, phi, kappa = x + 1j * y, segment.angle(s), segment.signed_curvature(s)
        half_pitch = np.pi / self.motion.teeth_rg
        if not self.given.external:
            z, phi, kappa = self.motion.mirrored(z), np.pi - phi - half_pitch, -kappa
        pose, tangent = self.pose(psi), np.exp(1j * phi)
        back = np.exp(-1j * pose.angle)
        v = back * pose.c1 + 1j * pose.angle1 * z
        along = (np.conj(tangent) * v).real
        value = (np.conj(1j * tangent) * v).real
        change = back * (pose.c2 - 1j * pose.angle1 * pose.c1) + 1j * pose.angle2 * z
        slope = (np.conj(1j * tangent) * change).real
        rate = -(pose.angle1 - kappa * along) / np.where(slope == 0.0, np.nan, slope)
        point, angle, angle_rate = pose.moved(z), phi + pose.angle, kappa + pose.angle1 * rate
        if self.given.external:
            # run through backwards and mirrored: the angle -> pi - (angle + half pitch) + pi
            point, angle, angle_rate = self.motion.mirrored(point), -angle - half_pitch, -angle_rate
        else:
            angle = angle + np.pi
        return Contacts(
            psi,
            rate,
            point * np.exp(1j * self.turn),
            angle + self.turn,
            angle_rate,
            1.0 + along * rate,
            value,
            slope,
        )

    def solved(self, segment: FlankSegment, s: Floats, psi: Floats) -> Contacts:
        """Contacts at `s` : (n,) mm of a segment, by Newton's method from psi (n,) rad."""
        contacts = self.contacts(segment, s, psi)
        for _ in range(12):
            step = contacts.value / contacts.slope
            contacts = self.contacts(segment, s, contacts.psi - step)
            if not np.nanmax(np.abs(step), initial=0.0) > 1e-13:
                break
        return contacts

    def _segment_of(self, s: Floats) -> NDArray[np.intp]:
        """Segments (n,) of the given flank on which the arc lengths `s` (n,) mm lie."""
        return np.clip(np.searchsorted(self.given.breaks, s) - 1, 0, len(self.given.segments) - 1)

    def _at(self, s: float, psi: float) -> Contacts:
        """The same at one arc length of the whole given flank."""
        index = int(self._segment_of(np.array([s]))[0])
        return self.solved(
            self.given.segments[index], np.array([s - self.given.breaks[index]]), np.array([psi])
        )

    @cached_property
    def branch(self) -> tuple[Floats, Floats]:
        """Arc lengths (n,) mm of the given flank and the angles (n,) rad of their contacts, next to
        the major axis.

        They are followed from the middle of the flank as far as the envelope runs without a cusp.
        Empty where the middle never touches.
        """
        s, middle = np.linspace(0.0, self.given.length, STATIONS), STATIONS // 2
        reach = REACH / self.motion.line.lobes
        psi = np.linspace(-reach, reach, 1601)
        index = int(self._segment_of(s[middle : middle + 1])[0])
        local = np.full_like(psi, s[middle] - self.given.breaks[index])
        value = self.contacts(self.given.segments[index], local, psi).value
        changes = np.flatnonzero(np.sign(value[1:]) != np.sign(value[:-1]))
        if not changes.size:
            return np.empty(0), np.empty(0)
        start = psi[changes[np.argmin(np.abs(psi[changes]))]]
        psi_of = np.full(STATIONS, np.nan)
        for indices in (np.arange(middle, STATIONS), np.arange(middle, -1, -1)):
            psi_of[indices] = self._followed(s[indices], start)
        known = np.isfinite(psi_of)
        return s[known], psi_of[known]

    def _followed(self, s: Floats, start: float) -> Floats:
        """Angles (n,) rad of the contacts at arc lengths `s` (n,) mm, which lead away from one
        near the angle `start`; NaN from where the envelope has a cusp or ends."""
        psi_of, index = np.full(len(s), np.nan), self._segment_of(s)
        before, rate = start, 0.0
        # the first station of a group gives the rate by which the others begin
        firsts = np.flatnonzero(np.diff(index, prepend=-1) | (np.arange(len(s)) % GROUP == 0))
        for first, end in zip(firsts, np.append(firsts[1:], len(s)), strict=True):
            for stations in (slice(first, first + 1), slice(first + 1, end)):
                local = s[stations] - self.given.breaks[index[first]]
                if not local.size:
                    continue
                away = s[stations] - s[max(stations.start - 1, 0)]
                segment = self.given.segments[index[first]]
                contacts = self.solved(segment, local, before + rate * away)
                change = np.abs(np.diff(contacts.psi, prepend=before))
                good = (contacts.speed > 0.0) & (change < np.radians(5.0))
                count = len(good) if good.all() else int(np.argmin(good))
                psi_of[stations][:count] = contacts.psi[:count]
                if count < len(good):
                    return psi_of
                before, rate = float(contacts.psi[-1]), float(contacts.psi_rate[-1])
        return psi_of

    def point(self, s: float) -> tuple[complex, float]:
        """Point, mm, and tangent angle, rad, from tip to root, at the arc length s, mm, of the
        given flank."""
        contact = self._at(s, float(np.interp(s, *self.branch)))
        return complex(contact.point[0]), float(contact.angle[0])

    def piece(self, index: int, low: float, high: float) -> CurvedSegment:
        """Piece of the given segment `index` between its local arc lengths `low` and `high`, mm,
        from tip to root."""
        segment, begin = self.given.segments[index], float(self.given.breaks[index])
        s = np.linspace(low, high, PIECE_STATIONS)
        contacts = self.solved(segment, s, np.interp(begin + s, *self.branch))
        # an error of psi moves the point along the envelope, and off it with its square only
        psi = scipy.interpolate.CubicHermiteSpline(s, contacts.psi, contacts.psi_rate)

        def evaluate(t: Floats) -> CurvePoints:
            s = high + (low - high) * t
            contacts = self.contacts(segment, s, psi(s))
            point, span = np.stack((contacts.point.real, contacts.point.imag), axis=-1), low - high
            return CurvePoints(
                point, contacts.angle, np.abs(span * contacts.speed), span * contacts.angle_rate
            )

        return CurvedSegment("conjugate", evaluate)

    def pieces(self, low: float, high: float) -> list[Segment | CurvedSegment]:
        """Segments between two arc lengths, mm, of the given flank, from the tip to the root of the
        envelope."""
        pieces: list[Segment | CurvedSegment] = []
        for index in range(len(self.given.segments) - 1, -1, -1):
            begin, end = self.given.breaks[index : index + 2]
            first, last = max(begin, low) - begin, min(end, high) - begin
            if last - first > 1e-9 * self.given.length:
                pieces.append(self.piece(index, first, last))
        return pieces


def _vector(angle: float) -> complex:
    return complex(np.exp(1j * angle))


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
        raise InputError(
            f"{self.name}: the envelope of the other gear's flank ends in an undercut before it "
            "reaches from the tip to the root: allowed are larger pressure angles and other "
            "profiles of the other gear, whose whole flank comes into contact"
        )

    def crossing(self, radius: float, low: float, high: float) -> float:
        """Arc length of the given flank whose contact lies at `radius`, mm."""

        def beyond(s: float) -> float:
            return abs(self.envelope.point(s)[0]) - radius

        if beyond(low) * beyond(high) > 0.0:
            self.undercut()
        return float(scipy.optimize.brentq(beyond, low, high, xtol=1e-13))

    def build(self, low: float, high: float) -> list[Segment | CurvedSegment]:
        """Segments from tip to root; `low`, `high` : arc lengths of the given flank that may
        touch."""
        top = self.crossing(self.tip, low, high)
        base: list[Segment | CurvedSegment] = []
        if self.keys.relief:
            height = self.keys.relief_height * self.module
            top, relief = self._relief(self.crossing(self.tip - self.sign * height, low, top), top)
            base.append(relief)
        bottom, ending = self._root(low, top)
        base += self.envelope.pieces(bottom, top)
        return (self._rounded(base) if self.keys.r_tip else base) + ending

    def _relief(self, begin: float, top: float) -> tuple[float, Segment]:
        """Arc tangent at `begin` that reaches the addendum circle by the relief inside of the
        envelope."""
        (point, angle), edge = self.envelope.point(begin), self.envelope.point(top)[0]
        chord = edge * _vector(self.keys.relief / self.tip) - point
        # the angle between a tangent and a chord is half of the arc's
        half = float(np.angle(-chord / _vector(angle)))
        if not 0.0 < self.sign * half < 0.5:
            raise InputError(
                f"{self.name}.relief = {self.keys.relief:g} is out of range with relief_height = "
                f"{self.keys.relief_height:g}: allowed are other values, for which an arc bends "
                "from the flank into the tooth"
            )
        curvature = -2.0 * np.sin(half) / abs(chord)
        return begin, Segment(
            "relief", _start(point + chord), angle + 2.0 * half, curvature, -2.0 * half / curvature
        )

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
            bottom = float(scipy.optimize.brentq(missing, low, top, xtol=1e-13))
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
                (x, y), angle = (
                    segment.point(np.array([s]))[0],
                    float(segment.angle(np.array([s]))[0]),
                )
                return (
                    self.sign * (abs(x + 1j * y - radius * self.normal(angle)) - self.tip) + radius
                )

            if short(segment.length) > 0.0:
                continue
            if short(0.0) < 0.0:
                break
            cut = float(scipy.optimize.brentq(short, 0.0, segment.length, xtol=1e-13))
            (x, y), angle = (
                segment.point(np.array([cut]))[0],
                float(segment.angle(np.array([cut]))[0]),
            )
            center = x + 1j * y - radius * self.normal(angle)
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
        start = segment.point(np.array([cut]))[0]
        direction = float(segment.angle(np.array([cut]))[0])
        return Segment(
            segment.name,
            (float(start[0]), float(start[1])),
            direction,
            segment.curvature,
            segment.length - cut,
        )
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
