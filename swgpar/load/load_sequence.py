"""The load states of a run in order, from the design: stages, load program, angles of the rotation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.cams import pin_travel
from swgpar.load.load_program import internal_torque, program_points
from swgpar.load.load_states import CAM_START_CLEARANCE, FLANK_START_CLEARANCE, PIN_RETRACTION, LoadState, Stage

RING_FLEXIBILITY = 0.25 * np.pi - 2.0 / np.pi
"""Change of the diameter of a ring under two opposed forces F, over F r^3 / (E I) (Timoshenko)."""

NEGLIGIBLE = 1e-4
"""Share of the bending force up to which a force on the teeth counts as none.

Newton's iteration balances it together with the forces that bend the flexible spline: far below them, the flanks that
carry it do not settle. The stresses by bending are larger by the same ratio.
"""


def negligible_torque(design: DriveDesign) -> float:
    """Output torque (N·mm) up to which a drive counts as unloaded: that of `NEGLIGIBLE` at the spline's radius.

    The bending force is that of a ring with the section of the rim, between two opposed forces.
    """
    rim, radius = design.flexible_spline.rim, design.inner_radius + 0.5 * design.flexible_spline.rim
    stiffness = design.material.E * design.drive.face_width * rim**3 / 12.0
    force = design.deflection * stiffness / (RING_FLEXIBILITY * radius**3)
    return NEGLIGIBLE * force * radius


def counts_as_none(design: DriveDesign) -> bool:
    """Whether the design has a torque that is too small beside the bending of the flexible spline."""
    return 0.0 < 1000.0 * design.load.torque <= negligible_torque(design)


def start_state(design: DriveDesign) -> LoadState:
    """Undeformed drive; the pins, or the shrunk cam, touch the inner surface."""
    travel = pin_travel(design.cam(), design.inner_radius, design.lobes)
    if design.uses_pins:
        return LoadState(Stage.START, 0, pin_inset=travel)
    return LoadState(Stage.START, 0, cam_clearance=travel)


def load_sequence(design: DriveDesign) -> Iterator[LoadState]:
    """Load states at the ends of all increments of a run, in order."""
    for state in _sequence(design):
        held = design.dynamic_spline is not None and state.control == "rotation"
        yield replace(state, spline_held=True) if held else state


def _sequence(design: DriveDesign) -> Iterator[LoadState]:
    yield from _deflection(design)
    yield from _engagement(design)
    if design.has_program:
        yield from _program(design)
        return
    torque = 0.0 if counts_as_none(design) else internal_torque(design, design.load.torque)
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


def _deflection(design: DriveDesign) -> Iterator[LoadState]:
    origin, n = start_state(design), design.steps.deflect_increments
    for i in range(1, n + 1):
        if origin.pin_inset is not None:
            yield LoadState(Stage.DEFLECT, 1, pin_inset=origin.pin_inset * (1.0 - i / n))
        else:
            yield LoadState(Stage.DEFLECT, 1, cam_clearance=origin.cam_clearance * (1.0 - i / n))


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


def _program(design: DriveDesign) -> Iterator[LoadState]:
    for step, point in enumerate(program_points(design), start=int(Stage.LOAD)):
        state = LoadState(Stage.PROGRAM, step, float(np.radians(point.angle)), cam_clearance=0.0, flank_clearance=0.0)
        if point.control == "torque":
            yield replace(state, control="torque", torque=internal_torque(design, point.value))
        else:
            yield replace(state, output_rotation=float(np.radians(point.value)))


def from_loaded(states: list[LoadState]) -> list[LoadState]:
    """The load states from the fully loaded one on, of a load program from its first point on."""
    ends = [k for k, state in enumerate(states) if state.stage == Stage.LOAD]
    loaded = ends[-1] if ends else next(k for k, state in enumerate(states) if state.stage == Stage.PROGRAM)
    return states[loaded:]


def rotation_angles(design: DriveDesign) -> list[float]:
    """Angles (rad) of the wave generator at the ends of the computed increments of its rotation.

    With `steps.samples` these are the angles of one period. The last one is left out, because the drive is then in its
    loaded state again. With friction they are the angles of two periods; the slip settles in the first one.
    """
    steps = design.steps
    if steps.samples:
        count = 2 * steps.samples if design.contact.friction else steps.samples - 1
        return [design.period_angle * i / steps.samples for i in range(1, count + 1)]
    count = int(np.ceil(round(steps.rotation / steps.increment, 9)))
    return [float(np.radians(min(i * steps.increment, steps.rotation))) for i in range(1, count + 1)]
