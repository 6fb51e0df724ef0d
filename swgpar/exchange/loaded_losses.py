"""Losses over load, speed and direction, from a run under load and one without."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from swgpar.design.bearing_drag import BearingDrag
from swgpar.design.losses_section import Losses
from swgpar.errors import InputError
from swgpar.evaluation.losses import bearing_drag

if TYPE_CHECKING:
    from swgpar.drive_results.drive_data import DriveData

LOADS = np.linspace(0.0, 1.5, 7)
"""Torques of the table over that of the run under load."""

SPEEDS = (0.0, 0.25, 0.5, 1.0, 1.5)
"""Speeds of the table over `load.input_speed`; 0 is the breakaway."""

NO_DRAG = BearingDrag(factor=1.0, viscosity=0.0, diameter=0.0)


@dataclass(frozen=True)
class LoadLine:
    """A part of the loss torque at the input over the torque on the output.

    idle : N·m, without a torque;  by_load : N·m at the input by N·m on the output
    """

    idle: float
    by_load: float

    def at(self, torque: float) -> float:
        """N·m at the input. torque : N·m on the output, without its sign"""
        return self.idle + self.by_load * torque


@dataclass(frozen=True)
class LoadedLosses:
    """Loss torque at the input: friction and hysteresis over the load, lubricant, and seals.

    friction : of flanks and bearing of a fast drive;  hysteresis : of the flexible spline
    section : [losses], with the friction at low speeds, seals and grease
    ratio : input over output
    bearing : drag of the lubricant in the bearing of the wave generator
    torque : N·m on the output under which the lines were found;  speed : rad/s of the input
    """

    friction: LoadLine
    hysteresis: LoadLine
    section: Losses
    ratio: float = 1.0
    torque: float = 0.0
    speed: float = 0.0
    bearing: BearingDrag = NO_DRAG

    @classmethod
    def of(cls, loaded: DriveData | None, idle: DriveData | None) -> LoadedLosses:
        """From a run with [losses] and one of the same drive without a torque; None for none.

        Without `idle` the loss torque of `loaded` holds under any load. Raises InputError where
        `idle` has a torque or no losses, or a drive with another ratio.
        """
        if loaded is None or loaded.summary.losses is None:
            if idle is not None:
                raise InputError("--idle is of no use without a run with [losses] under load")
            return cls(LoadLine(0.0, 0.0), LoadLine(0.0, 0.0), Losses())
        if idle is not None:
            _check(loaded, idle)
        design = loaded.summary.design
        return cls(
            _line(_friction, loaded, idle),
            _line(_hysteresis, loaded, idle),
            design.losses,
            ratio=loaded.summary.ratio,
            torque=design.load.torque,
            speed=design.load.input_rate,
            bearing=bearing_drag(design),
        )

    def at_input(self, torque: float, speed: float) -> float:
        """Loss torque (N·m) at the input.

        torque : N·m on the output, without its sign;  speed : rad/s of the input, without its sign
        """
        dry = self.friction.at(torque) * self.section.dry_friction(speed)
        seals = self.section.drag_at_input(speed, self.ratio)
        return dry + self.hysteresis.at(torque) + self.lubricant(speed) + seals

    def lubricant(self, speed: float) -> float:
        """Drag (N·m) of the lubricant in the bearing. speed : rad/s of the input"""
        return self.bearing.torque(speed) / 1000.0

    def backdriving_torque(self) -> float:
        """Torque (N·m) on the output from which it turns the input; infinite where none does."""
        ratio = abs(self.ratio)
        by_load = self.friction.by_load * self.section.dry_friction(0.0) + self.hysteresis.by_load
        left = 1.0 / ratio - by_load
        return self.at_input(0.0, 0.0) / left if left > 0.0 else np.inf

    def table(self) -> dict[str, np.ndarray]:
        """Columns of losses.csv: both directions at torques and speeds.

        Driving, the input's torque moves the output against its torque; backdriving, the output's
        torque moves the input. A torque that is too small to backdrive has the efficiency 0.
        """
        torques = LOADS * self.torque if self.torque else np.zeros(1)
        rows = []
        for torque in torques:
            for speed in self.speed * np.array(SPEEDS):
                loss, useful = self.at_input(torque, speed), torque / abs(self.ratio)
                driving = useful / (useful + loss) if useful else 0.0
                backdriving = max(0.0, 1.0 - loss / useful) if useful else 0.0
                rows.append(
                    (torque, speed, loss, useful + loss, driving, useful - loss, backdriving)
                )
        names = (
            "output_torque_Nm",
            "input_speed_rad_s",
            "loss_torque_Nm",
            "driving_input_torque_Nm",
            "driving_efficiency",
            "backdriving_input_torque_Nm",
            "backdriving_efficiency",
        )
        return dict(zip(names, np.array(rows).T, strict=True))


def _friction(result: DriveData) -> float:
    """Torque (N·m) of the friction of flanks and bearing in a run, at high speeds."""
    parts, design = result.summary.losses.parts_Nmm, result.summary.design
    dry = design.losses.dry_friction(design.load.input_rate)
    return (parts.flank_friction + parts.bearing) / dry / 1000.0


def _hysteresis(result: DriveData) -> float:
    """Torque (N·m) of the hysteresis of the flexible spline in a run."""
    return result.summary.losses.parts_Nmm.hysteresis / 1000.0


def _line(
    part: Callable[[DriveData], float], loaded: DriveData, idle: DriveData | None
) -> LoadLine:
    """A part of the loss torque over the load; without `idle` it is the same under any load."""
    under_load = part(loaded)
    if idle is None:
        return LoadLine(under_load, 0.0)
    without = part(idle)
    return LoadLine(without, (under_load - without) / loaded.summary.design.load.torque)


def _check(loaded: DriveData, idle: DriveData) -> None:
    """Refuse a run without a load that does not belong to the run under load."""
    ratio, other = loaded.summary.ratio, idle.summary
    if other.losses is None or other.design.load.torque != 0.0:
        raise InputError("--idle needs a run with [losses] and load.torque = 0")
    if not np.isclose(other.ratio, ratio, rtol=1e-12):
        raise InputError(
            f"--idle has the ratio {other.ratio:.9g}: allowed a run of the same drive, {ratio:.9g}"
        )
    if loaded.summary.design.load.torque <= 0.0:
        raise InputError("--idle needs a run under load beside it: load.torque above 0")
