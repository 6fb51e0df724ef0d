"""Checks of load programs. Each refusal names the key, its value and what is allowed."""

from __future__ import annotations

import re

from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.load.load_program import (
    NO_TORQUE,
    RATCHETING,
    controls,
    stiffness_program,
)

NAME = re.compile(r"[A-Za-z0-9_ +-]+")
"""Names of stages: they stand in tables and in names of quantities."""

MOST_ROTATION = 170.0
"""Rotation (deg) of the output up to which it is prescribed: beyond half a turn its angle is
ambiguous."""


def given_program(design: DriveDesign) -> str | None:
    """Name of the section that gives the load program; None without one."""
    return next((name for name, there in _programs(design).items() if there), None)


def check_program(design: DriveDesign) -> None:
    """Raise InputError for the first thing that does not fit in a load program."""
    given = [name for name, there in _programs(design).items() if there]
    if len(given) > 1:
        raise InputError(
            f"{given[0]} and {given[1]} are both given: allowed one of "
            f"{', '.join(_programs(design))}"
        )
    if given and design.steps.samples:
        raise InputError(
            f"steps.samples = {design.steps.samples} is out of range: allowed only 0 with "
            f"{given[0]}"
        )
    if given and design.losses:
        raise InputError(
            f"[losses] is not available with {given[0]}: allowed under one torque, with "
            f"steps.samples"
        )
    if design.fatigue and (design.stiffness or design.ratcheting):
        raise InputError(
            f"[fatigue] is not available with {given[0]}: allowed with load.program, or with "
            f"steps.samples"
        )
    if design.load.program:
        _check_stages(design)
    if design.stiffness:
        _check_stiffness(design)
    if design.ratcheting:
        _check_ratcheting(design)


def _programs(design: DriveDesign) -> dict[str, bool]:
    return {
        "load.program": bool(design.load.program),
        "[stiffness]": design.stiffness is not None,
        f"[{RATCHETING}]": design.ratcheting is not None,
    }


def _check_stages(design: DriveDesign) -> None:
    stages = design.load.program
    kinds = controls(stages)
    names = [stage.name for stage in stages]
    for k, stage in enumerate(stages):
        key = f"load.program.{k + 1}"
        if not NAME.fullmatch(stage.name) or stage.name in names[:k]:
            raise InputError(
                f"{key}.name = {stage.name!r} is not available: allowed a name that no stage "
                f"before has, of letters, "
                "digits, spaces and _ + -"
            )
        if stage.torque is not None and stage.output_rotation is not None:
            raise InputError(
                f"{key}.torque = {stage.torque:g} and {key}.output_rotation = "
                f"{stage.output_rotation:g} are both "
                "given: allowed one of them"
            )
        if (
            kinds[k] == "rotation" and design.kinematics.wave_generator_is_fixed
        ):  # rotations are prescribed in another frame
            raise InputError(
                f"{key}.torque is missing: allowed only stages with a torque with drive.layout = "
                f'"wave_generator_fixed"'
            )
        if stage.points > 1 and k and kinds[k] != kinds[k - 1]:
            raise InputError(
                f"{key}.points = {stage.points} is out of range: allowed 1 where the output "
                f"changes between torque and "
                "prescribed rotation"
            )
        if stage.torque == 0.0 and not any(other.torque for other in stages):
            raise InputError(
                f"{key}.torque = 0 is out of range: allowed beside a stage with another torque, of "
                f"which a share of "
                f"{NO_TORQUE:g} stands for zero"
            )


def _check_stiffness(design: DriveDesign) -> None:
    section, program = design.stiffness, stiffness_program(design)
    if program.torque <= 0.0:
        raise InputError("stiffness.torque is missing: give it, or load.torque, above 0 N·m")
    share = program.lost_motion_torque / program.torque
    ends = section.break_points
    if len(ends) != 2 or not share < ends[0] < ends[1] < 1.0:
        raise InputError(
            f"stiffness.break_points = {ends} is out of range: allowed two shares of the largest "
            f"torque, ascending, "
            f"above {share:.3g} (that of the lost motion) and below 1"
        )
    if share <= NO_TORQUE:
        raise InputError(
            f"stiffness.lost_motion_share = {section.lost_motion_share:g} is out of range: allowed "
            f"above {NO_TORQUE:g} "
            "of the largest torque"
        )
    if section.loop is False and design.contact.friction:
        raise InputError(
            "stiffness.loop = false is out of range: allowed true with friction, whose loop has an "
            "area"
        )


def _check_ratcheting(design: DriveDesign) -> None:
    section = design.ratcheting
    if section.increment > section.limit:
        raise InputError(
            f"ratcheting.limit = {section.limit:g} is out of range: allowed {section.increment:g} "
            f"pitches "
            "(ratcheting.increment) and more"
        )
    pitch = design.kinematics.output_pitch
    if section.limit * pitch > MOST_ROTATION:
        raise InputError(
            f"ratcheting.limit = {section.limit:g} is out of range: allowed up to "
            f"{MOST_ROTATION / pitch:.3g} pitches, {MOST_ROTATION:g} degrees"
        )
