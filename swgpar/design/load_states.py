"""What is active when: the sequence pins, engagement, torque, rotation (sections 3.4.5 and 3.5.5).

1 the pins, the halves of the cam, push the flexible spline outward by d / 2 each (more for a cam that bulges beside
its tips), or without `steps.pins` the cam grows out of the circle; 2 the wave generator grows into place while the pins
are drawn back, and the teeth may touch; 3 the torque is applied, and the output turns until the teeth carry it; 4 ...
the wave generator turns in increments. Without a torque a drive with backlash has no definite output angle: the output
is then held at its kinematic angle, and the torque this takes is reported.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.geometry.cams import pin_travel

PINS_BACK = 0.25
"""How far the pins are drawn back during engagement, as a share of the deflection d."""

CAM_START, TEETH_START = 0.05, 0.05
"""Clearance from which cam and flanks grow into place, as a share of the module."""


@dataclass(frozen=True)
class LoadState:
    """Prescribed state of the drive at the end of an increment.

    step : number of the step;  name : what it does
    angle : rad, wave generator;  cam, teeth : mm, clearance added to every gap, None while switched off
    pins : mm, inset of the pins, None when they are out
    control : "rotation" (output held at `rotation`, rad) or "torque" (`torque`, N mm, against the output's motion)
    """

    step: int
    name: str
    angle: float = 0.0
    cam: float | None = None
    teeth: float | None = None
    pins: float | None = None
    control: str = "rotation"
    rotation: float = 0.0
    torque: float = 0.0

    def toward(self, target: LoadState, share: float, module: float, travel: float) -> LoadState:
        """Load state between this one (share 0) and `target` (share 1).

        What the target switches on grows from the clearances `CAM_START`, `TEETH_START`; pins that it takes out are
        drawn back by `PINS_BACK` on the way. module : mm;  travel : mm, deflection d of the drive
        """
        if share == 1.0:
            return target
        values: dict[str, Any] = {}
        for key in ("angle", "rotation", "torque"):
            old, new = getattr(self, key), getattr(target, key)
            values[key] = old + share * (new - old)
        for key, clearance in (("cam", CAM_START * module), ("teeth", TEETH_START * module)):
            old, new = getattr(self, key), getattr(target, key)
            values[key] = None if new is None else (1.0 - share) * (clearance if old is None else old) + share * new
        if self.pins is not None:
            back = PINS_BACK * travel if target.pins is None else target.pins
            values["pins"] = self.pins + share * (back - self.pins)
        return replace(target, **values)

    def to_dict(self) -> dict[str, Any]:
        return asdict(self)


def start(design: DriveDesign) -> LoadState:
    """Undeformed drive; pins, or the shrunk cam, touch the inner surface."""
    travel = pin_travel(design.cam(), design.inner_radius)
    return (
        LoadState(step=0, name="start", pins=travel)
        if design.steps.pins
        else LoadState(step=0, name="start", cam=travel)
    )


def load_sequence(design: DriveDesign) -> Iterator[LoadState]:
    """All increments of a run, in order."""
    d, steps, module = design.deflection, design.steps, design.drive.module
    torque = -np.copysign(1000.0 * design.load.torque, design.ratio)
    origin = start(design)
    n = steps.deflect_increments
    for i in range(1, n + 1):
        if steps.pins:
            yield LoadState(1, "deflect", pins=origin.pins * (1.0 - i / n))
        else:
            yield LoadState(1, "deflect", cam=origin.cam * (1.0 - i / n))
    n = steps.engage_increments
    for i in range(1, n + 1):
        t = i / n
        yield LoadState(
            2,
            "engage",
            cam=CAM_START * module * (1.0 - t) if steps.pins else 0.0,
            teeth=TEETH_START * module * (1.0 - t),
            pins=PINS_BACK * d * t if steps.pins and i < n else None,
        )
    loaded = LoadState(3, "load", cam=0.0, teeth=0.0, control="torque" if torque else "rotation")
    if torque:
        n = steps.load_increments
        for i in range(1, n + 1):
            yield replace(loaded, torque=torque * i / n)
    else:
        yield loaded
    for i, angle in enumerate(angles(design), start=1):
        yield replace(loaded, step=3 + i, name="rotate", angle=angle, torque=torque, rotation=angle / design.ratio)


def angles(design: DriveDesign) -> list[float]:
    """Angles (rad) of the wave generator at the ends of the increments of its rotation that are computed.

    With `steps.samples` those of one period, whose last angle is left out, as the drive is there in its loaded state
    again; with friction those of two periods, in the first of which it settles.
    """
    steps = design.steps
    if steps.samples:
        count = 2 * steps.samples if design.contact.friction else steps.samples - 1
        return [design.period_angle * i / steps.samples for i in range(1, count + 1)]
    count = int(np.ceil(round(steps.rotation / steps.increment, 9)))
    return [float(np.radians(min(i * steps.increment, steps.rotation))) for i in range(1, count + 1)]
