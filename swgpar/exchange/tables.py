"""Histories and tables of a result as Parquet, and the drive as a look-up table for multibody
programs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from swgpar.drive_results.drive_tables import DriveTables
from swgpar.errors import InputError
from swgpar.evaluation.stiffness import Loop, rows_by_position
from swgpar.exchange.loaded_losses import LoadedLosses
from swgpar.load.load_sequence import stiffness_program
from swgpar.log import logger
from swgpar.results.table import as_rows, format_columns

if TYPE_CHECKING:
    from swgpar.drive_results.drive_data import DriveData

TABLES = ("history", *(one.name for one in fields(DriveTables) if one.name != "fatigue"))
"""Attributes of a `DriveData` that are tables."""

ARCSEC = np.pi / 648000.0

SPRING, RIPPLE, LOSSES = "spring.csv", "ripple.csv", "losses.csv"


def write_parquet(result: DriveData, folder: Path) -> list[Path]:
    """Write every table of a result as NAME.parquet; raises InputError without the package
    pyarrow."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise InputError(
            "the format parquet needs the package pyarrow: pip install 'swgpar[exchange]'"
        ) from None
    paths = []
    for name in TABLES:
        columns = getattr(result, name)
        if columns:
            paths.append(folder / f"{name}.parquet")
            pyarrow.parquet.write_table(pyarrow.table(dict(columns)), paths[-1])
    return paths


def write_look_up(result: DriveData, folder: Path, idle: DriveData | None = None) -> list[Path]:
    """Write the drive as a torsional spring with ripple and losses: what a multibody program
    interpolates in.

    `spring.csv` has the torque (N·m) on the output and its wind-up (rad), from the stiffness loops:
    of the rising and of the falling branch, whose distance is friction, and their mean; means over
    all positions. `ripple.csv` has the kinematic error (rad) of the output over the angle of the
    wave generator (rad); the table covers whole periods. `losses.csv` has the loss torque of a run
    with [losses] over load, speed and direction (`LoadedLosses.table`).

    idle : run of the same drive with [losses] and without a torque

    Raises InputError where the run has neither a stiffness loop nor a transmission error.
    """
    tables = {}
    if result.program and result.summary.stiffness:
        tables[folder / SPRING] = spring_table(result)
    if result.transmission_error:
        tables[folder / RIPPLE] = ripple_table(result.transmission_error)
    if result.summary.losses:
        losses = LoadedLosses.of(result, idle)
        tables[folder / LOSSES] = losses.table()
        torque = losses.backdriving_torque()
        if np.isfinite(torque):
            logger.info("the output turns the input from %.4g N·m on", torque)
        else:
            logger.info("no torque on the output turns the input")
    for path, columns in tables.items():
        path.write_bytes(format_columns(columns))
    if not tables:
        raise InputError(
            "the format lookup needs a run with [stiffness], steps.samples or [deviations]: this "
            "one has neither a stiffness loop nor a transmission error"
        )
    return list(tables)


def spring_table(result: DriveData) -> dict[str, np.ndarray]:
    """Columns of spring.csv of a run with [stiffness]: wind-up at the torques of its loops, mean
    over the positions."""
    program = stiffness_program(result.summary.design)
    rows = as_rows(result.program)
    loops = [Loop(here) for here in rows_by_position(program, rows).values()]
    torques = np.array(program.torques)
    levels = np.concatenate([-torques[::-1], torques])
    rising = np.mean([[loop.rising(torque) for torque in levels] for loop in loops], axis=0)
    falling = np.mean([[loop.falling(torque) for torque in levels] for loop in loops], axis=0)
    return {
        "torque_Nm": levels,
        "windup_rad": 0.5 * (rising + falling),
        "windup_rising_rad": rising,
        "windup_falling_rad": falling,
    }


def ripple_table(transmission_error: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Columns of ripple.csv from those of transmission_error.csv: the error less its mean."""
    error = transmission_error["transmission_error_arcsec"]
    return {
        "wave_generator_angle_rad": np.radians(transmission_error["wg_angle_deg"]),
        "kinematic_error_rad": (error - error.mean()) * ARCSEC,
    }
