"""Thinner teeth: a whole flank turned about the axis, towards the centre line of its tooth."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from swgpar.geometry.arrays import Floats
from swgpar.geometry.rotation import rotated
from swgpar.profiles.curved_segment import CurvedSegment, CurvePoints
from swgpar.profiles.flank import FlankSegment, Segment, ToothProfile


@dataclass(frozen=True)
class _Turned:
    """A curve turned about the axis by `angle`, rad."""

    segment: CurvedSegment
    angle: float

    def evaluate(self, t: Floats) -> CurvePoints:
        """Curve at the parameters t (n,), for `CurvedSegment`."""
        curve = self.segment.evaluate(t)
        return replace(
            curve, point=rotated(curve.point, self.angle), angle=curve.angle + self.angle
        )


def thinned(profile: ToothProfile, c_P: float) -> ToothProfile:
    """The flank of a tooth that is thinner by (1 - c_P) of half a pitch (eq. 3.22)."""
    if c_P == 1.0:
        return profile
    angle = 0.5 * (1.0 - c_P) * np.pi / profile.n_teeth
    return replace(profile, segments=tuple(_turned(one, angle) for one in profile.segments))


def _turned(segment: FlankSegment, angle: float) -> FlankSegment:
    if isinstance(segment, Segment):
        x, y = rotated(np.array(segment.start), angle)
        return replace(segment, start=(float(x), float(y)), direction=segment.direction + angle)
    if not isinstance(segment, CurvedSegment):
        raise TypeError(f"no rotation of a {type(segment).__name__}")
    return CurvedSegment(segment.name, _Turned(segment, angle).evaluate)
