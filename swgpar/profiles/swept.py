"""Boundary of the area that the other gear's teeth sweep: what is left of a tooth beside it.

At every radius R the boundary is at the smallest angle, from the centre line of the tooth that is
made, at which a part of the moving tooth passes. It consists of envelopes of the moving flank and
of paths of its sharp edges, which meet at corners. All pieces are exact, by the radius:

    v_n(s, psi) = 0,  |z(s, psi)| = R      envelope (`envelope.py` has the derivatives),
    |z(psi)| = R                           path of an edge.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy

from swgpar.errors import InputError
from swgpar.geometry.arrays import Floats, as_complex, as_points
from swgpar.geometry.bracketed_root import root_between
from swgpar.profiles.curved_segment import CurvedSegment, CurvePoints, points_of
from swgpar.profiles.envelope import REACH, Contacts, Envelope
from swgpar.profiles.fitted_curve import fitted
from swgpar.profiles.polyline import clockwise_from_y

POSITIONS, PLACES, RADII = 641, 33, 401
"""Positions of the moving tooth, places on each of its segments, and radii, between which the
boundary is looked for."""

STEEP = 0.25
"""Least cosine of the angle between the moving flank and the radius. Beyond, in its fillet, the tip
of the tooth that is made does not reach it."""

NEAR = np.radians(3.0)
"""Change of psi within which a contact belongs to a place of the grid."""

ASTRAY = 3.0 * NEAR
"""Change of psi from which Newton's method finds no contact that belongs to its start."""

JUMP = np.radians(0.5)
"""Change of psi from one radius to the next, beyond what its rate gives, that is another piece."""

BESIDE = 0.03
"""Length over that of the moving flank by which a place of the grid may be beside a part that is on
the boundary there."""

KINK = 1e-6
"""Angle (rad) between segments from which the moving flank has an edge there."""

SHORT = 1e-6
"""Length over the module below which a piece is left out."""

LEAST = 0.05
"""Length over the module below which what a rounded tip edge bounds is left out: the tangent of
the piece before it goes clear of the edge, too."""

EDGE = 0.01
"""Height over the module by which the path of an edge ends before its farthest place."""

NODES = 65
"""Radii of an envelope between which s and psi are interpolated, for Newton's method."""


class Places(NamedTuple):
    """Places of the moving tooth that pass at radii (n,).

    s : (n,) mm, arc lengths;  psi : (n,) rad, NaN without a place
    s_rate, psi_rate : (n,) derivatives by the radius
    angle : (n,) rad, from the centre line of the tooth that is made
    """

    s: Floats
    psi: Floats
    s_rate: Floats
    psi_rate: Floats
    angle: Floats


