"""The load states of a run in order, from the design: stages, load program, angles of the
rotation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.design.input_coupling import InputCoupling
from swgpar.design.kinematics import Kinematics
from swgpar.design.sections import Steps
from swgpar.geometry.cams import pin_travel
from swgpar.load.load_program import (
    ProgramPoint,
    StiffnessProgram,
    begins_with_rotation,
    ratcheting_points,
    stage_points,
)
from swgpar.load.load_states import (
    CAM_START_CLEARANCE,
    FLANK_START_CLEARANCE,
    PIN_RETRACTION,
    LoadState,
    Stage,
)


def start_state(design: DriveDesign) -> LoadState:
    """Undeformed drive; the pins, or the shrunk cam, touch the inner surface."""
    travel = pin_travel(design.cam(), design.inner_radius, design.wave_generator.lobes)
    if design.uses_pins:
        return LoadState(Stage.START, 0, pin_inset=travel)
    return LoadState(Stage.START, 0, cam_clearance=travel)


def program_points(design: DriveDesign) -> list[ProgramPoint]:
    """All points of the design's load program in order; none without a program."""
    if design.stiffness:
        return stiffness_program(design).points()
    if design.ratcheting:
        return ratcheting_points(design.ratcheting, design.kinematics)
    return stage_points(design.load.program)


def stiffness_program(design: DriveDesign) -> StiffnessProgram:
    """The program of a design with [stiffness]."""
    section = design.stiffness
    torque = section.torque or design.load.torque
    kinematics = design.kinematics
    period = float(np.degrees(kinematics.period_angle))
    by_teeth = kinematics.standing_gear != "flexible_spline" and design.contact.friction == 0.0
    return StiffnessProgram(
        section,
        torque,
        section.rated_torque or torque,
        design.negligible_torque_Nm,
        tuple(period * k / section.positions for k in range(section.positions)),
        uses_mirror=not section.loop and design.is_mirror_symmetric,
        starts_mirrored=not section.loop and design.starts_mirror_symmetric,
        direction=kinematics.torque_direction if by_teeth else None,
    )


@dataclass(frozen=True)
class LoadSequence:
    """The load states of a run, and what evaluations need to know of them.

    kinematics : of the drive
    start : undeformed drive
    states : at the ends of all increments, in order
    points : of the load program; empty without one
    coupling : at the input, of a design with [stiffness]; None without one
    torque : N·m, `load.torque`
    rotation, increment : deg, `steps.rotation` and `steps.increment`
    samples : angles of one period that are computed and continued by symmetry; 0 without
    periods : that are computed with them: two with friction, whose state settles in the first
    repeats : whether the drive is in the same state again after a period of its motion
    """

    kinematics: Kinematics
    start: LoadState
    states: tuple[LoadState, ...]
    points: tuple[ProgramPoint, ...]
    coupling: InputCoupling | None
    torque: float
    rotation: float
    increment: float
    samples: int
    periods: int
    repeats: bool

    @property
    def loaded(self) -> LoadState:
        """The fully loaded state, in a load program that of its first point; the assembled drive
        where the program is a rotation of the output, which is followed from there."""
        return self.from_loaded[0]

    @property
    def from_loaded(self) -> tuple[LoadState, ...]:
        """The states from the fully loaded one on."""
        stages = [state.stage for state in self.states]
        if Stage.PROGRAM in stages:
            first = stages.index(Stage.PROGRAM)
            return self.states[first - begins_with_rotation(self.points) :]
        return self.states[len(stages) - 1 - stages[::-1].index(Stage.LOAD) :]


