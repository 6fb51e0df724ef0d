"""Speeds and angles of a drive (docs/theory/kinematics.md)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from swgpar.design.ball_phases import ball_passings
from swgpar.design.sections import GearName


@dataclass(frozen=True)
class Kinematics:
    """What the layout and the numbers of teeth make of the motion of a drive.

    teeth_fs, teeth_rg : numbers of teeth; a dynamic spline has those of the flexible spline
    lobes, lobes_are_alike : of the wave generator, without its balls
    output_gear : the gear that is the output
    standing_gear : the gear that stands in the frame in which the drive is computed: the fixed one,
    or the driven ring gear
    wave_generator_is_fixed : whether the ring gear is the input. Everything is then computed in the
    frame of the ring gear.
    bolts : that hold the flexible spline, evenly spaced; 0 without
    balls, balls_pass : number of balls of the bearing, 0 without one, and whether they roll past
    the wave generator
    """

    teeth_fs: int
    teeth_rg: int
    lobes: int
    lobes_are_alike: bool
    output_gear: GearName
    standing_gear: GearName
    wave_generator_is_fixed: bool
    bolts: int = 0
    balls: int = 0
    balls_pass: bool = False

    def teeth(self, gear: GearName) -> int:
        """Number of teeth of a gear."""
        return self.teeth_rg if gear == "ring_gear" else self.teeth_fs

    @property
    def ratio(self) -> float:
        """Speed ratio, wave generator over output, both against the standing gear."""
        output = self.teeth(self.output_gear)
        sign = 1 if self.output_gear == "ring_gear" else -1
        return sign * output / (self.teeth_rg - self.teeth_fs)

    @property
    def input_ratio(self) -> float:
        """Speed ratio of the drive, input over output."""
        return self.teeth_fs / self.teeth_rg if self.wave_generator_is_fixed else self.ratio

    @property
    def shown_ratio(self) -> float:
        """Angle `wg_angle_deg` of a history over that of the output, in the frame of the result."""
        return -self.input_ratio if self.wave_generator_is_fixed else self.ratio

    @property
    def spline_speed(self) -> float:
        """Speed of the flexible spline over that of the wave generator, against the standing
        gear."""
        return 0.0 if self.output_gear == "ring_gear" else 1.0 / self.ratio

    @property
    def speeds_in_space(self) -> tuple[float, float]:
        """Speeds of the flexible spline and of the wave generator in space over that of the
        input."""
        if self.wave_generator_is_fixed:
            return 1.0 - self.spline_speed, 0.0
        return self.spline_speed, 1.0

    @property
    def pitch_angle(self) -> float:
        """Rotation of the wave generator against the standing gear (rad) in which a tooth takes the
        place of its neighbour: one pitch angle of that gear."""
        return 2.0 * np.pi / self.teeth(self.standing_gear)

    @property
    def alike(self) -> int:
        """Positions of the flexible spline in a turn at which it looks the same: its teeth, with
        bolts those that both teeth and bolts have in common."""
        return math.gcd(self.teeth_fs, self.bolts)

    @property
    def pitches(self) -> int:
        """Pitches of the standing gear in a period: with bolts the teeth that are not alike."""
        return self.teeth_fs // self.alike

    @property
    def period_angle(self) -> float:
        """Period of the motion, rad of the wave generator against the standing gear."""
        return self.pitches * self.pitch_angle

    def ball_passings(self, samples: int) -> int:
        """By how many places the balls go on past the wave generator in a period of which so many
        angles are computed; 0 without balls that pass."""
        if not self.balls_pass:
            return 0
        return ball_passings(samples, self.teeth_fs / self.balls, self.pitches)

    def repeats(self, samples: int) -> int:
        """How often the drive comes to the same state within a period of so many angles, apart from
        names of teeth, lobes and balls.

        Where like lobes do not divide the teeth, or those that are alike, they reach the middle of
        one after another. The balls must be at the same places of the lobes then.
        """
        if not self.lobes_are_alike:
            return 1
        teeth, passings = self.alike, self.ball_passings(samples)
        like = [
            lobe
            for lobe in range(self.lobes)
            if lobe * (passings * teeth + self.balls) % self.lobes == 0
        ]
        return len({lobe * teeth % self.lobes for lobe in like})

    def states(self, samples: int) -> int:
        """How many different states so many angles show, evenly spaced in a period."""
        return samples // math.gcd(samples, self.repeats(samples))

    def apart(self, samples: int) -> int:
        """The largest number of angles, evenly spaced in a period and at most `samples`, of which
        no two show the same state."""
        while self.states(samples) < samples:
            samples -= 1
        return samples

    @property
    def output_pitch(self) -> float:
        """Angle of a pitch of the output, deg: a rotation by it with the wave generator locked
        renames its teeth."""
        return 360.0 / self.teeth(self.output_gear)

    @property
    def torque_direction(self) -> float:
        """Sense about z in which a positive torque turns the output: against its motion, 1 or
        -1."""
        return float(-np.sign(self.ratio))

    def internal_torque(self, torque: float) -> float:
        """Torque about z on the output (N mm) for one against its motion (N·m)."""
        return self.torque_direction * 1000.0 * torque

    def wave_generator_torque(self, torque: float) -> float:
        """Mean torque of the wave generator (N mm) by the energy balance, for a torque on the
        output (N·m)."""
        return 1000.0 * torque / abs(self.ratio)

    def in_frame_of_result(self, angle: float, wave_generator: float) -> float:
        """Angle in the frame of the fixed member, from that in the frame in which the drive is
        computed.

        wave_generator : its angle against the standing gear, in the unit of the angle
        """
        return angle - wave_generator if self.wave_generator_is_fixed else angle
