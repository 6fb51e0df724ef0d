"""Load programs: the points at which a path of torques, output rotations and wave-generator angles
stops.

A program is written in the design file, or generated from its sections [stiffness] and
[ratcheting].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.design.program_sections import ProgramStage

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


def program_points(design: DriveDesign) -> list[ProgramPoint]:
    """All points of the design's load program in order; none without a program."""
    if design.stiffness:
        return _stiffness(design)
    if design.ratcheting:
        return _ratcheting(design)
    return stage_points(design.load.program)


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
    found: list[Control] = []
    for stage in stages:
        before: Control = found[-1] if found else "rotation"
        found.append(
            "torque"
            if stage.torque is not None
            else before
            if stage.output_rotation is None
            else "rotation"
        )
    return found


def _with_torque(points: Sequence[ProgramPoint]) -> list[ProgramPoint]:
    """The points with `NO_TORQUE` in place of zero, in the direction of the torque before it, or
    else after it."""
    torques = [point.value for point in points if point.control == "torque" and point.value]
    least, found = NO_TORQUE * max(map(abs, torques), default=0.0), []
    sign = np.sign(torques[0]) if torques else 1.0
    for point in points:
        if point.control == "torque" and abs(point.value) < least:
            point = replace(point, value=float(sign * least))
        elif point.control == "torque":
            sign = np.sign(point.value)
        found.append(point)
    return found


# -- generated programs ----------------------------------------------------------------------------


def stiffness_torque(design: DriveDesign) -> float:
    """Largest torque of the stiffness loop, N·m."""
    return design.stiffness.torque or design.load.torque


def rated_torque(design: DriveDesign) -> float:
    """Torque that the lost motion refers to, N·m."""
    return design.stiffness.rated_torque or stiffness_torque(design)


def stiffness_torques(design: DriveDesign) -> list[float]:
    """Torques (N·m) of one branch of the stiffness loop, ascending from that which stands for
    zero."""
    section, top = design.stiffness, stiffness_torque(design)
    even = np.linspace(0.0, 1.0, section.points + 1)[1:] * top
    ends = [share * top for share in (NO_TORQUE, *section.break_points)]
    needed = [*ends, section.lost_motion_share * rated_torque(design)]
    return sorted({round(float(torque), 12) for torque in [*even, *needed]})


def stiffness_angles(design: DriveDesign) -> list[float]:
    """Angles (deg) of the wave generator at which the stiffness is found."""
    count = design.stiffness.positions
    return [float(np.degrees(design.period_angle)) * k / count for k in range(count)]


def computed_position(design: DriveDesign, k: int) -> int:
    """Index of the angle of `stiffness_angles` whose loop stands for that at the angle k.

    Without friction a drive with a mirror plane has the same stiffness at the angle that the mirror
    makes of it.
    """
    return min(k, design.stiffness.positions - k) if _uses_mirror(design) else k


def _uses_mirror(design: DriveDesign) -> bool:
    return not design.stiffness.loop and design.is_mirror_symmetric


def _stiffness(design: DriveDesign) -> list[ProgramPoint]:
    torques, angles = stiffness_torques(design), stiffness_angles(design)
    down, up = torques[::-1], [-torque for torque in torques]
    branches = dict(zip(BRANCHES, (down, up, up[::-1], torques), strict=True))
    points: list[ProgramPoint] = []

    def add(stage: str, angle: float, values: Sequence[float]) -> None:
        points.extend(ProgramPoint(stage, angle, "torque", value) for value in values)

    for k in dict.fromkeys(computed_position(design, k) for k in range(len(angles))):
        if design.stiffness.loop:
            if k:
                add(TRAVEL, points[-1].angle, torques[:1])
                add(TRAVEL, angles[k], torques[:1])
            add(FIRST_LOADING, angles[k], torques[1:] if k else torques)
            for name, values in branches.items():
                # an unloading begins where the loading before it has ended
                add(name, angles[k], values[1:] if abs(values[0]) > abs(values[-1]) else values)
        else:
            for name in _one_way(design, k, points[-1].value if points else 0.0):
                add(name, angles[k], branches[name])
    return points


def _one_way(design: DriveDesign, k: int, torque: float) -> tuple[str, ...]:
    """Branches that suffice at the angle k where the way back is the same. torque : in which the
    position before ended

    Where the mirror plane is that of the wave generator too, one side of the loop is the image of
    the other.
    """
    way = BRANCHES[:2] if torque >= 0.0 else BRANCHES[2:]
    if _uses_mirror(design) and 2 * k in (0, design.stiffness.positions):
        return way[:1] if k else (POSITIVE_LOADING,)
    return way


def pitch_angle(design: DriveDesign) -> float:
    """Angle of a pitch of the output, deg: a rotation by it with the wave generator locked renames
    its teeth."""
    return 360.0 / design.drive.teeth(design.output_gear).n_teeth


def _ratcheting(design: DriveDesign) -> list[ProgramPoint]:
    section, pitch = design.ratcheting, pitch_angle(design)
    count = int(np.ceil(round(section.limit / section.increment, 9)))
    shares = [min(i * section.increment, section.limit) for i in range(1, count + 1)]
    start = section.wave_generator / design.ratio
    angles = [start + torque_direction(design.ratio) * share * pitch for share in shares]
    return [ProgramPoint(RATCHETING, section.wave_generator, "rotation", angle) for angle in angles]


def torque_direction(ratio: float) -> float:
    """Sense about z in which a positive torque turns the output: against its motion, 1 or -1.

    ratio : speed of the wave generator over that of the output
    """
    return float(-np.sign(ratio))


def internal_torque(ratio: float, torque: float) -> float:
    """Torque about z on the output (N mm) for one against its motion (N·m). ratio : as in
    `torque_direction`"""
    return torque_direction(ratio) * 1000.0 * torque
