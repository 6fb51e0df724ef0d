"""The drive as a torsional spring with ripple and friction: numbers of docs/theory/spring_model.md
from results."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

from swgpar.errors import InputError
from swgpar.exchange.loaded_losses import LoadedLosses
from swgpar.exchange.tables import ripple_table, spring_table

if TYPE_CHECKING:
    from swgpar.drive_results.drive_data import DriveData

FEWEST = 4
"""Angles of a period from which the kinematic error is interpolated."""

SHARE = 0.01
"""Of a typical speed: where friction reaches three quarters of its torque."""


@dataclass(frozen=True)
class SpringModel:
    """Angles and torques about z, on the output of a drive in the sense of the history.

    Between knots the curves are cubic polynomials. A knot is a row: argument, value, derivative.

    ratio : speed of the wave generator over that of the output, with its sign
    spring : (n, 3) wind-up rad, torque N·m on the output that holds it, N·m/rad; beyond the ends
    straight
    ripple : (m, 3) angle of the wave generator rad over one period, kinematic error rad, its
    derivative
    friction_torque : N·m against the speed of the wind-up
    friction_speed : rad/s of the wind-up, SHARE of the range of `spring` in a second
    loss_torque, load_loss : N·m against the speed of the wave generator: without a torque on the
    output, and by N·m of it
    loss_speed : rad/s of the wave generator, SHARE of load.input_speed
    viscous_loss : N·m s/rad against that speed
    output_drag, output_viscous_drag : N·m and N·m s/rad against the speed of the output
    """

    ratio: float
    spring: np.ndarray
    ripple: np.ndarray
    friction_torque: float
    friction_speed: float
    loss_torque: float
    load_loss: float
    loss_speed: float
    viscous_loss: float
    output_drag: float
    output_viscous_drag: float

    @property
    def period(self) -> float:
        """Period (rad) of the kinematic error."""
        return float(self.ripple[-1, 0] - self.ripple[0, 0])


def spring_model(
    result: DriveData, periodic: DriveData | None, idle: DriveData | None = None
) -> SpringModel:
    """The model from a run with [stiffness] and from one of the same drive over a period.

    periodic : with steps.samples or [deviations], for the kinematic error; with [losses] also for
        the loss torque; None for neither
    idle : with [losses] and without a torque; None: the loss torque is that of `periodic` under
        any load

    Raises InputError where a result has not what is needed, or both are of drives with different
    ratios.
    """
    summary = result.summary
    if not (result.program and summary.stiffness):
        raise InputError(
            "the format fmu needs a run with [stiffness]: the kinematic error comes from a second "
            "run, --ripple FOLDER"
        )
    # the columns of both runs count the rotation of the wave generator
    if summary.design.kinematics.wave_generator_is_fixed:
        raise InputError(
            f'drive.layout = "{summary.design.drive.layout}" is not available with the format fmu: '
            'allowed "ring_fixed" or "spline_fixed"'
        )
    ratio = summary.ratio
    table = spring_table(result)
    # a positive torque of the table acts against the motion of the output
    direction = -np.sign(ratio)
    torque, windup = direction * table["torque_Nm"], direction * table["windup_rad"]
    order = np.argsort(torque)
    torque, windup = torque[order], windup[order]
    for k in np.flatnonzero(np.diff(windup) <= 0.0)[:1]:
        raise InputError(
            f"the wind-up does not grow between {torque[k]:.6g} and {torque[k + 1]:.6g} N·m: the "
            "format fmu needs a stiffness loop whose mean branch rises"
        )
    reach = float(np.ptp(windup))
    slopes = PchipInterpolator(windup, torque).derivative()(windup)
    ripple = np.array([[0.0, 0.0, 0.0], [2.0 * np.pi, 0.0, 0.0]])
    if periodic is not None:
        if not np.isclose(periodic.summary.ratio, ratio, rtol=1e-12):
            raise InputError(
                f"--ripple has the ratio {periodic.summary.ratio:.9g}: allowed a run of the same "
                f"drive, {ratio:.9g}"
            )
        ripple = _ripple_knots(periodic)
    losses = LoadedLosses.of(periodic, idle)
    return SpringModel(
        ratio=ratio,
        spring=np.column_stack([windup, torque, slopes]),
        ripple=ripple,
        friction_torque=max(0.0, summary.stiffness.loop_work) / (2000.0 * reach),
        friction_speed=SHARE * reach,
        loss_torque=losses.friction.idle
        + losses.hysteresis.idle
        + losses.section.input_drag
        + losses.lubricant(losses.speed),
        load_loss=losses.friction.by_load + losses.hysteresis.by_load,
        viscous_loss=losses.section.input_viscous_drag,
        output_drag=losses.section.output_drag,
        output_viscous_drag=losses.section.output_viscous_drag,
        loss_speed=SHARE * summary.design.load.input_rate,
    )


def _ripple_knots(result: DriveData) -> np.ndarray:
    """Knots (n + 1, 3) of the periodic cubic spline through a kinematic error at n even angles."""
    if not result.transmission_error:
        raise InputError(
            "--ripple needs a run with steps.samples or [deviations]: this one has no "
            "transmission error"
        )
    table = ripple_table(result.transmission_error)
    angle, error = table["wave_generator_angle_rad"], table["kinematic_error_rad"]
    if len(angle) < FEWEST:
        raise InputError(
            f"--ripple has the kinematic error at {len(angle)} angles: allowed {FEWEST} and more"
        )
    angle = np.append(angle, angle[-1] + (angle[-1] - angle[0]) / (len(angle) - 1))
    error = np.append(error, error[0])
    curve = CubicSpline(angle, error, bc_type="periodic")
    return np.column_stack([angle, error, curve(angle, 1)])
