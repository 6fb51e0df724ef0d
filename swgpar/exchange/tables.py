"""Histories and tables of a result as Parquet, and the drive as a look-up table for multibody programs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from swgpar.errors import InputError
from swgpar.results.table import format_columns

if TYPE_CHECKING:
    from swgpar.analysis.drive_result import DriveResult

TABLES = (
    "history",
    "pairs",
    "contact_lines",
    "program",
    "transmission_error",
    "losses",
    "fatigue_cycle",
    "balls",
)
"""Attributes of a `DriveResult` that are tables."""

ARCMIN = np.pi / 10800.0
ARCSEC = ARCMIN / 60.0

SPRING, RIPPLE = "spring.csv", "ripple.csv"


def write_parquet(result: DriveResult, folder: Path) -> list[Path]:
    """Write every table of a result as NAME.parquet; raises InputError without the package pyarrow."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise InputError("the format parquet needs the package pyarrow: pip install 'swgpar[exchange]'") from None
    paths = []
    for name in TABLES:
        columns = getattr(result, name)
        if columns:
            paths.append(folder / f"{name}.parquet")
            pyarrow.parquet.write_table(pyarrow.table(dict(columns)), paths[-1])
    return paths


def write_look_up(result: DriveResult, folder: Path) -> list[Path]:
    """Write the drive as a torsional spring with ripple: what a multibody program interpolates in.

    `spring.csv` has the torque (N·m) on the output and its wind-up (rad), from the stiffness loops: of the rising and
    of the falling branch, whose distance is friction, and their mean; means over all positions. `ripple.csv` has the
    kinematic error (rad) of the output over the angle of the wave generator (rad); the table covers whole periods.

    Raises
    ------
    InputError
        The run has neither a stiffness loop nor a transmission error.
    """
    paths = []
    if result.program and result.stiffness:
        paths.append(folder / SPRING)
        paths[-1].write_bytes(format_columns(spring_table(result.program)))
    if result.transmission_error:
        rows = result.transmission_error
        error = (rows["transmission_error_arcsec"] - rows["transmission_error_arcsec"].mean()) * ARCSEC
        columns = {"wave_generator_angle_rad": np.radians(rows["wg_angle_deg"]), "kinematic_error_rad": error}
        paths.append(folder / RIPPLE)
        paths[-1].write_bytes(format_columns(columns))
    if not paths:
        raise InputError(
            "the format lookup needs a run with [stiffness], steps.samples or [deviations]: this one has neither a "
            "stiffness loop nor a transmission error"
        )
    return paths


def spring_table(program: dict[str, np.ndarray], count: int = 41) -> dict[str, np.ndarray]:
    """Wind-up at `count` torques between the ends of the loops: columns of spring.csv.

    program : columns of program.csv of a run with [stiffness]
    """
    angles, torque = program["wg_angle_deg"], program["torque_Nm"]
    levels = np.linspace(torque.min(), torque.max(), count)
    up, down = [], []
    for angle in np.unique(angles):
        here = angles == angle
        t, rotation = torque[here], program["rotation_arcmin"][here] * ARCMIN
        change = np.gradient(t)
        for branch, sign in ((up, 1.0), (down, -1.0)):
            chosen = sign * change > 0.0
            if np.count_nonzero(chosen) > 1:
                order = np.argsort(t[chosen])
                branch.append(np.interp(levels, t[chosen][order], rotation[chosen][order]))
    rising, falling = np.mean(up or down, axis=0), np.mean(down or up, axis=0)
    return {
        "torque_Nm": levels,
        "windup_rad": 0.5 * (rising + falling),
        "windup_rising_rad": rising,
        "windup_falling_rad": falling,
    }
