"""The load states of a run in order, from the design: stages, load program, angles of the
rotation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.cams import pin_travel
from swgpar.load.load_program import ProgramPoint, internal_torque, program_points
from swgpar.load.load_states import (
    CAM_START_CLEARANCE,
    FLANK_START_CLEARANCE,
    PIN_RETRACTION,
    LoadState,
    Stage,
)

RING_FLEXIBILITY = 0.25 * np.pi - 2.0 / np.pi
"""Change of the diameter of a ring under two opposed forces F, over F r^3 / (E I) (Timoshenko)."""

NEGLIGIBLE = 1e-4
"""Share of the bending force up to which a force on the teeth counts as none.

Newton's iteration balances it together with the forces that bend the flexible spline: far below
them, the flanks that carry it do not settle. The stresses by bending are larger by the same ratio.
"""


def negligible_torque(design: DriveDesign) -> float:
    """Output torque (N·mm) up to which a drive counts as unloaded: that of `NEGLIGIBLE` at the
    spline's radius.

    The bending force is that of a ring with the section of the rim, between two opposed forces.
    """
    rim, radius = design.flexible_spline.rim, design.inner_radius + 0.5 * design.flexible_spline.rim
    stiffness = design.modulus_of("flexible_spline") * design.drive.face_width * rim**3 / 12.0
    force = design.deflection * stiffness / (RING_FLEXIBILITY * radius**3)
    return NEGLIGIBLE * force * radius


def counts_as_none(design: DriveDesign) -> bool:
    """Whether the design has a torque that is too small beside the bending of the flexible
    spline."""
    return 0.0 < 1000.0 * design.load.torque <= negligible_torque(design)


def start_state(design: DriveDesign) -> LoadState:
    """Undeformed drive; the pins, or the shrunk cam, touch the inner surface."""
    travel = pin_travel(design.cam(), design.inner_radius, design.lobes)
    if design.uses_pins:
        return LoadState(Stage.START, 0, pin_inset=travel)
    return LoadState(Stage.START, 0, cam_clearance=travel)


@dataclass(frozen=True)
class LoadSequence:
    """The load states of a run.

    start : undeformed drive
    states : at the ends of all increments, in order
    points : of the load program; empty without one
    """

    start: LoadState
    states: tuple[LoadState, ...]
    points: tuple[ProgramPoint, ...] = ()

    @property
    def loaded(self) -> LoadState:
        """The fully loaded state, in a load program that of its first point."""
        return self.from_loaded[0]

    @property
    def from_loaded(self) -> tuple[LoadState, ...]:
        """The states from the fully loaded one on."""
        ends = [k for k, state in enumerate(self.states) if state.stage == Stage.LOAD]
        first = (
            ends[-1]
            if ends
            else next(k for k, state in enumerate(self.states) if state.stage == Stage.PROGRAM)
        )
        return self.states[first:]


def load_sequence(design: DriveDesign) -> LoadSequence:
    """All load states of a run."""
    start, points = start_state(design), tuple(program_points(design))
    states = [*_deflection(start, design.steps.deflect_increments), *_engagement(design)]
    states += _program(points, design.ratio) if points else _rotation(design)
    if design.dynamic_spline is not None:
        states = [replace(state, spline_held=state.control == "rotation") for state in states]
    return LoadSequence(start, tuple(states), points)


def _rotation(design: DriveDesign) -> Iterator[LoadState]:
    """The stages LOAD and ROTATE."""
    torque = 0.0 if counts_as_none(design) else internal_torque(design.ratio, design.load.torque)
    control: Literal["rotation", "torque"] = "torque" if torque else "rotation"
    loaded = LoadState(Stage.LOAD, 3, cam_clearance=0.0, flank_clearance=0.0, control=control)
    if torque:
        n = design.steps.load_increments
        for i in range(1, n + 1):
            yield replace(loaded, torque=torque * i / n)
    else:
        yield loaded
    for i, angle in enumerate(rotation_angles(design), start=1):
        yield replace(
            loaded,
            stage=Stage.ROTATE,
            step=3 + i,
            angle=angle,
            torque=torque,
            output_rotation=angle / design.ratio,
        )


def _deflection(start: LoadState, increments: int) -> Iterator[LoadState]:
    for i in range(1, increments + 1):
        left = 1.0 - i / increments
        if start.pin_inset is not None:
            yield LoadState(Stage.DEFLECT, 1, pin_inset=start.pin_inset * left)
        else:
            yield LoadState(Stage.DEFLECT, 1, cam_clearance=start.cam_clearance * left)


def _engagement(design: DriveDesign) -> Iterator[LoadState]:
    pins, module, n = design.uses_pins, design.drive.module, design.steps.engage_increments
    for i in range(1, n + 1):
        t = i / n
        yield LoadState(
            Stage.ENGAGE,
            2,
            cam_clearance=CAM_START_CLEARANCE * module * (1.0 - t) if pins else 0.0,
            flank_clearance=FLANK_START_CLEARANCE * module * (1.0 - t),
            pin_inset=PIN_RETRACTION * design.deflection * t if pins and i < n else None,
        )


def _program(points: Sequence[ProgramPoint], ratio: float) -> Iterator[LoadState]:
    for step, point in enumerate(points, start=int(Stage.LOAD)):
        state = LoadState(
            Stage.PROGRAM,
            step,
            float(np.radians(point.angle)),
            cam_clearance=0.0,
            flank_clearance=0.0,
        )
        if point.control == "torque":
            yield replace(state, control="torque", torque=internal_torque(ratio, point.value))
        else:
            yield replace(state, output_rotation=float(np.radians(point.value)))


def rotation_angles(design: DriveDesign) -> list[float]:
    """Angles (rad) of the wave generator at the ends of the computed increments of its rotation.

    With `steps.samples` these are the angles of one period. The last one is left out, because the
    drive is then in its loaded state again. With friction they are the angles of two periods; the
    slip settles in the first one.
    """
    steps = design.steps
    if steps.samples:
        count = 2 * steps.samples if design.contact.friction else steps.samples - 1
        return [design.period_angle * i / steps.samples for i in range(1, count + 1)]
    count = int(np.ceil(round(steps.rotation / steps.increment, 9)))
    return [
        float(np.radians(min(i * steps.increment, steps.rotation))) for i in range(1, count + 1)
    ]