@dataclass(frozen=True)
class _SegmentEnvelope:
    """Envelope of the segment `index` of the moving flank."""

    envelope: Envelope
    index: int

    @property
    def span(self) -> tuple[float, float]:
        """Ends of the part of the moving flank, arc lengths in mm."""
        begin, end = self.envelope.given.breaks[self.index : self.index + 2]
        return float(begin), float(end)

    def _contacts(self, s: Floats, psi: Floats) -> tuple[Contacts, Floats, Floats]:
        """Contacts, the derivatives (n,) of the radius by s at rest, and the determinant (n,) mm
        of the conditions over them."""
        segment = self.envelope.given.segments[self.index]
        contacts = self.envelope.contacts(segment, s - self.span[0], psi)
        unit = contacts.point / np.abs(contacts.point)
        outwards = -(np.conj(unit) * np.exp(1j * contacts.angle)).real
        return contacts, outwards, contacts.slope - contacts.bend * contacts.along

    def _solved(self, radius: Floats, s: Floats, psi: Floats) -> tuple[Floats, Floats, Floats]:
        """Places s (n,) mm and psi (n,) rad of contacts at radii (n,) mm by Newton's method, and
        its last changes (n,) of psi. The segment is continued by its own length at most. Places
        that go astray are left."""
        low, high = self.span
        beyond = high - low
        start, s, psi, last = psi, s.copy(), psi.copy(), np.zeros_like(psi)
        moving = np.arange(len(psi))
        for _ in range(20):
            contacts, outwards, square = self._contacts(s[moving], psi[moving])
            missing = (np.abs(contacts.point) - radius[moving]) / outwards
            turn = (contacts.bend * missing - contacts.value) / square
            along = s[moving] - missing - contacts.along * turn
            s[moving] = np.clip(along, low - beyond, high + beyond)
            psi[moving] += np.clip(turn, -NEAR, NEAR)
            last[moving] = turn
            # the next change would be its square
            goes_on = (np.abs(turn) > 1e-8) | (np.abs(missing) > 1e-8)
            moving = moving[goes_on & (np.abs(psi - start)[moving] < ASTRAY)]
            if not moving.size:
                break
        return s, psi, last

    def at_radius(self, radius: Floats, s: Floats, psi: Floats) -> Places:
        """Places at radii (n,) mm by Newton's method from s (n,) mm and psi (n,) rad."""
        with np.errstate(divide="ignore", invalid="ignore"):
            s, psi, turn = self._solved(radius, s, psi)
            contacts, outwards, square = self._contacts(s, psi)
            low, high = self.span
            found = (np.abs(turn) < 1e-8) & (s > low - 1e-9) & (s < high + 1e-9)
            return Places(
                s,
                np.where(found, psi, np.nan),
                contacts.slope / (square * outwards),
                -contacts.bend / (square * outwards),
                clockwise_from_y(contacts.point),
            )

    def curve(self, radii: Floats, places: Places) -> CurvedSegment:
        """Exact curve through places at radii (n,) mm, from the first to the last."""
        order = np.argsort(radii)
        s_of, psi_of = (
            scipy.interpolate.CubicHermiteSpline(radii[order], value[order], rate[order])
            for value, rate in ((places.s, places.s_rate), (places.psi, places.psi_rate))
        )
        first, span = radii[0], radii[-1] - radii[0]

        def evaluate(t: Floats) -> CurvePoints:
            radius = first + span * t
            s, psi, _ = self._solved(radius, s_of(radius), psi_of(radius))
            contacts, outwards, square = self._contacts(s, psi)
            point = as_points(contacts.point)
            turning = contacts.turning / (square * outwards)
            return CurvePoints(point, contacts.angle, np.abs(span / outwards), span * turning)

        return fitted(CurvedSegment("swept", evaluate))


@dataclass(frozen=True)
class _EdgePath:
    """Path of an edge of the moving flank, at the arc length `place`, mm."""

    envelope: Envelope
    place: float

    @property
    def span(self) -> tuple[float, float]:
        """See `_SegmentEnvelope`."""
        return self.place, self.place

    def at_radius(self, radius: Floats, s: Floats, psi: Floats) -> Places:
        """See `_SegmentEnvelope`."""
        s = np.full_like(psi, self.place)
        with np.errstate(divide="ignore", invalid="ignore"):
            for _ in range(20):
                point, velocity, _ = self.envelope.path(s, self.envelope.pose(psi))
                rate = (np.conj(point) * velocity).real / np.abs(point)
                turn = (radius - np.abs(point)) / rate
                psi = psi + np.clip(turn, -NEAR, NEAR)
                if not np.nanmax(np.abs(turn), initial=0.0) > 1e-14:
                    break
        psi = np.where(np.abs(turn) < 1e-9, psi, np.nan)
        return Places(s, psi, np.zeros_like(s), 1.0 / rate, clockwise_from_y(point))

    def curve(self, radii: Floats, places: Places) -> CurvedSegment:
        """See `_SegmentEnvelope`."""
        first, span = places.psi[0], places.psi[-1] - places.psi[0]

        def evaluate(t: Floats) -> CurvePoints:
            s = np.full_like(t, self.place)
            pose = self.envelope.pose(first + span * t)
            point, velocity, change = self.envelope.path(s, pose)
            return points_of(point, span * velocity, span**2 * change)

        return fitted(CurvedSegment("swept", evaluate))


Part = _SegmentEnvelope | _EdgePath
"""A part of the moving flank that may be on the boundary."""


