"""The runs that a rating sheet needs: answers that one run cannot give together come from several.

A run has one torque, or one load program. Losses, fatigue and transmission error need a period
under one torque, natural frequencies the whole drive under it, stiffness and ratcheting a program.
Loads of one torque share a run.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from math import gcd
from typing import Any

import numpy as np

from swgpar.analysis.shortcuts import SAMPLES
from swgpar.checks.design_file import make_drive, with_points
from swgpar.checks.rating_checks import check_rating, check_torques
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.input.toml_file import validate


class LoadCase(StrEnum):
    """What a row of the sheet refers to."""

    RATED = "rated torque"
    REPEATED_PEAK = "repeated peak torque"
    AVERAGE = "average torque"
    LARGEST = "largest torque"
    NO_LOAD = "no load"
    STIFFNESS = "stiffness"
    RATCHETING = "ratcheting"
    MODES = "natural frequencies"


@dataclass(frozen=True)
class PlannedRun:
    """A run of the sheet.

    cases : that it serves
    design : None where it is refused, for the reason in `refusal`
    torque : N·m, None of a run that has several
    left_out : what the design asks for and the run does not have, and why
    windows : whether its stresses are resolved, which an accuracy is for
    """

    cases: tuple[LoadCase, ...]
    design: DriveDesign | None
    torque: float | None = None
    refusal: str = ""
    left_out: str = ""
    windows: bool = False

    @property
    def name(self) -> str:
        """Its name: the cases."""
        return ", ".join(self.cases)

    def folder(self, identity: str) -> str:
        """Name of its folder. identity : of what it computes, empty of a run that is refused"""
        return "_".join(filter(None, (*self.cases[0].split(), identity[:IDENTITY])))


@dataclass(frozen=True)
class RatingPlan:
    """runs : in their order;  missing : why there is none for a case"""

    runs: tuple[PlannedRun, ...]
    missing: dict[LoadCase, str] = field(default_factory=dict)


@dataclass(frozen=True)
class RatingLoads:
    """Torques (N·m) and speed (1/min) of a rating, with their defaults.

    momentary, ratcheting : None where they are not given; the latter is the least torque at which
    the drive may ratchet;  largest : of all torques
    """

    rated: float
    repeated_peak: float
    average: float
    momentary: float | None
    ratcheting: float | None
    average_speed: float

    @property
    def largest(self) -> float:
        """The largest of all torques."""
        return max(self.rated, self.repeated_peak, self.average, self.momentary or 0.0)


NO_STRENGTHS = "no strengths are given: [fatigue]"
NO_BEARING = "the wave generator has no bearing: [wave_generator.bearing]"
NO_LOSSES = "no coefficients of losses are given: [losses]"

SUFFICIENT = 1.25
"""Torque at which a run with [ratcheting] ends, over the least one of the sheet: more than the
errors by the mesh that stiffness and forces have."""

IDENTITY = 8
"""Letters of an identity that tell the runs of one case apart."""

APART = ("rating", "stiffness", "ratcheting", "fatigue", "losses", "deviations", "frequencies")
"""Sections that a run has only where it is for them."""


def rating_loads(design: DriveDesign) -> RatingLoads:
    """The loads of a design with [rating]. Raises InputError where there is no torque."""
    section = design.rating
    if section is None:
        raise InputError("rating is missing: swgpar rate needs the section [rating]")
    rated = section.rated_torque or design.load.torque
    if not rated:
        raise InputError("rating.rated_torque is missing: give it, or load.torque, above 0 N·m")
    peak, average = section.repeated_peak_torque or rated, section.average_torque or rated
    check_torques(section, rated, peak, average)
    return RatingLoads(
        rated=rated,
        repeated_peak=peak,
        average=average,
        momentary=section.momentary_torque,
        ratcheting=None
        if section.momentary_torque is None
        else section.momentary_torque * section.ratcheting_safety,
        average_speed=section.average_speed or design.load.input_speed,
    )


@dataclass(frozen=True)
class _UnderTorque:
    """What a run under one torque is for.

    period : whether it goes through one
    windows : whether stresses are resolved
    errors : whether the mesh is compared with coarser ones; with windows it is
    """

    cases: tuple[LoadCase, ...]
    sections: tuple[str, ...] = ()
    period: bool = False
    windows: bool = False
    errors: bool = False

    def __add__(self, other: _UnderTorque) -> _UnderTorque:
        return _UnderTorque(
            self.cases + other.cases,
            self.sections + other.sections,
            self.period or other.period,
            self.windows or other.windows,
            self.errors or other.errors,
        )


def make_rated_drive(table: dict[str, Any]) -> DriveDesign:
    """A design with [rating] from the content of its file. Sections that one run cannot have
    together may stand beside each other. Problems are InputErrors."""
    design = validate(DriveDesign, with_points(table)).made_by(make_rated_drive)
    loads = rating_loads(design)
    make_drive(_content(design, loads, loads.rated, ()))
    check_rating(design)
    return design


def plan_runs(design: DriveDesign) -> RatingPlan:
    """The runs of the rating sheet of a design. Raises InputError without [rating] or a torque."""
    loads = rating_loads(design)
    missing: dict[LoadCase, str] = {}
    wanted: dict[float, _UnderTorque] = {}

    def want(torque: float, run: _UnderTorque) -> None:
        wanted[torque] = wanted[torque] + run if torque in wanted else run

    given = tuple(name for name in ("losses", "deviations") if getattr(design, name) is not None)
    want(loads.rated, _UnderTorque((LoadCase.RATED,), given, period=True, errors=True))
    if design.fatigue is None:
        missing[LoadCase.REPEATED_PEAK] = NO_STRENGTHS
    else:
        peak = _UnderTorque((LoadCase.REPEATED_PEAK,), ("fatigue",), period=True, windows=True)
        want(loads.repeated_peak, peak)
    if design.bearing is None:
        missing[LoadCase.AVERAGE] = NO_BEARING
    else:
        want(loads.average, _UnderTorque((LoadCase.AVERAGE,), errors=True))
    want(loads.largest, _UnderTorque((LoadCase.LARGEST,), windows=True))
    runs = [_under_torque(design, loads, torque, run) for torque, run in wanted.items()]
    if "losses" in given:
        idle = _UnderTorque((LoadCase.NO_LOAD,), ("losses",), period=True)
        runs.append(_under_torque(design, loads, 0.0, idle))
    else:
        missing[LoadCase.NO_LOAD] = NO_LOSSES
    runs.append(_program(design, loads, LoadCase.STIFFNESS))
    if lacks := _without_modes(design):
        missing[LoadCase.MODES] = lacks
    else:
        modes = _UnderTorque((LoadCase.MODES,), ("frequencies",))
        friction = design.contact.friction > 0.0
        runs.append(_under_torque(design, loads, loads.rated, modes, without_friction=friction))
    if loads.momentary is None:
        missing[LoadCase.RATCHETING] = "rating.momentary_torque is not given"
    else:  # the longest one
        runs.append(_program(design, loads, LoadCase.RATCHETING))
    return RatingPlan(tuple(runs), missing)


def _without_modes(design: DriveDesign) -> str:
    """Why there are no natural frequencies to compute; empty where there are."""
    if design.frequencies is None:
        return "the inertia of the output is not given: [frequencies]"
    given = design.rating is not None and design.rating.largest_speed is not None
    return "" if given else "rating.largest_speed is not given"


def _content(
    design: DriveDesign, loads: RatingLoads, torque: float, sections: tuple[str, ...]
) -> dict[str, Any]:
    """Content of a design file with one torque (N·m), some of the sections in `APART`, and no
    rotation."""
    table = design.model_dump(exclude_unset=True)
    kept = {key: value for key, value in table.items() if key not in APART or key in sections}
    load = {**table.get("load", {}), "torque": torque, "input_speed": loads.average_speed}
    load.pop("program", None)
    steps = {**table.get("steps", {}), "rotation": 0.0, "samples": 0}
    output = {**table.get("output", {}), "fields": False, "figures": False}
    return kept | {"load": load, "steps": steps, "output": output}


def _under_torque(
    design: DriveDesign,
    loads: RatingLoads,
    torque: float,
    run: _UnderTorque,
    *,
    without_friction: bool = False,
) -> PlannedRun:
    """A run under one torque (N·m). Where it is refused, a run with errors leaves out its sections,
    and then its period."""
    content, said = _content(design, loads, torque, run.sections), ""
    if without_friction:
        content["contact"] = {**content.get("contact", {}), "friction": 0.0}
        said = "friction of the flanks, which it cannot have"
    compared = run.windows or run.errors
    if not run.windows:
        asked = {"root_stress": False, "contact_errors": run.errors}
        content["output"] = {**content["output"], **asked}
    alone = {key: value for key, value in content.items() if key not in APART}
    ways = [_with_period(design, content, run)]
    if compared:
        ways += [_with_period(design, alone, run), alone]
    refusals: list[str] = []
    for way in ways:
        try:
            made = make_drive(way)
        except InputError as error:
            refusals.append(str(error))
            continue
        return PlannedRun(run.cases, made, torque, "", (*refusals, said)[0], run.windows)
    return PlannedRun(run.cases, None, torque, refusals[0])


def _with_period(design: DriveDesign, content: dict[str, Any], run: _UnderTorque) -> dict[str, Any]:
    """The content with the angles of a period, where the run goes through one."""
    if not run.period:
        return content
    periods = 2 if content.get("contact", {}).get("friction") else 1
    cycle = any(content.get(name) is not None for name in ("fatigue", "losses"))
    samples = design.steps.samples or _samples(design, cycle=cycle)
    rotation = float(np.degrees(design.kinematics.period_angle)) * periods
    return content | {"steps": {**content["steps"], "rotation": rotation, "samples": samples}}


def _samples(design: DriveDesign, *, cycle: bool) -> int:
    """Angles in a period. cycle : whether a stress cycle is asked for, which needs one at every
    pitch of a period of teeth and bolts"""
    kinematics, fewest = design.kinematics, SAMPLES[design.drive.model]
    if kinematics.pitches == 1:
        return kinematics.apart(fewest)
    samples = max(fewest, kinematics.pitches) if cycle else fewest
    while kinematics.states(samples) < samples or gcd(samples, kinematics.pitches) > 1:
        samples += 1
    return samples


def _program(design: DriveDesign, loads: RatingLoads, case: LoadCase) -> PlannedRun:
    """The run of the section [stiffness] or [ratcheting]."""
    name = str(case)
    section = getattr(design, name)
    keys = {} if section is None else section.model_dump(exclude_unset=True)
    if case == LoadCase.STIFFNESS:
        # no further points than those that the values of the sheet need
        keys = {"torque": loads.rated, "rated_torque": loads.rated, "points": 1} | keys
    elif loads.ratcheting is not None:
        keys = {"sufficient_torque": SUFFICIENT * loads.ratcheting} | keys
        # a small one: behind a jump there may be an equilibrium under more than the drive carries
        start = min(loads.rated, loads.average)
        # with friction a state depends on the path; the first yield may be below the start
        skips = not design.contact.friction and "yield_strength" not in keys
        if skips and start < keys["sufficient_torque"]:
            keys = {"start_torque": start} | keys
    content = _content(design, loads, loads.rated, ()) | {name: keys}
    content["output"] = {**content["output"], "root_stress": False}
    try:
        return PlannedRun((case,), make_drive(content))
    except InputError as error:
        return PlannedRun((case,), None, refusal=str(error))
