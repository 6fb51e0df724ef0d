"""Loads of the balls of a drive's bearing: rows of balls.csv, and what the summary says of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.bearing_life import BearingSeries, million_turns
from swgpar.load.load_states import LoadState
from swgpar.model.drive_model import DriveModel
from swgpar.results.history import Row

MICROMETRES = 1000.0


@dataclass(frozen=True)
class ComplianceShares:
    """Shares of the bearing in a compliance of the loaded drive.

    balls : of their contacts;  race : of the outer race's bending and stretching
    """

    balls: float
    race: float


def ball_rows(model: DriveModel, state: LoadState, increment: int, step: int) -> list[Row]:
    """Rows of balls.csv of the present state, a ball each, on all ranks; collective."""
    contact, design = model.problem.balls, model.design
    contact.evaluate(model.problem.displacement(), state, None, None)
    found = dict(pair for part in model.comm.allgather(list(zip(*contact.owned_loads()))) for pair in part)
    balls, part = contact.balls, contact.balls.number // model.copies
    found |= {(ball + k * part) % balls.number: found[ball] for ball in list(found) for k in range(1, model.copies)}
    rows = []
    for ball, angle in enumerate(balls.angles(state.angle)):
        approach = float(found[ball])
        force = float(balls.spring.force(np.array(approach)))
        rows.append(
            {
                "increment": increment,
                "step": step,
                "wg_angle_deg": float(np.degrees(state.angle)),
                "ball": ball,
                "angle_deg": design.in_frame_of_result(float(np.degrees(angle)), float(np.degrees(state.angle)))
                % 360.0,
                "cam_angle_deg": float(np.degrees(angle - state.angle) + 180.0) % 360.0 - 180.0,
                "load_N": force,
                "approach_um": MICROMETRES * approach,
                "inner_pressure_MPa": float(balls.spring.inner.pressure(force)),
                "outer_pressure_MPa": float(balls.spring.outer.pressure(force)),
            }
        )
    return rows


def summarise_bearing(
    design: DriveDesign,
    rows: Sequence[Row],
    increments: Sequence[int],
    shares: Mapping[str, ComplianceShares],
    race_stress: Mapping[str, float],
) -> dict[str, Any]:
    """Entry `bearing` of the summary.

    rows : of balls.csv;  increments : under load, as in their column `increment`
    shares : in the torsional and the radial compliance of the loaded state, where they were computed
    race_stress : largest stresses of the outer race under load, MPa, by name
    """
    loaded = [row for row in rows if row["increment"] in set(increments)]
    loads = np.array([row["load_N"] for row in loaded]).reshape(-1, design.bearing.balls)
    largest = max(loaded, key=lambda row: row["load_N"])
    peaks = loads.max(axis=1)
    passing = design.ball_passing_angle
    span = np.radians(np.ptp([row["wg_angle_deg"] for row in loaded]))
    return {
        "largest_load_N": largest["load_N"],
        "largest_pressure_MPa": max(largest["inner_pressure_MPa"], largest["outer_pressure_MPa"]),
        "largest_approach_um": largest["approach_um"],
        "wg_angle_deg": largest["wg_angle_deg"],
        "cam_angle_deg": largest["cam_angle_deg"],
        "mean_load_N": float(loads.mean()),
        "unloaded_balls": int((loads <= 0.0).sum(axis=1).max()),
        "cage_speed": design.cage_speed,
        "balls_fixed_to_cam": bool(np.isinf(passing)),
        "ball_passing_deg": None if np.isinf(passing) else float(np.degrees(passing)),
        "covers_ball_passing": bool(span >= passing * (1.0 - 1e-6)),
        "load_ripple": float(np.ptp(peaks) / peaks.mean()) if peaks.any() else None,
        "torsional_share": _share(shares.get("torsional")),
        "radial_share": _share(shares.get("radial")),
        **{f"{name}_MPa": value for name, value in race_stress.items()},
        "life": bearing_life(design, loads),
    }


def _share(share: ComplianceShares | None) -> dict[str, float] | None:
    if share is None:
        return None
    return {"balls": share.balls, "race": share.race, "bearing": share.balls + share.race}


def bearing_life(design: DriveDesign, loads: np.ndarray) -> dict[str, Any]:
    """Rating life from the loads (n, n_balls) N of all balls; the wave generator's speed is that of the design."""
    bearing = design.bearing
    series = BearingSeries(
        bearing.balls,
        bearing.ball_diameter,
        design.bearing_sizes.pitch_diameter,
        bearing.inner_conformity,
        bearing.outer_conformity,
    )
    rating = bearing.load_rating or series.load_rating()
    million = million_turns(series, rating, loads)
    # the races turn relative to each other a little faster or slower than the wave generator
    outer = 0.0 if design.output_gear == "ring_gear" else 1.0 / design.ratio
    turns = 1e6 * million / abs(1.0 - outer)
    finite = np.isfinite(turns)
    return {
        "load_rating_N": rating,
        "load_rating_given": bearing.load_rating is not None,
        "equivalent_load_N": rating / million ** (1.0 / 3.0) if finite else 0.0,
        "L10_turns": turns if finite else None,
        "L10_hours": turns / (60.0 * design.load.input_speed) if finite else None,
    }