def load_sequence(design: DriveDesign) -> LoadSequence:
    """All load states of a run."""
    kinematics, steps, start = design.kinematics, design.steps, start_state(design)
    points, module = tuple(program_points(design)), design.drive.module
    states = [
        *_deflection(start, steps.deflect_increments),
        *_engagement(
            steps.engage_increments, module, design.deflection if design.uses_pins else 0.0
        ),
    ]
    if points:
        states += _program(points, kinematics)
    else:
        torque = kinematics.internal_torque(design.load.torque)
        angles = rotation_angles(steps, kinematics.period_angle, design.periods)
        states += _rotation(
            torque if abs(torque) > design.negligible_torque else 0.0,
            steps.load_increments,
            angles,
            kinematics.ratio,
        )
    if design.dynamic_spline is not None:
        states = [replace(state, spline_held=state.control == "rotation") for state in states]
    return LoadSequence(
        kinematics=kinematics,
        start=start,
        states=tuple(states),
        points=points,
        coupling=design.input_coupling if design.stiffness else None,
        torque=design.load.torque,
        rotation=steps.rotation,
        increment=steps.increment,
        samples=steps.samples,
        periods=design.periods,
        repeats=design.repeats,
    )


def _deflection(start: LoadState, increments: int) -> Iterator[LoadState]:
    for i in range(1, increments + 1):
        left = 1.0 - i / increments
        if start.pin_inset is not None:
            yield LoadState(Stage.DEFLECT, 1, pin_inset=start.pin_inset * left)
        else:
            yield LoadState(Stage.DEFLECT, 1, cam_clearance=start.cam_clearance * left)


def _engagement(increments: int, module: float, by_pins: float) -> Iterator[LoadState]:
    """by_pins : mm, deflection by pins; 0 where the cam has grown"""
    for i in range(1, increments + 1):
        t = i / increments
        yield LoadState(
            Stage.ENGAGE,
            2,
            cam_clearance=CAM_START_CLEARANCE * module * (1.0 - t) if by_pins else 0.0,
            flank_clearance=FLANK_START_CLEARANCE * module * (1.0 - t),
            pin_inset=PIN_RETRACTION * by_pins * t if by_pins and i < increments else None,
        )


def _rotation(
    torque: float, increments: int, angles: Sequence[float], ratio: float
) -> Iterator[LoadState]:
    """The stages LOAD and ROTATE.

    torque : N mm, about z on the output;  increments : of the torque
    angles : rad, of the wave generator
    """
    loaded = LoadState(Stage.LOAD, 3, cam_clearance=0.0, flank_clearance=0.0)
    if torque:
        loaded = replace(loaded, control="torque", torque=torque)
        for i in range(1, increments):
            yield replace(loaded, torque=torque * i / increments)
    yield loaded
    for step, angle in enumerate(angles, start=int(Stage.ROTATE)):
        yield replace(
            loaded, stage=Stage.ROTATE, step=step, angle=angle, output_rotation=angle / ratio
        )


def _program(points: Sequence[ProgramPoint], kinematics: Kinematics) -> Iterator[LoadState]:
    for step, point in enumerate(points, start=int(Stage.LOAD)):
        state = LoadState(
            Stage.PROGRAM,
            step,
            float(np.radians(point.angle)),
            cam_clearance=0.0,
            flank_clearance=0.0,
        )
        if point.control == "torque":
            torque = kinematics.internal_torque(point.value)
            yield replace(state, control="torque", torque=torque)
        else:
            yield replace(state, output_rotation=float(np.radians(point.value)))


def rotation_angles(steps: Steps, period: float, periods: int) -> list[float]:
    """Angles (rad) of the wave generator at the ends of the computed increments of its rotation.

    With `steps.samples` these are the angles of one period (rad). The last one is left out, because
    the drive is then in its loaded state again. Of two periods, the first of which settles, it is
    not.
    """
    if steps.samples:
        count = steps.samples - 1 if periods == 1 else periods * steps.samples
        return [period * i / steps.samples for i in range(1, count + 1)]
    count = int(np.ceil(round(steps.rotation / steps.increment, 9)))
    return [
        float(np.radians(min(i * steps.increment, steps.rotation))) for i in range(1, count + 1)
    ]
