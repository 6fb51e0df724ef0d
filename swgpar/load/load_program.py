"""Load programs: the points at which a path of torques, output rotations and wave-generator angles
stops. They are written in the design file, or generated from its sections [stiffness] and
[ratcheting].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from swgpar.design.kinematics import Kinematics
from swgpar.design.program_sections import ProgramStage, Ratcheting, Stiffness

NO_TORQUE = 1e-3
"""Share of the largest torque of a program that stands for zero.

Without a torque a drive with backlash has no definite angle of the output. Under this one its
flanks just touch.
"""

Control = Literal["rotation", "torque"]
"""What is given at the output."""

POSITIVE_UNLOADING, NEGATIVE_LOADING = "positive unloading", "negative loading"
NEGATIVE_UNLOADING, POSITIVE_LOADING = "negative unloading", "positive loading"
BRANCHES = (POSITIVE_UNLOADING, NEGATIVE_LOADING, NEGATIVE_UNLOADING, POSITIVE_LOADING)
"""Branches of the stiffness loop in order, from the largest torque."""

FIRST_LOADING, TRAVEL = "first loading", "travel"
"""Stages of the stiffness program beside its loops: from zero to the largest torque, and to the
next angle."""

RATCHETING = "ratcheting"
"""The stage in which the output is rotated beyond the strength."""


@dataclass(frozen=True)
class ProgramPoint:
    """A point of a load program.

    stage : name of the stage that it belongs to
    angle : deg, of the wave generator
    control : whether `value` is the angle of the output (deg) or its torque (N·m, positive against
    its motion)
    """

    stage: str
    angle: float
    control: Control
    value: float


def stage_points(stages: Sequence[ProgramStage]) -> list[ProgramPoint]:
    """Points of stages that follow each other, the first one from the assembled drive without
    torque."""
    points: list[ProgramPoint] = []
    angle, value, before = 0.0, 0.0, "rotation"
    for stage, control in zip(stages, controls(stages)):
        target = next(
            (given for given in (stage.torque, stage.output_rotation) if given is not None), value
        )
        if control != before:
            value = 0.0  # where the control changes later than here, a stage has a single point
        end = angle if stage.wave_generator is None else stage.wave_generator
        for i in range(1, stage.points + 1):
            t = i / stage.points
            points.append(
                ProgramPoint(
                    stage.name, angle + t * (end - angle), control, value + t * (target - value)
                )
            )
        angle, value, before = end, target, control
    return _with_torque(points)


def controls(stages: Sequence[ProgramStage]) -> list[Control]:
    """What every stage gives at the output: a torque or an angle, without both what the one before
    gave."""
    kinds: list[Control] = []
    for stage in stages:
        if stage.torque is not None:
            kinds.append("torque")
        elif stage.output_rotation is not None or not kinds:
            kinds.append("rotation")
        else:
            kinds.append(kinds[-1])
    return kinds


def _with_torque(points: Sequence[ProgramPoint]) -> list[ProgramPoint]:
    """The points with `NO_TORQUE` in place of zero, in the direction of the torque before it, or
    else after it."""
    torques = [point.value for point in points if point.control == "torque" and point.value]
    least, resolved = NO_TORQUE * max(map(abs, torques), default=0.0), []
    sign = np.sign(torques[0]) if torques else 1.0
    for point in points:
        if point.control == "torque" and abs(point.value) < least:
            point = replace(point, value=float(sign * least))
        elif point.control == "torque":
            sign = np.sign(point.value)
        resolved.append(point)
    return resolved


# -- generated programs ----------------------------------------------------------------------------


@dataclass(frozen=True)
class StiffnessProgram:
    """Loops of the torque at angles of the wave generator, by the section [stiffness].

    section : its keys
    torque, rated_torque : N·m, largest of the loop, and that which the lost motion refers to
    negligible : N·m, up to which a torque is no load
    angles : deg, of the wave generator
    uses_mirror : whether an angle has the stiffness of that which the drive's mirror plane makes of
    it: without friction
    starts_mirrored : whether at the first angle one side of the loop is the image of the other one:
    without friction, with a bearing too
    direction : of a positive torque about z, 1 or -1, where nothing but teeth holds the flexible
    spline against it; None with friction, and where the spline stands
    """

    section: Stiffness
    torque: float
    rated_torque: float
    negligible: float
    angles: tuple[float, ...]
    uses_mirror: bool
    starts_mirrored: bool
    direction: float | None

    @property
    def lost_motion_torque(self) -> float:
        """Torque (N·m) at which the lost motion is measured."""
        return self.section.lost_motion_share * self.rated_torque

    @property
    def torques(self) -> list[float]:
        """Torques (N·m) of one branch, ascending from that which stands for zero."""
        even = np.linspace(0.0, 1.0, self.section.points + 1)[1:] * self.torque
        ends = [share * self.torque for share in (NO_TORQUE, *self.section.break_points)]
        needed = [*even, *ends, self.lost_motion_torque]
        return sorted({round(float(torque), 12) for torque in needed})

    def computed(self, k: int) -> int:
        """Index of the angle whose loop stands for that at the angle k."""
        return min(k, len(self.angles) - k) if self.uses_mirror else k

    def points(self) -> list[ProgramPoint]:
        """The points of all loops in order."""
        torques, angles = self.torques, self.angles
        down, up = torques[::-1], [-torque for torque in torques]
        branches = dict(zip(BRANCHES, (down, up, up[::-1], torques), strict=True))
        points: list[ProgramPoint] = []

        def add(stage: str, angle: float, values: Sequence[float]) -> None:
            points.extend(ProgramPoint(stage, angle, "torque", value) for value in values)

        for k in dict.fromkeys(map(self.computed, range(len(angles)))):
            if k == 1 and self.starts_mirrored:  # it turns under the torque that begins there
                add(TRAVEL, angles[0], down[:1])
            if self.section.loop:
                if k:
                    add(TRAVEL, points[-1].angle, torques[:1])
                    add(TRAVEL, angles[k], torques[:1])
                add(FIRST_LOADING, angles[k], torques[1:] if k else torques)
                for name, values in branches.items():
                    # an unloading begins where the loading before it has ended
                    add(name, angles[k], values[1:] if abs(values[0]) > abs(values[-1]) else values)
            else:
                for name in self._one_way(k, points[-1].value if points else 0.0):
                    add(name, angles[k], branches[name])
        return points

    def _one_way(self, k: int, torque: float) -> tuple[str, ...]:
        """Branches that suffice at the angle k where the way back is the same. torque : in which
        the position before ended

        Where the mirror plane is that of the wave generator too, one side of the loop is the image
        of the other. The largest torque comes first: it closes the backlash, which a small one does
        not do against the torque that balls hold the spline with.
        """
        way = BRANCHES[:2] if torque >= 0.0 else BRANCHES[2:]
        halfway = self.uses_mirror and 2 * k == len(self.angles)
        if halfway or (self.starts_mirrored and k == 0):
            return way[:1]
        return way


def begins_with_rotation(points: Sequence[ProgramPoint]) -> bool:
    """Whether a program rotates the output first: that is followed from the assembled drive on."""
    return bool(points) and points[0].control == "rotation" and points[0].value != 0.0


def ratcheting_points(section: Ratcheting, kinematics: Kinematics) -> list[ProgramPoint]:
    """The points of the section [ratcheting]; rotations of the output that the torque at the start
    has passed are among them."""
    count = int(np.ceil(round(section.limit / section.increment, 9)))
    shares = [min(i * section.increment, section.limit) for i in range(1, count + 1)]
    angle, pitch = section.wave_generator, kinematics.output_pitch
    start = angle / kinematics.ratio
    rotations = [start + kinematics.torque_direction * share * pitch for share in shares]
    points = [ProgramPoint(RATCHETING, angle, "rotation", rotation) for rotation in rotations]
    if section.start_torque is not None:
        points.insert(0, ProgramPoint(RATCHETING, angle, "torque", section.start_torque))
    return points