@dataclass(frozen=True)
class _Run:
    """Neighbouring radii (n,) mm, from tip to root, at which the same part is on the boundary."""

    part: Part
    radii: Floats
    places: Places

    def at(self, radii: Floats) -> Places:
        """Places at radii (n,) mm, in or beside the run."""
        k = np.abs(self.radii[:, None] - radii).argmin(axis=0)
        away, places = radii - self.radii[k], self.places
        s, psi = places.s[k] + places.s_rate[k] * away, places.psi[k] + places.psi_rate[k] * away
        return self.part.at_radius(radii, s, psi)

    @property
    def steepest(self) -> float:
        """Radius (mm) of the run at which the boundary leads along the radius, most of all."""
        if len(self.radii) < 3:
            return float(self.radii[0])
        return float(self.radii[np.abs(np.gradient(self.places.angle, self.radii)).argmin()])

    def curve(self, first: float, last: float) -> CurvedSegment:
        """Exact curve between two radii, mm."""
        radii = np.linspace(first, last, NODES)
        return self.part.curve(radii, self.at(radii))


@dataclass(frozen=True)
class SweptArea:
    """The area that the moving tooth of `envelope` sweeps, beside the tooth that is made.

    tip : mm, radius from which the boundary is wanted, towards the root;  module : mm
    name : section of the design file, for messages
    """

    envelope: Envelope
    tip: float
    module: float
    name: str

    @property
    def _edges(self) -> list[_EdgePath]:
        """Edges of the moving flank: a sharp tip and convex corners."""
        given = self.envelope.given
        places = [] if given.tip_end else [0.0]
        places += given.breaks[1:-1][-given.sign * given.kinks > KINK].tolist()
        return [_EdgePath(self.envelope, place) for place in places]

    def _seen(self) -> tuple[Floats, Floats, Floats]:
        """Radii (n,) mm from tip to root, and places s (n,) mm and psi (n,) rad of the moving flank
        about at the boundary."""
        given, reach = self.envelope.given, REACH / self.envelope.motion.line.lobes
        s = np.concatenate([np.linspace(*ends, PLACES)[:-1] for ends in pairwise(given.breaks)])
        at = given.at(s)
        along = (np.exp(-1j * at.angle) * as_complex(at.point)).real
        s = s[np.abs(along) > STEEP * np.hypot(*at.point.T)]
        psi = np.linspace(-reach, reach, POSITIONS)
        sign = -given.sign
        points = self.envelope.places(s, self.envelope.pose(psi))
        radius = np.abs(points)
        nearest = (sign * radius).min(axis=1)
        farthest = sign * (float(nearest.min()) + EDGE * self.module)
        if sign * (self.tip - farthest) <= 0.0:
            raise InputError(
                f"{self.name}: the other gear's teeth do not reach between these teeth: allowed "
                "are higher teeth or a larger deflection"
            )
        reaching = nearest < sign * self.tip
        psi, radius, angle = psi[reaching], radius[reaching], clockwise_from_y(points[reaching])
        radii = np.linspace(self.tip, farthest, RADII)
        order = slice(None) if radius[0, 0] < radius[0, -1] else slice(None, None, -1)
        radius, angle, s = radius[:, order], angle[:, order], s[order]
        angles = np.full((len(psi), RADII), np.inf)
        counts = np.count_nonzero(sign * radii >= nearest[reaching, None], axis=1)
        for k, n in enumerate(counts):  # of the radii that the tooth reaches
            angles[k, :n] = np.interp(radii[:n], radius[k], angle[k], left=np.inf, right=np.inf)
        least = angles.argmin(axis=0)
        # the samples beside each radius, at the position with the least angle
        below = np.count_nonzero(radius[least] <= radii[:, None], axis=1) - 1
        below = np.clip(below, 0, len(s) - 2)
        low, high = radius[least, below], radius[least, below + 1]
        share = np.clip((radii - low) / (high - low), 0.0, 1.0)
        return radii, s[below] + share * (s[below + 1] - s[below]), psi[least]

    def _runs(self) -> list[_Run]:
        """What is on the boundary, from tip to root."""
        radii, s, psi = self._seen()
        segments = range(len(self.envelope.given.segments))
        parts: list[Part] = [
            *(_SegmentEnvelope(self.envelope, k) for k in segments),
            *self._edges,
        ]
        found = [self._found(part, radii, s, psi) for part in parts]
        angle = np.array(
            [np.where(np.abs(each.psi - psi) < NEAR, each.angle, np.inf) for each in found]
        )
        best = angle.argmin(axis=0)
        places = Places(
            *(np.stack(each)[best, np.arange(RADII)] for each in zip(*found, strict=True))
        )
        known = np.flatnonzero(np.isfinite(angle.min(axis=0)))
        if not known.size or known[-1] - known[0] >= known.size:
            raise InputError(
                f"{self.name}: the other gear's teeth leave no boundary between these teeth: "
                "allowed are other profiles of the other gear, and lower teeth"
            )
        if known[0] > 0:
            raise InputError(
                f"{self.name}: these tips, at a radius of {self.tip:.6g} mm, reach into the "
                f"fillets of the other gear, which leave a flank from {radii[known[0]]:.6g} mm on: "
                "allowed are smaller addenda, and a smaller root radius of the other gear"
            )
        usual = np.maximum(np.abs(places.psi_rate[1:]), np.abs(places.psi_rate[:-1]))
        jump = np.abs(np.diff(places.psi)) > JUMP + 3.0 * usual * np.abs(np.diff(radii))
        ends = known[1:][((np.diff(best) != 0) | jump)[known[:-1]]]
        return [
            _Run(parts[best[k[0]]], radii[k], Places(*(each[k] for each in places)))
            for k in np.split(known, ends - known[0])
        ]

    def _found(self, part: Part, radii: Floats, s: Floats, psi: Floats) -> Places:
        """Places of a part at radii (n,) mm where the boundary is about at s (n,) mm and psi (n,)
        rad; NaN where it is off the part."""
        (low, high), off = part.span, BESIDE * self.envelope.given.length
        here = (s > low - off) & (s < high + off)
        found = Places(*np.full((len(Places._fields), len(radii)), np.nan))
        if here.any():
            solved = part.at_radius(radii[here], np.clip(s[here], low, high), psi[here])
            for each, values in zip(found, solved, strict=True):
                each[here] = values
        return found

    def _meeting(self, run: _Run, after: _Run) -> float:
        """Radius (mm) at which one run ends and the next begins."""
        last, first = float(run.radii[-1]), float(after.radii[0])
        low = max(run.part.span[0], after.part.span[0])
        high = min(run.part.span[1], after.part.span[1])
        psi = float(run.places.psi[-1])
        if low == high and abs(psi - after.places.psi[0]) < NEAR:
            # the contact passes the place that both parts have in common
            radius = float(np.abs(self.envelope.contact_at(low, psi).point[0]))
            if not (radius - last) * (radius - first) > 0.0:
                return radius

        def apart(radius: float) -> float:
            at = np.array([radius])
            return float((run.at(at).angle - after.at(at).angle)[0])

        if not apart(last) <= 0.0 <= apart(first):
            raise InputError(
                f"{self.name}: the swept area has a step at a radius of {last:.6g} mm: allowed are "
                "lower teeth and other profiles of the other gear"
            )
        return root_between(apart, min(last, first), max(last, first), xtol=1e-13)

    def boundary(self) -> list[CurvedSegment]:
        """Curves from tip to root. They end near the farthest place of a sharp tip edge of the
        other gear, and where the boundary that a rounded one makes is steepest: beyond, it leads
        around the tip, and its tangent goes clear of it."""
        runs = self._runs()
        meetings = [self._meeting(*pair) for pair in pairwise(runs)]
        ends = [float(runs[0].radii[0]), *meetings, float(runs[-1].radii[-1])]
        if runs[-1].part.span == (0.0, self.envelope.given.tip_end):
            along = abs(runs[-1].steepest - ends[-2])
            ends[-1] = runs[-1].steepest if along > LEAST * self.module else ends[-2]
        curves = [
            run.curve(*between)
            for run, between in zip(runs, pairwise(ends), strict=True)
            if abs(between[1] - between[0]) > SHORT * self.module
        ]
        if not curves:
            raise InputError(f"{self.name}: the other gear's teeth leave no boundary")
        return curves
