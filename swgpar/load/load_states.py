"""Load states: what is active at the end of every increment (sections 3.4.5 and 3.5.5).

The stages follow each other:

1. DEFLECT: the pins, the lobes of the cam, push the flexible spline outward by d / 2 each. A cam
that bulges
   beside its tips pushes farther. With `steps.pins = false`, and with a bearing, the cam grows
   out of the circle instead.
2. ENGAGE: the wave generator grows into place, the pins are drawn back, and the flanks may touch.
3. LOAD: the torque is applied. The output rotates until the flanks carry it.
4. ROTATE: the wave generator rotates in increments.

PROGRAM takes the place of LOAD and ROTATE where the design has a load program: every increment goes
to one of its points.

Without a torque, a drive with backlash has no definite output angle. The output is then held at its
kinematic angle, and the torque that this takes is reported. The flexible spline of a pancake drive,
which has no cup, is then held too.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass, replace
from typing import Any, Literal

PIN_RETRACTION = 0.25
"""Distance by which the pins are drawn back during engagement, as a share of the deflection d."""

CAM_START_CLEARANCE, FLANK_START_CLEARANCE = 0.05, 0.05
"""Clearance from which cam and flanks grow into place, as a share of the module."""


SAME_ROTATION = 1e-12
"""Rotation (rad) below which the output has followed the wave generator by its ratio."""


class Stage(enum.IntEnum):
    """Stage of the load sequence; its value is the number in the column `step` of the first
    increment.

    Points of a load program are numbered from that of LOAD on.
    """

    START = 0
    DEFLECT = 1
    ENGAGE = 2
    LOAD = 3
    ROTATE = 4
    PROGRAM = 5

    @property
    def label(self) -> str:
        """Name in messages: "deflect", "engage", …"""
        return self.name.lower()


@dataclass(frozen=True)
class LoadState:
    """Prescribed state of the drive at the end of an increment.

    stage : what the increment does
    step : number in the history's column `step`; increments of the rotation count on from 4
    angle : rad, of the wave generator
    cam_clearance, flank_clearance : mm, added to every gap of the cam or the flanks; None while
    they are switched off
    pin_inset : mm, by which each pin is drawn in towards the axis; None when the pins are out
    control : "rotation" (output held at `output_rotation`, rad) or "torque" (`torque`, N mm,
    against the output's motion)
    spline_held : in a pancake drive, whether the flexible spline is held at the output's kinematic
    angle
    frictionless : whether friction is left out, on the way to a state that is not reached with it
    """

    stage: Stage
    step: int
    angle: float = 0.0
    cam_clearance: float | None = None
    flank_clearance: float | None = None
    pin_inset: float | None = None
    control: Literal["rotation", "torque"] = "rotation"
    output_rotation: float = 0.0
    torque: float = 0.0
    spline_held: bool = False
    frictionless: bool = False

    @property
    def friction_acts(self) -> bool:
        """Whether friction acts: cam and flanks that grow into place are no motion of the drive."""
        return self.stage >= Stage.LOAD and not self.frictionless

    @property
    def is_periodic(self) -> bool:
        """Whether the state belongs to the drive's periodic motion: loaded, or rotating."""
        return self.stage >= Stage.LOAD

    def switches_on(self, before: LoadState) -> bool:
        """Whether a contact is active here that is not in the state `before`; the first state
        switches all on."""

        return before.stage == Stage.START or any(
            getattr(before, name) is None and getattr(self, name) is not None
            for name in ("cam_clearance", "pin_inset", "flank_clearance")
        )

    def continues_period(self, before: LoadState, ratio: float) -> bool:
        """Whether this state follows from `before` in the drive's periodic motion, that is under
        the same load.

        ratio : speed of the wave generator over that of the output
        """
        if self.stage != Stage.PROGRAM:
            return True
        if self.control == "torque" or self.control != before.control:
            return (self.control, self.torque) == (before.control, before.torque)
        turned = self.output_rotation - before.output_rotation - (self.angle - before.angle) / ratio
        return abs(turned) < SAME_ROTATION

    def interpolate(
        self, target: LoadState, share: float, module: float, deflection: float
    ) -> LoadState:
        """State between this one (share 0) and `target` (share 1).

        What the target switches on grows from `CAM_START_CLEARANCE` and `FLANK_START_CLEARANCE`.
        Pins that it takes out are drawn back by `PIN_RETRACTION`.

        module : mm;  deflection : mm, d of the drive
        """
        if share == 1.0:
            return target
        values: dict[str, Any] = {}
        for key in ("angle", "output_rotation", "torque"):
            old, new = getattr(self, key), getattr(target, key)
            values[key] = old + share * (new - old)
        starts = {
            "cam_clearance": CAM_START_CLEARANCE * module,
            "flank_clearance": FLANK_START_CLEARANCE * module,
        }
        for key, clearance in starts.items():
            old, new = getattr(self, key), getattr(target, key)
            if new is not None:
                begin = clearance if old is None else old
                values[key] = (1.0 - share) * begin + share * new
        if self.pin_inset is not None:
            inset = PIN_RETRACTION * deflection if target.pin_inset is None else target.pin_inset
            values["pin_inset"] = self.pin_inset + share * (inset - self.pin_inset)
        return replace(target, **values)
