"""Checks of load programs. Each refusal names the key, its value and what is allowed."""

from __future__ import annotations

import re
from itertools import pairwise

from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.input.require import require, require_available
from swgpar.load.load_program import NO_TORQUE, RATCHETING, controls
from swgpar.load.load_sequence import stiffness_program

NAME = re.compile(r"[A-Za-z0-9_ +-]+")
"""Names of stages: they stand in tables and in names of quantities."""

MOST_ROTATION = 170.0
"""Rotation (deg) of the output up to which it is prescribed: beyond half a turn its angle is
ambiguous."""


CLOSEST = 0.01
"""Least share of the largest torque between two points of a loop that a stiffness is taken from:
closer ones have the round-off of the torques between them."""


def given_program(design: DriveDesign) -> str | None:
    """Name of the section that gives the load program; None without one."""
    return next((name for name, section in _programs(design).items() if section), None)


def in_rating(program: str) -> str:
    """What ends the sentence that refuses a section beside a generated program: a run has one path
    of loads, and a rating several runs. Empty for the program of a design file."""
    return "" if program == "load.program" else "; swgpar rate has a run for each"


def check_program(design: DriveDesign) -> None:
    """Raise InputError for the first thing that does not fit in a load program."""
    programs = _programs(design)
    given = [name for name, section in programs.items() if section]
    if len(given) > 1:
        raise InputError(
            f"{given[0]} and {given[1]} are both given: allowed one of {', '.join(programs)}"
            f"{in_rating(given[-1])}"
        )
    if given:
        samples = design.steps.samples
        own = in_rating(given[0])
        require(samples == 0, "steps.samples", samples, f"only 0 with {given[0]}{own}")
        allowed = f"under one torque, with steps.samples{own}"
        require_available(not design.losses, "[losses]", given[0], allowed)
        allowed = f"with load.program, or with steps.samples{own}"
        judged = not design.fatigue or bool(design.load.program)
        require_available(judged, "[fatigue]", given[0], allowed)
    if design.load.program:
        _check_stages(design)
    if design.stiffness:
        _check_stiffness(design)
    if design.ratcheting:
        _check_ratcheting(design)


def _programs(design: DriveDesign) -> dict[str, object]:
    return {
        "load.program": design.load.program,
        "[stiffness]": design.stiffness,
        f"[{RATCHETING}]": design.ratcheting,
    }


def _check_stages(design: DriveDesign) -> None:
    stages = design.load.program
    kinds, names = controls(stages), [stage.name for stage in stages]
    in_other_frame = design.kinematics.wave_generator_is_fixed
    for k, stage in enumerate(stages):
        key = f"load.program.{k + 1}"
        if not NAME.fullmatch(stage.name) or stage.name in names[:k]:
            raise InputError(
                f"{key}.name = {stage.name!r} is not available: allowed a name that no stage "
                f"before has, of letters, digits, spaces and _ + -"
            )
        if stage.torque is not None and stage.output_rotation is not None:
            raise InputError(
                f"{key}.torque = {stage.torque:g} and {key}.output_rotation = "
                f"{stage.output_rotation:g} are both given: allowed one of them"
            )
        if kinds[k] == "rotation" and in_other_frame:
            raise InputError(
                f"{key}.torque is missing: allowed only stages with a torque with drive.layout = "
                f'"wave_generator_fixed"'
            )
        require(
            stage.points == 1 or k == 0 or kinds[k] == kinds[k - 1],
            f"{key}.points",
            stage.points,
            "1 where the output changes between torque and prescribed rotation",
        )
        require(
            stage.torque != 0.0 or any(other.torque for other in stages),
            f"{key}.torque",
            stage.torque,
            f"beside a stage with another torque, of which a share of {NO_TORQUE:g} stands for "
            f"zero",
        )


def _check_stiffness(design: DriveDesign) -> None:
    section, program = design.stiffness, stiffness_program(design)
    if program.torque <= 0.0:
        raise InputError("stiffness.torque is missing: give it, or load.torque, above 0 N·m")
    share, ends = program.lost_motion_torque / program.torque, section.break_points
    require(
        len(ends) == 2 and all(b - a >= CLOSEST for a, b in pairwise([share, *ends, 1.0])),
        "stiffness.break_points",
        ends,
        f"two shares of the largest torque, ascending, above {share:.3g} (that of the lost motion) "
        f"and below 1, {CLOSEST:g} apart and more",
    )
    allowed = f"above {NO_TORQUE:g} of the largest torque"
    lost = section.lost_motion_share
    require(share > NO_TORQUE, "stiffness.lost_motion_share", lost, allowed)
    allowed = "true with friction, whose loop has an area"
    require(section.loop or not design.contact.friction, "stiffness.loop", section.loop, allowed)


def _check_ratcheting(design: DriveDesign) -> None:
    section, pitch = design.ratcheting, design.kinematics.output_pitch
    key, most = "ratcheting.limit", MOST_ROTATION / pitch
    allowed = f"{section.increment:g} pitches (ratcheting.increment) and more"
    require(section.limit >= section.increment, key, section.limit, allowed)
    allowed = f"up to {most:.3g} pitches, {MOST_ROTATION:g} degrees"
    require(section.limit <= most, key, section.limit, allowed)
    start, enough = section.start_torque, section.sufficient_torque
    if start is not None and enough is not None:
        allowed = f"below {enough:g} N·m (ratcheting.sufficient_torque)"
        require(start < enough, "ratcheting.start_torque", start, allowed)
