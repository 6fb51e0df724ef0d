"""Envelope of the other gear's flank in the motion that the cam gives its tooth.

The other flank is z(s), with tangents of angle phi and curvature kappa = dphi/ds, and moves as
c(psi) + exp(i alpha) z (`ToothMotion`). With v = exp(-i alpha) c' + i alpha' z, the velocity in the
moving frame, and its parts v_t along the tangent and v_n across, contact is where v_n(s, psi) = 0.
By implicit differentiation

    psi' = -(alpha' - kappa v_t) / (d v_n / d psi),  arc length rate sigma = 1 + v_t psi',
    curvature = (kappa + alpha' psi') / sigma.

So points, tangents and curvatures are exact. sigma <= 0 is undercut.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from swgpar.geometry.arrays import Complex, Floats, as_complex, as_points
from swgpar.profiles.curved_segment import CurvedSegment, CurvePoints
from swgpar.profiles.fitted_curve import fitted
from swgpar.profiles.flank import FlankSegment, Segment, ToothProfile
from swgpar.profiles.tooth_motion import Pose, ToothMotion

STATIONS = 401
"""Stations on the other flank at which the contact is followed."""

GROUP = 16
"""Stations whose contacts are found together."""

PIECE_STATIONS = 65
"""Stations on a segment of the other flank between which the angle of contact is interpolated."""

REACH = np.radians(160.0)
"""Angle from the major axis, to both sides, in which contact is looked for, times the number of
lobes."""


@dataclass(frozen=True)
class Contacts:
    """Points of the given flank, s, at angles psi of the motion.

    psi : (n,) rad
    point : (n,) complex, mm, in the frame of the envelope's tooth
    angle : (n,) rad, of the tangent from tip to root of that tooth
    along, value : (n,) mm, velocity along the flank and across it, 0 where they touch
    slope, bend : (n,) mm and 1, derivatives of the value by psi and by s
    turning : (n,) mm, change of the angle where they touch: by s times the slope
    """

    psi: Floats
    point: Complex
    angle: Floats
    along: Floats
    value: Floats
    slope: Floats
    bend: Floats
    turning: Floats

    @property
    def psi_rate(self) -> Floats:
        """Change (n,) of psi by s, rad/mm, where they touch."""
        return -self.bend / np.where(self.slope == 0.0, np.nan, self.slope)

    @property
    def angle_rate(self) -> Floats:
        """Change (n,) of the angle by s, rad/mm."""
        return self.turning / self.slope

    @property
    def speed(self) -> Floats:
        """Arc length (n,) of the envelope by that of the given flank."""
        return 1.0 + self.along * self.psi_rate


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
        point, phi, kappa = segment.at(s)
        z = as_complex(point)
        half_pitch = np.pi / self.motion.teeth_rg
        if not self.given.external:
            z, phi, kappa = self.motion.mirrored(z), np.pi - phi - half_pitch, -kappa
        pose, back = self.pose(psi), np.exp(-1j * phi)
        unturned = np.conj(pose.turn)
        # along the flank, and across it
        velocity = back * (unturned * pose.c1 + 1j * pose.angle1 * z)
        along, value = velocity.real, velocity.imag
        change = unturned * (pose.c2 - 1j * pose.angle1 * pose.c1) + 1j * pose.angle2 * z
        slope = (back * change).imag
        bend = pose.angle1 - kappa * along
        turning = kappa * slope - pose.angle1 * bend
        angle = phi + pose.angle + np.pi
        if self.given.external:
            # mirrored, and run through backwards
            angle, turning = -(phi + pose.angle) - half_pitch, -turning
        placed = self._placed(pose.moved(z))
        return Contacts(psi, placed, angle + self.turn, along, value, slope, bend, turning)

    def _placed(self, points: Complex) -> Complex:
        """Points (n,) x + i y, mm, of the slot, in the frame of the envelope's tooth."""
        placed = self.motion.mirrored(points) if self.given.external else points
        return placed * np.exp(1j * self.turn)

    def path(self, s: Floats, pose: Pose) -> tuple[Complex, Complex, Complex]:
        """Points x + i y (n,), mm, at the arc lengths s (n,) mm of the given flank, in the frame of
        the envelope's tooth, and their first two derivatives by psi.

        pose : of n positions
        """
        arm: Complex = pose.turn * self._moving(s)
        first = pose.c1 + 1j * pose.angle1 * arm
        second = pose.c2 + (1j * pose.angle2 - pose.angle1**2) * arm
        return self._placed(pose.c + arm), self._placed(first), self._placed(second)

    def places(self, s: Floats, pose: Pose) -> Complex:
        """The same points at each of m positions, (m, n)."""
        moving = self._moving(s)
        arm = np.conj(moving) if self.given.external else moving  # as `_placed` mirrors it
        return self._placed(pose.c)[:, None] + self._placed(pose.turn)[:, None] * arm

    def _moving(self, s: Floats) -> Complex:
        """Points x + i y (n,), mm, of the given flank in the moving frame."""
        point = as_complex(self.given.point(s))
        return point if self.given.external else self.motion.mirrored(point)

    def solved(self, segment: FlankSegment, s: Floats, psi: Floats) -> Contacts:
        """Contacts at `s` : (n,) mm of a segment, by Newton's method from psi (n,) rad."""
        contacts = self.contacts(segment, s, psi)
        for _ in range(12):
            step = contacts.value / contacts.slope
            contacts = self.contacts(segment, s, contacts.psi - step)
            # the next change would be its square
            if not np.nanmax(np.abs(step), initial=0.0) > 1e-8:
                break
        return contacts

    def _segment_of(self, s: Floats) -> NDArray[np.intp]:
        """Segments (n,) of the given flank on which the arc lengths `s` (n,) mm lie."""
        return np.clip(np.searchsorted(self.given.breaks, s) - 1, 0, len(self.given.segments) - 1)

    def contact_at(self, s: float, psi: float) -> Contacts:
        """Contact at one arc length, mm, of the whole given flank, near the angle psi, rad."""
        index = int(self._segment_of(np.array([s]))[0])
        return self.solved(
            self.given.segments[index], np.array([s - self.given.breaks[index]]), np.array([psi])
        )

    @property
    def _stations(self) -> Floats:
        """Arc lengths (STATIONS,) mm of the given flank."""
        return np.linspace(0.0, self.given.length, STATIONS)

    @cached_property
    def _middle_angle(self) -> float:
        """Angle (rad), next to the major axis, at which the middle of the given flank about
        touches; NaN where it never does."""
        s, middle = self._stations, STATIONS // 2
        reach = REACH / self.motion.line.lobes
        psi = np.linspace(-reach, reach, 1601)
        index = int(self._segment_of(s[middle : middle + 1])[0])
        local = s[middle : middle + 1] - self.given.breaks[index]  # one point at all angles
        value = self.contacts(self.given.segments[index], local, psi).value
        changes = np.flatnonzero(np.sign(value[1:]) != np.sign(value[:-1]))
        return float(psi[changes[np.argmin(np.abs(psi[changes]))]]) if changes.size else np.nan

    @cached_property
    def tipwards(self) -> tuple[Floats, Floats]:
        """The part of `branch` from the middle of the given flank to its tip, that way."""
        return self._known(self._stations[STATIONS // 2 :: -1])

    @cached_property
    def branch(self) -> tuple[Floats, Floats]:
        """Arc lengths (n,) mm of the given flank and the angles (n,) rad of their contacts, next to
        the major axis.

        They are followed from the middle of the flank as far as the envelope runs without a cusp.
        Empty where the middle never touches.
        """
        rootwards = self._known(self._stations[STATIONS // 2 :])
        s, psi = (
            np.concatenate([tip[:0:-1], root])
            for tip, root in zip(self.tipwards, rootwards, strict=True)
        )
        return s, psi

    def _known(self, s: Floats) -> tuple[Floats, Floats]:
        """The first of the arc lengths `s` (n,) mm that lead away from the middle of the given
        flank, as far as the envelope has no cusp, and the angles of their contacts, rad."""
        if not np.isfinite(self._middle_angle):
            return np.empty(0), np.empty(0)
        psi = self._followed(s, self._middle_angle)
        known = np.isfinite(psi)
        return s[known], psi[known]

    def _followed(self, s: Floats, start: float) -> Floats:
        """Angles (n,) rad of the contacts at arc lengths `s` (n,) mm, which lead away from one
        near the angle `start`; NaN from where the envelope has a cusp or ends."""
        psi_of, index = np.full(len(s), np.nan), self._segment_of(s)
        before, rate = start, 0.0
        # the first station of a segment gives the rate by which its others begin
        begins = np.diff(index, prepend=-1) != 0
        alone = begins | np.roll(begins, 1)
        firsts = np.flatnonzero(alone | (np.arange(len(s)) % GROUP == 0))
        for first, end in zip(firsts, np.append(firsts[1:], len(s)), strict=True):
            segment, begin = self.given.segments[index[first]], self.given.breaks[index[first]]
            away = s[first:end] - s[max(first - 1, 0)]
            contacts = self.solved(segment, s[first:end] - begin, before + rate * away)
            change = np.abs(np.diff(contacts.psi, prepend=before))
            good = (contacts.speed > 0.0) & (change < np.radians(5.0))
            count = len(good) if good.all() else int(np.argmin(good))
            psi_of[first : first + count] = contacts.psi[:count]
            if count < len(good):
                break
            before, rate = float(contacts.psi[-1]), float(contacts.psi_rate[-1])
        return psi_of

    def point(self, s: float) -> tuple[complex, float]:
        """Point, mm, and tangent angle, rad, from tip to root, at the arc length s, mm, of the
        given flank."""
        contact = self.contact_at(s, float(np.interp(s, *self.branch)))
        return complex(contact.point[0]), float(contact.angle[0])

    def piece(self, index: int, low: float, high: float) -> CurvedSegment:
        """Piece of the given segment `index` between its local arc lengths `low` and `high`, mm,
        from tip to root."""
        segment, begin = self.given.segments[index], float(self.given.breaks[index])
        s = np.linspace(low, high, PIECE_STATIONS)
        contacts = self.solved(segment, s, np.interp(begin + s, *self.branch))
        psi = scipy.interpolate.CubicHermiteSpline(s, contacts.psi, contacts.psi_rate)

        def evaluate(t: Floats) -> CurvePoints:
            s = high + (low - high) * t
            # without Newton's method points move along the envelope, by 1e-9 of its length, with a
            # kink at every station
            contacts = self.solved(segment, s, psi(s))
            point, span = as_points(contacts.point), low - high
            return CurvePoints(
                point, contacts.angle, np.abs(span * contacts.speed), span * contacts.angle_rate
            )

        return fitted(CurvedSegment("conjugate", evaluate))

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
