"""The rows of a rating sheet: which answer of which run is judged by which limit."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

from swgpar.analysis.accuracy import not_refinable
from swgpar.answers.answer import Answer, AnswerKind
from swgpar.answers.verdict import Limit, Sense, Verdict
from swgpar.checks.clearance import clearances
from swgpar.design.drive_design import DriveDesign
from swgpar.design.rating_section import RatingSection
from swgpar.drive_results.report_checks import RESOLUTION
from swgpar.drive_results.strength_checks import FIRST_YIELD
from swgpar.drive_results.summary import DriveSummary
from swgpar.evaluation import bearing_loads
from swgpar.evaluation.bolt_loads import GAPING, SLIDING
from swgpar.evaluation.frequencies import LOWEST
from swgpar.evaluation.largest_contact import FLANK_PRESSURE
from swgpar.evaluation.losses import EFFICIENCY, NO_LOAD_TORQUE, STARTING_TORQUE
from swgpar.evaluation.ratcheting import PEAK_TORQUE
from swgpar.evaluation.rigid_clearance import CLEARANCES
from swgpar.evaluation.stiffness import CHORDS, HYSTERESIS, LOST_MOTION
from swgpar.evaluation.transmission_error import PEAK_TO_PEAK
from swgpar.materials.pitting import PITTING_LIMITS, SOURCE
from swgpar.rating.planned_runs import (
    NO_BEARING,
    NO_LOSSES,
    NO_STRENGTHS,
    LoadCase,
    RatingLoads,
    rating_loads,
)
from swgpar.rating.rated_answers import (
    AT_TEETH,
    BEHIND_TEETH,
    IN_RING,
    RING_GEARS,
    largest_mises,
    least_fatigue_safety,
    resolution,
    spline_life,
    static_safety,
)

AnswerSource = Callable[[DriveSummary], Answer | None]
"""Takes the answer of a row from the summary of its run."""

IDEAL = "a lower bound, that of the ideal drive: [deviations] is not given"
NO_FRICTION = "a lower bound: contact.friction = 0, and backlash alone opens the loop"
ALWAYS_AT_PEAK = "a lower bound, of the repeated peak torque at all times"
NO_FLANK_PRESSURE = (
    "no limit of the material pair is known: rating.flank_pressure, or for steels "
    "rating.flank_treatment and flank_hardness"
)
NO_RING_STRENGTH = "the strength of the ring gear is not known: rating.ring_yield_strength"
NO_PRELOAD = "cup.bolt_preload and cup.joint_friction are not given"


@dataclass(frozen=True)
class RatingRow:
    """A row before its run.

    name : what is judged;  case : of the run;  answer : takes it from the summary
    limit : None without a requirement
    missing : why no run gives an answer, or why there is no limit; empty otherwise
    lower_bound : says of a summary why the answer is a lower bound; empty where it is none
    of_strength : whether it is about the strength of the drive
    of_computation : whether it is about the computation and not about the drive
    unit : of the answer
    """

    name: str
    case: LoadCase
    answer: AnswerSource
    limit: Limit | None = None
    missing: str = ""
    lower_bound: Callable[[DriveSummary], str] = lambda _: ""
    of_strength: bool = False
    of_computation: bool = False
    unit: str = ""

    def verdict(self, summary: DriveSummary | None, without: str) -> Verdict:
        """The verdict by the summary of the row's run. without : why there is no summary, or what
        its run has left out"""
        answer = None if summary is None else self.answer(summary)
        bound = "" if summary is None or answer is None else self.lower_bound(summary)
        lacking = self.missing if summary is not None else ""
        if answer is None:
            lacking = lacking or without or self.missing
        return Verdict(
            self.name,
            answer,
            self.limit,
            bound or (lacking if answer is None or self.limit is None else ""),
            is_lower_bound=bool(bound),
            of_strength=self.of_strength,
            of_computation=self.of_computation,
        )


def _row(
    name: str, case: LoadCase, kind: AnswerKind, limit: Limit | None, missing: str = "", **more: Any
) -> RatingRow:
    """The row of an answer that the run gives as it is."""
    return RatingRow(name, case, lambda run: run.find(kind), limit, missing, unit=kind.unit, **more)


def _required(value: float | None, sense: Sense, key: str, factor: float = 1.0) -> Limit | None:
    """The limit of a key of [rating]. factor : of the unit of the answer"""
    return None if value is None else Limit(factor * value, sense, f"rating.{key}")


def rating_rows(design: DriveDesign, accuracy: float | None = None) -> list[RatingRow]:
    """All rows of the sheet of a design with [rating], in their order.

    accuracy : relative, of the largest tension at the teeth; None is that of a report
    """
    loads, section = rating_loads(design), design.rating
    assert section is not None  # `rating_loads` has refused a design without it
    return [
        *_strength(design, section, loads),
        *_bearing(design, section),
        *_bolts(design),
        _ratcheting(loads),
        *_stiffness(design, section),
        *_motion(design, section),
        *_computation(design, accuracy or RESOLUTION),
    ]


def _strength(
    design: DriveDesign, section: RatingSection, loads: RatingLoads
) -> Iterator[RatingRow]:
    strengths = design.fatigue
    safety = section.yield_safety
    least = Limit(section.fatigue_safety, Sense.AT_LEAST, "rating.fatigue_safety")
    of_yield = None
    if strengths is not None:
        source = "fatigue.yield_strength over rating.yield_safety"
        of_yield = Limit(strengths.yield_strength / safety, Sense.AT_MOST, source)
    for part, regions in (("teeth and rim", AT_TEETH), ("wall", BEHIND_TEETH)):
        missing = part == "wall" and not design.has_cup
        wall = f'drive.model = "{design.drive.model}" has no wall' if missing else ""
        yield RatingRow(
            f"yield of {part}",
            LoadCase.LARGEST,
            partial(largest_mises, regions=regions),
            None if wall else of_yield,
            wall or ("" if of_yield else NO_STRENGTHS),
            of_strength=not wall,
            unit="MPa",
        )
        yield RatingRow(
            f"fatigue of {part}",
            LoadCase.REPEATED_PEAK,
            partial(least_fatigue_safety, regions=regions),
            None if wall or strengths is None else least,
            wall,
            of_strength=not wall,
        )
    yield _yield_of_ring(design, section)
    often = loads.repeated_peak > loads.average
    yield RatingRow(
        "life of the flexible spline",
        LoadCase.REPEATED_PEAK,
        spline_life,
        _required(section.life, Sense.AT_LEAST, "life"),
        lower_bound=lambda _: ALWAYS_AT_PEAK if often else "",
        unit="h",
    )
    most = _flank_pressure(section)
    yield _row(
        "pressure of the flanks",
        LoadCase.RATED,
        FLANK_PRESSURE,
        most,
        "" if most else NO_FLANK_PRESSURE,
        of_strength=most is not None,
    )
    first = None
    if strengths is not None:
        source = f"{FIRST_YIELD:g} times fatigue.yield_strength over rating.yield_safety [Johnson]"
        value = FIRST_YIELD * strengths.yield_strength / safety
        first = Limit(value, Sense.AT_MOST, source)
    yield _row(
        "yield below the flanks",
        LoadCase.LARGEST,
        FLANK_PRESSURE,
        first,
        "" if first else NO_STRENGTHS,
        of_strength=True,
    )


def _yield_of_ring(design: DriveDesign, section: RatingSection) -> RatingRow:
    """The row of the ring gears, whose strength is that of the flexible spline where all are of one
    material."""
    strength, source = section.ring_yield_strength, "rating.ring_yield_strength"
    spline = design.materials["flexible_spline"]
    alike = all(design.materials[gear] == spline for gear in design.geometry.gears)
    if strength is None and design.fatigue is not None and alike:
        strength, source = design.fatigue.yield_strength, "fatigue.yield_strength"
    limit = None
    if strength is not None:
        source += " over rating.yield_safety"
        limit = Limit(strength / section.yield_safety, Sense.AT_MOST, source)
    return RatingRow(
        "yield of the ring gear",
        LoadCase.LARGEST,
        partial(largest_mises, regions=IN_RING, gears=RING_GEARS),
        limit,
        "" if limit else NO_RING_STRENGTH,
        of_strength=True,
        unit="MPa",
    )


def _flank_pressure(section: RatingSection) -> Limit | None:
    """The pressure that the flanks bear; None where it is not known."""
    if section.flank_pressure is not None:
        source = section.flank_pressure_source or "rating.flank_pressure"
        return Limit(section.flank_pressure, Sense.AT_MOST, source)
    if section.flank_treatment is None or section.flank_hardness is None:
        return None
    limit = PITTING_LIMITS[section.flank_treatment]
    hardness = section.flank_hardness
    source = f"pitting of {limit.text} of {hardness:g} HV [{SOURCE}]"
    return Limit(limit.pressure(hardness), Sense.AT_MOST, source)


def _bearing(design: DriveDesign, section: RatingSection) -> Iterator[RatingRow]:
    if design.bearing is None:
        yield RatingRow("bearing", LoadCase.AVERAGE, lambda _: None, missing=NO_BEARING)
        return
    source = "rating.static_safety, against 4200 MPa of a ball on its race [ISO 76]"
    limit = Limit(section.static_safety, Sense.AT_LEAST, source)
    yield RatingRow(
        "static safety of the bearing", LoadCase.LARGEST, static_safety, limit, of_strength=True
    )
    life = _required(section.life, Sense.AT_LEAST, "life")
    yield _row("life of the bearing", LoadCase.AVERAGE, bearing_loads.LIFE_HOURS, life)


def _bolts(design: DriveDesign) -> Iterator[RatingRow]:
    if not design.is_bolted:
        return
    preloaded = design.cup.bolt_preload is not None
    limit = Limit(1.0, Sense.AT_LEAST, "VDI 2230") if preloaded else None
    lacks = "" if preloaded else NO_PRELOAD
    for name, kind in (("sliding", SLIDING), ("gaping", GAPING)):
        yield _row(f"{name} of bolts", LoadCase.LARGEST, kind, limit, lacks, of_strength=True)


def _without_peak(summary: DriveSummary) -> str:
    """Why the ratcheting torque is a lower bound; empty behind a peak."""
    found = summary.ratcheting
    if found is None or found.is_peak:
        return ""
    return f"a lower bound: the torque has no peak up to the end of the run ({found.ended})"


def _ratcheting(loads: RatingLoads) -> RatingRow:
    limit = None
    if loads.ratcheting is not None:
        source = "rating.momentary_torque times rating.ratcheting_safety"
        limit = Limit(loads.ratcheting, Sense.AT_LEAST, source)
    return _row(
        "ratcheting",
        LoadCase.RATCHETING,
        PEAK_TORQUE,
        limit,
        lower_bound=_without_peak,
        of_strength=limit is not None,
    )


def _stiffness(design: DriveDesign, section: RatingSection) -> Iterator[RatingRow]:
    for name, kind in CHORDS.items():
        limit = _required(getattr(section, name), Sense.AT_LEAST, name)
        yield _row(f"stiffness {name}", LoadCase.STIFFNESS, kind, limit)
    without_friction = design.contact.friction == 0.0
    yield _row(
        "hysteresis",
        LoadCase.STIFFNESS,
        HYSTERESIS,
        _required(section.hysteresis, Sense.AT_MOST, "hysteresis"),
        lower_bound=lambda _: NO_FRICTION if without_friction else "",
    )
    limit = _required(section.lost_motion, Sense.AT_MOST, "lost_motion")
    yield _row("lost motion", LoadCase.STIFFNESS, LOST_MOTION, limit)


def _motion(design: DriveDesign, section: RatingSection) -> Iterator[RatingRow]:
    ideal = design.deviations is None
    yield _row(
        "transmission error",
        LoadCase.RATED,
        PEAK_TO_PEAK,
        _required(section.transmission_error, Sense.AT_MOST, "transmission_error"),
        lower_bound=lambda _: IDEAL if ideal else "",
    )
    limit = _required(section.efficiency, Sense.AT_LEAST, "efficiency")
    losses = "" if design.losses else NO_LOSSES
    yield _row("efficiency", LoadCase.RATED, EFFICIENCY, limit, losses)
    limit = _required(section.no_load_torque, Sense.AT_MOST, "no_load_torque", 1000.0)
    yield _row("no-load torque", LoadCase.NO_LOAD, NO_LOAD_TORQUE, limit, losses)
    limit = _required(section.starting_torque, Sense.AT_MOST, "starting_torque", 1000.0)
    yield _row("starting torque", LoadCase.NO_LOAD, STARTING_TORQUE, limit, losses)
    speed, limit = section.largest_speed, None
    if speed is not None:
        lobes = design.wave_generator.lobes
        source = f"{lobes} lobes times rating.largest_speed"
        limit = Limit(lobes * speed / 60.0, Sense.AT_LEAST, source)
    yield _row("lowest natural frequency", LoadCase.MODES, LOWEST, limit)


def _computation(design: DriveDesign, accuracy: float) -> Iterator[RatingRow]:
    for clearance in clearances(design.rigid_pairs):
        limit = Limit(clearance.allowed, Sense.AT_LEAST, "an overlap that loaded teeth take up")
        where = "" if clearance.ring == "ring_gear" else f" in the {clearance.ring}"
        name = f"clearance of the rigid teeth{where.replace('_', ' ')}"
        yield _row(name, LoadCase.RATED, CLEARANCES[clearance.ring], limit)
    limit = Limit(accuracy, Sense.AT_MOST, "largest error of the stress at the teeth")
    option = "" if not_refinable(design) else f" or --accuracy {accuracy:g}"
    answer = (
        "the error of the largest tension at the teeth has no estimate on this mesh; the usual "
        f"mesh{option} gives one"
    )
    yield RatingRow("resolution", LoadCase.LARGEST, resolution, limit, answer, of_computation=True)
