"""Answers of the sheet that follow from those of a run: stresses by parts of the flexible spline,
safeties, shares."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace

from swgpar.answers.answer import Answer, with_error, with_no_limit
from swgpar.drive_results.report_checks import RESOLUTION
from swgpar.drive_results.summary import DriveSummary
from swgpar.evaluation.bearing_loads import BALL_LOAD, BALL_PRESSURE
from swgpar.evaluation.safety_and_life import CRITERIA, LIFE_HOURS, RegionSafety
from swgpar.largest_stress.places import OF_REGION, region_kind
from swgpar.model.regions import (
    ATTACHED,
    BACK,
    OUTER,
    RIM,
    RIM_INSIDE,
    TOOTH_END,
    TOOTH_ROOT,
    WALL,
)

AT_TEETH = (TOOTH_ROOT, TOOTH_END, RIM_INSIDE)
"""Regions of the toothed part of the flexible spline away from contacts of flanks."""

BEHIND_TEETH = (*WALL, BACK, ATTACHED)
"""Regions of its wall."""

IN_RING = (TOOTH_ROOT, TOOTH_END, RIM, OUTER)
"""Regions of ring gears away from contacts of flanks."""

RING_GEARS = ("rg", "ds")
"""Keys of `BODIES` of a drive's ring gears."""

STATIC_PRESSURE = 4200.0
"""Pressure (MPa) between ball and race under the basic static load rating of a radial ball bearing
[ISO 76]."""

AGAINST_FATIGUE = ("goodman", "crossland")


def largest_mises(
    summary: DriveSummary, regions: Collection[str], gears: Sequence[str] = ("fs",)
) -> Answer | None:
    """Largest von Mises stress of gears in these regions. gears : keys of `BODIES`"""
    every = (summary.find(region_kind(gear, "vm", region)) for gear in gears for region in regions)
    found = [one for one in every if one is not None and one.value is not None]
    return max(found, key=lambda one: one.value or 0.0, default=None)


def least_fatigue_safety(summary: DriveSummary, regions: Collection[str]) -> Answer | None:
    """Least safety of the flexible spline against fatigue in these regions, by Goodman or
    Crossland; its error is known where it is the least of all by Goodman and a window resolves
    it."""
    fatigue = summary.fatigue
    if fatigue is None:
        return None
    found = [
        (one.safety[criterion], criterion, region, one)
        for region, one in fatigue.regions.items()
        if region in regions
        for criterion in AGAINST_FATIGUE
        if criterion in one.safety
    ]
    if not found:
        return None
    safety, criterion, region, one = min(found, key=lambda each: each[0])
    least = fatigue.least[criterion]
    known = criterion == "goodman" and least.safety == safety and least.region == region
    answer = Answer(
        name=f"fatigue.{criterion}{OF_REGION}{region}",
        value=safety,
        unit="",
        text=f"least safety factor {CRITERIA[criterion]}",
        place=least.place if known else region,
    )
    answer = with_error(answer, fatigue.goodman_error if known else None)
    return _with_warning(answer, one)


def _with_warning(answer: Answer, region: RegionSafety) -> Answer:
    """The answer, where its stress depends on the mesh without a limit."""
    return with_no_limit(replace(answer, remark=region.warning)) if region.warning else answer


def spline_life(summary: DriveSummary) -> Answer | None:
    """Life of the flexible spline in hours by Basquin; infinite without damage."""
    if summary.fatigue is None:
        return None
    hours = summary.fatigue.life.life_hours
    place = summary.fatigue.least["goodman"].place
    return with_error(LIFE_HOURS.answer(math.inf if hours is None else hours, place=place), None)


def static_safety(summary: DriveSummary) -> Answer | None:
    """Static safety of the bearing by its largest pressure: loads of a point contact are as the
    third power of it [ISO 76]."""
    pressure = summary.find(BALL_PRESSURE)
    if pressure is None or not pressure.value:
        return None
    safety = (STATIC_PRESSURE / pressure.value) ** 3
    error = None if pressure.error is None else 3.0 * safety * pressure.error / pressure.value
    load = summary.find(BALL_LOAD)
    remark = "" if load is None or load.value is None else f"largest ball load {load.value:.4g} N"
    answer = Answer(
        name="bearing.static_safety",
        value=safety,
        unit="",
        text="static safety of the bearing",
        place=pressure.place,
        remark=f"{remark}, pressure {pressure.value:.4g} MPa",
    )
    return with_error(answer, error)


def resolution(summary: DriveSummary) -> Answer | None:
    """Error of the largest tension at the teeth over its value."""
    root = summary.root_stress
    if root is None or root.total_error is None or not root.s1:
        return None
    error = root.total_error / abs(root.s1)
    remark = ""
    if summary.accuracy is not None:
        remark = summary.accuracy.remark
    elif error > RESOLUTION:
        remark = f"--accuracy {RESOLUTION:g} refines the meshes until it is at most that"
    return Answer(
        name="root.relative_error",
        value=error,
        unit="",
        text="error of the largest tension at the teeth over its value",
        place=root.place,
        remark=remark,
    )
