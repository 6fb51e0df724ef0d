"""Involute gears in mesh on their pitch circles: tips, path of contact, phases of a stage.

Lengths are in mm, in the transverse section. Sun and planets have opposite profile shifts, the ring
that of the planets, so that the pitch circles are the reference circles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class ToothedGear:
    """teeth : number, of a ring below 0;  module : transverse
    angle : transverse pressure angle, rad
    shift, addendum, dedendum : in mm, away from the body of the gear
    """

    teeth: int
    module: float
    angle: float
    shift: float
    addendum: float
    dedendum: float

    @property
    def sign(self) -> int:
        """-1 of a ring."""
        return 1 if self.teeth > 0 else -1

    @property
    def pitch_radius(self) -> float:
        return 0.5 * self.module * abs(self.teeth)

    @property
    def base_radius(self) -> float:
        return self.pitch_radius * float(np.cos(self.angle))

    @property
    def tip_radius(self) -> float:
        return self.pitch_radius + self.sign * (self.addendum + self.shift)

    @property
    def root_radius(self) -> float:
        return self.pitch_radius - self.sign * (self.dedendum - self.shift)

    @property
    def tooth_angle(self) -> float:
        """Angle of the tooth at the pitch circle, rad, without backlash."""
        return (np.pi + 4.0 * self.shift / self.module * np.tan(self.angle)) / abs(self.teeth)

    @property
    def beyond_pitch(self) -> float:
        """Path of contact from the pitch point to the tip circle, without a limit by the base."""
        along = np.sqrt(max(self.tip_radius**2 - self.base_radius**2, 0.0))
        return float(self.sign * (along - self.pitch_radius * np.sin(self.angle)))


@dataclass(frozen=True)
class GearMesh:
    """Two gears. Contact begins at the tip of the driven one and ends at that of the driving."""

    driving: ToothedGear
    driven: ToothedGear

    @property
    def base_pitch(self) -> float:
        return np.pi * self.driving.module * float(np.cos(self.driving.angle))

    @property
    def path(self) -> tuple[float, float]:
        """Begin and end of contact from the pitch point along the line of action."""
        return -self.driven.beyond_pitch, self.driving.beyond_pitch

    @property
    def contact_ratio(self) -> float:
        """Transverse contact ratio."""
        begin, end = self.path
        return (end - begin) / self.base_pitch

    @property
    def two_pairs(self) -> float:
        """Where the first pair is in the middle of the time with two pairs, in base pitches."""
        return 0.5 * (sum(self.path) - self.base_pitch) / self.base_pitch


@dataclass(frozen=True)
class ToothedStage:
    """Sun, a planet and ring of a stage whose carrier drives: a planet drives the sun, and in the
    frame of the carrier the ring drives the planets."""

    sun: ToothedGear
    planet: ToothedGear
    ring: ToothedGear

    @property
    def meshes(self) -> tuple[GearMesh, GearMesh]:
        """Of sun and ring."""
        return GearMesh(self.planet, self.sun), GearMesh(self.ring, self.planet)

    @property
    def phase(self) -> float:
        """Cycles by which the ring mesh of a planet is behind its sun mesh, -0.5 to 0.5.

        The leading flank of a tooth of the planet touches the sun, the trailing one the ring, half
        a turn apart.
        """
        at_pitch_points = 0.5 * self.planet.teeth * (1.0 + self.planet.tooth_angle / np.pi)
        sun, ring = self.meshes
        return float((at_pitch_points + ring.two_pairs - sun.two_pairs + 0.5) % 1.0 - 0.5)
