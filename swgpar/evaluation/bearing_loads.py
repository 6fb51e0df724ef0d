"""Loads of the balls of a drive's bearing: rows of balls.csv, and what follows from them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from swgpar.answers.answer import (
    Answer,
    AnswerGroup,
    AnswerKind,
    answer,
    evaluation,
    part_answers,
    with_error,
)
from swgpar.design.drive_design import DriveDesign
from swgpar.evaluation.bearing_life import BearingSeries, million_turns
from swgpar.evaluation.contact_error_shares import error_of_largest
from swgpar.load.load_states import LoadState
from swgpar.model.drive_model import DriveModel
from swgpar.results.history import Row

MICROMETRES = 1000.0

NO_SHARES: Mapping[str, float] = MappingProxyType({})
"""Errors that are not known."""

BALL_LOAD = AnswerKind("bearing.largest_load", "largest ball load under load", "N", place="place")
BALL_PRESSURE = AnswerKind(
    "bearing.pressure", "largest pressure of a ball on a race", "MPa", place="place"
)
APPROACH = AnswerKind(
    "bearing.approach", "largest approach of the races at a ball", "µm", place="place"
)
LIFE_HOURS = AnswerKind("bearing.life_hours", "rating life L10 of the bearing", "h")
RACE_MISES = AnswerKind(
    "bearing.race_vm", "largest von Mises stress in the outer race under load", "MPa"
)

LARGEST = {
    BALL_LOAD.name: lambda rows: max((row["load_N"] for row in rows), default=0.0),
    BALL_PRESSURE.name: lambda rows: max((_pressure(row) for row in rows), default=0.0),
    APPROACH.name: lambda rows: max((row["approach_um"] for row in rows), default=0.0),
}
"""What of rows of balls.csv the answers are that the increments may miss."""


@dataclass(frozen=True)
class ComplianceShares:
    """Shares of the bearing in a compliance of the loaded drive.

    balls : of their contacts;  race : of the outer race's bending and stretching
    """

    balls: float
    race: float

    @property
    def bearing(self) -> float:
        """Share of balls and race."""
        return self.balls + self.race


def _shares(kind: str) -> Iterator[AnswerKind]:
    """Answers in a field with shares in the torsional or the radial compliance."""
    for part, ending in (("bearing", ""), ("balls", "_of_balls")):
        name, text = (
            f"bearing.{kind}_share{ending}",
            f"share of the {part} in the {kind} compliance",
        )
        yield AnswerKind(name, text, path=f"{kind}_share.{part}")


TORSIONAL_SHARE, TORSIONAL_SHARE_OF_BALLS = _shares("torsional")
RADIAL_SHARE, RADIAL_SHARE_OF_BALLS = _shares("radial")


@evaluation
class BearingLife:
    """Rating life of a bearing.

    load_rating_given : whether the load rating is that of the design file
    L10_turns, L10_hours : at `load.input_speed`, None without load
    """

    load_rating_N: float = answer(
        "bearing.load_rating", "basic dynamic load rating", "N", exact=True
    )
    load_rating_given: bool
    equivalent_load_N: float = answer(
        "bearing.equivalent_load", "load that gives the same life", "N"
    )
    L10_turns: float | None = answer(
        "bearing.life_turns", "rating life L10 of the bearing, turns of the wave generator"
    )
    L10_hours: float | None = part_answers(LIFE_HOURS)


@evaluation
class BallLoads(AnswerGroup):
    """Loads of the balls over the increments under load.

    wg_angle_deg, cam_angle_deg : angles of the wave generator and from the major axis, where the
    load of a ball is the largest
    cage_speed : of the cage over that of the wave generator
    balls_fixed_to_cam : whether the balls turn with the cam
    ball_passing_deg : rotation after which the next ball is at the same place of the cam, None if
    fixed to it
    ball_places : of the balls between two neighbours that `steps.samples` shows, 0 without
    covers_ball_passing : whether the run covers a passing
    errors : by names of answers
    load_ripple : None without load;  torsional_share, radial_share : None without a torque
    """

    largest_load_N: float = part_answers(BALL_LOAD)
    largest_pressure_MPa: float = part_answers(BALL_PRESSURE)
    largest_approach_um: float = part_answers(APPROACH)
    wg_angle_deg: float
    cam_angle_deg: float
    mean_load_N: float = answer("bearing.mean_load", "mean ball load under load", "N")
    unloaded_balls: int = answer(
        "bearing.unloaded_balls", "largest number of balls without load", detail=True, exact=True
    )
    cage_speed: float
    balls_fixed_to_cam: bool
    ball_passing_deg: float | None
    ball_places: int = 0
    covers_ball_passing: bool
    load_ripple: float | None = answer(
        "bearing.load_ripple", "range of the largest ball load over its mean"
    )
    torsional_share: ComplianceShares | None = part_answers(
        TORSIONAL_SHARE, TORSIONAL_SHARE_OF_BALLS
    )
    radial_share: ComplianceShares | None = part_answers(RADIAL_SHARE, RADIAL_SHARE_OF_BALLS)
    race_s1_MPa: float | None = answer(
        "bearing.race_s1", "largest tension in the outer race under load", "MPa", default=None
    )
    race_s3_MPa: float | None = answer(
        "bearing.race_s3", "largest compression in the outer race under load", "MPa", default=None
    )
    race_vm_MPa: float | None = part_answers(RACE_MISES, default=None)
    life: BearingLife
    errors: Mapping[str, float] = field(default_factory=dict)

    TITLE = "ball loads and life of the bearing"
    ASKED_BY = "[wave_generator.bearing]"
    SECTION = "bearing"

    @property
    def place(self) -> str:
        """Where the load of a ball is the largest."""
        return f"{self.cam_angle_deg:.0f} degrees from the major axis"

    def answers(self) -> Iterator[Answer]:
        for one in super().answers():
            error = self.errors.get(one.name)
            yield one if error is None else with_error(one, error)

    def remarks(self) -> Iterator[str]:
        if self.balls_fixed_to_cam:
            yield "the balls turn with the cam and do not pass"
        elif self.ball_places:
            yield (
                f"a ball passes every {self.ball_passing_deg:.3g} degrees: the angles of the "
                f"period have {self.ball_places} places of the balls"
            )
        elif not self.covers_ball_passing:
            yield (
                f"a ball passes every {self.ball_passing_deg:.3g} degrees: the run covers less "
                f"than that"
            )


def ball_rows(model: DriveModel, state: LoadState, increment: int, step: int) -> list[Row]:
    """Rows of balls.csv of the present state, a ball each, on all ranks; collective."""
    contact, design = model.problem.wave_generator.balls, model.design
    contact.evaluate(model.problem.displacement(), state, None, None)
    found = dict(
        pair for part in model.comm.allgather(list(zip(*contact.owned_loads()))) for pair in part
    )
    balls, part = contact.balls, contact.balls.number // model.copies
    found |= {
        (ball + k * part) % balls.number: found[ball]
        for ball in list(found)
        for k in range(1, model.copies)
    }
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
                "angle_deg": design.kinematics.in_frame_of_result(
                    float(np.degrees(angle)), float(np.degrees(state.angle))
                )
                % 360.0,
                "cam_angle_deg": float(np.degrees(angle - state.angle) + 180.0) % 360.0 - 180.0,
                "load_N": force,
                "approach_um": MICROMETRES * approach,
                "inner_pressure_MPa": float(balls.spring.inner.pressure(force)),
                "outer_pressure_MPa": float(balls.spring.outer.pressure(force)),
            }
        )
    return rows


def ball_passing_angle(cage_speed: float, balls: int) -> float:
    """Rotation (rad) of the wave generator after which a ball takes the place of the one before it
    on the cam; inf where the balls are fixed to the cam."""
    slip = abs(1.0 - cage_speed)
    return 2.0 * np.pi / balls / slip if slip > 1e-9 else np.inf


def evaluate_bearing(
    design: DriveDesign,
    rows: Sequence[Row],
    increments: Sequence[int],
    shares: Mapping[str, ComplianceShares],
    race_stress: Mapping[str, float],
    error_shares: Mapping[str, float] = NO_SHARES,
) -> BallLoads:
    """The loads over the increments under load.

    rows : of balls.csv;  increments : under load, as in their column `increment`
    shares : in the torsional and the radial compliance of the loaded state, where they were
    computed
    race_stress : largest stresses of the outer race under load, MPa, by name
    error_shares : errors by the mesh as shares of the values, by names of answers
    """
    loaded = [row for row in rows if row["increment"] in set(increments)]
    loads = np.array([row["load_N"] for row in loaded]).reshape(-1, design.bearing.balls)
    largest = max(loaded, key=lambda row: row["load_N"])
    peaks = loads.max(axis=1)
    passing = ball_passing_angle(design.rolling_speed, design.bearing.balls)
    samples = design.steps.samples
    places = samples if design.kinematics.ball_passings(samples) else 0
    span = np.radians(np.ptp([row["wg_angle_deg"] for row in loaded]))
    found = BallLoads(
        largest_load_N=largest["load_N"],
        largest_pressure_MPa=_pressure(largest),
        largest_approach_um=largest["approach_um"],
        wg_angle_deg=largest["wg_angle_deg"],
        cam_angle_deg=largest["cam_angle_deg"],
        mean_load_N=float(loads.mean()),
        unloaded_balls=int((loads <= 0.0).sum(axis=1).max()),
        cage_speed=design.rolling_speed,
        balls_fixed_to_cam=bool(np.isinf(passing)),
        ball_passing_deg=None if np.isinf(passing) else float(np.degrees(passing)),
        ball_places=places,
        covers_ball_passing=places > 1 or bool(span >= passing * (1.0 - 1e-6)),
        load_ripple=float(np.ptp(peaks) / peaks.mean()) if peaks.any() else None,
        torsional_share=shares.get("torsional"),
        radial_share=shares.get("radial"),
        life=bearing_life(design, loads),
        race_s1_MPa=race_stress.get("race_s1"),
        race_s3_MPa=race_stress.get("race_s3"),
        race_vm_MPa=race_stress.get("race_vm"),
    )
    errors = {
        one.name: error_shares[one.name] * abs(one.value)
        for one in found.answers()
        if one.name in error_shares and one.value is not None
    }
    for name, largest_of in LARGEST.items():
        if name in errors:
            errors[name] = error_of_largest(loaded, largest_of, error_shares[name])
    return replace(found, errors=errors)


def _pressure(row: Row) -> float:
    """Larger pressure (MPa) of a ball on both races."""
    return float(max(row["inner_pressure_MPa"], row["outer_pressure_MPa"]))


def bearing_life(design: DriveDesign, loads: np.ndarray) -> BearingLife:
    """Rating life from the loads (n, n_balls) N of all balls; the wave generator's speed is that of
    the design."""
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
    turns = 1e6 * million / abs(1.0 - design.kinematics.spline_speed)
    finite = np.isfinite(turns)
    return BearingLife(
        load_rating_N=rating,
        load_rating_given=bearing.load_rating is not None,
        equivalent_load_N=rating / million ** (1.0 / 3.0) if finite else 0.0,
        L10_turns=turns if finite else None,
        L10_hours=turns / (60.0 * design.load.input_speed) if finite else None,
    )
