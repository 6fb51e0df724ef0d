"""Verdicts on the strength of a drive: they compare stresses with the strengths of [fatigue]."""

from __future__ import annotations

import math

from swgpar.answers.answer import Answer, with_error
from swgpar.answers.verdict import Judgement, Limit, Sense, Verdict
from swgpar.drive_results.check import Check
from swgpar.drive_results.summary import DriveSummary
from swgpar.evaluation.bolt_loads import BoltLoads
from swgpar.evaluation.largest_contact import LargestContact
from swgpar.evaluation.safety_and_life import CRITERIA, SafetyAndLife

FIRST_YIELD = 1.67
"""Largest pressure of a line contact without friction, over the yield strength, at which yield
begins below the surface, by Tresca [Johnson, Contact Mechanics, 6.1]."""

UNKNOWN = "no strengths are given ([fatigue]): compare stresses and pressures with your material"

FROM_1 = Limit(1.0, Sense.AT_LEAST, "no margin")

NO_PERIOD = "no safety of the flexible spline is known: it needs a period (steps.samples)"

GOOD = {Judgement.PASSES: True, Judgement.FAILS: False}
"""Checks that say something, by the judgement of their verdict."""


def strength_checks(summary: DriveSummary) -> list[Check]:
    """Safety of bolts and of the flexible spline, and pressure of the flanks."""
    strengths = summary.design.fatigue
    found = [_joints(summary.bolts)] if summary.bolts and summary.bolts.judged else []
    if strengths is None:
        return [*found, Check("strength", None, UNKNOWN, of_strength=True)]
    fatigue = summary.fatigue
    safety = _safety(fatigue) if fatigue else Check("safety", None, NO_PERIOD, of_strength=True)
    limit = FIRST_YIELD * strengths.yield_strength
    return [*found, safety, _pressure(summary.contact, limit)]


def _check(
    name: str, value: float, error: float | None, limit: Limit, texts: tuple[str, str]
) -> Check:
    """The check of a value beside its limit. texts : before the limit, and the limit in words"""
    answer = with_error(Answer(name, value, "", name), error)
    good = GOOD.get(Verdict(name, answer, limit).judgement)
    before, words = texts
    within = "; within its error of the limit" if good is None else ""
    return Check(name, good, f"{before}; {words}{within}", of_strength=True)


def _stated(error: float | None) -> str:
    return "no estimate of the error" if error is None else f"± {error:.2g}"


def _joints(bolts: BoltLoads) -> Check:
    safeties = {"sliding": bolts.sliding, "gaping": bolts.gaping}
    known = {name: safety for name, safety in safeties.items() if safety is not None}
    stated = ", ".join(f"against {name} {safety:.3g}" for name, safety in known.items())
    text = f"least safety of a bolt {stated or 'without limit'} ({_stated(None)})"
    least = min(known.values(), default=math.inf)
    return _check("bolts", least, None, FROM_1, (text, "good from 1"))


def _safety(fatigue: SafetyAndLife) -> Check:
    least = min(CRITERIA, key=lambda criterion: fatigue.least[criterion].safety)
    safety = fatigue.least[least].safety
    error = fatigue.goodman_error if least == "goodman" else None
    text = f"least safety of the flexible spline {safety:.3g} ({_stated(error)}), {CRITERIA[least]}"
    return _check("safety", safety, error, FROM_1, (text, "good from 1"))


def _pressure(contact: LargestContact | None, most: float) -> Check:
    """most : MPa"""
    name = "pressure of the flanks"
    at = None if contact is None else contact.largest
    if contact is None or at is None:
        return Check(name, None, "no pressure is known", of_strength=True)
    words = (
        f"good up to {most:.4g} MPa, {FIRST_YIELD:g} times the yield strength of [fatigue], where "
        "yield begins below the surface"
    )
    pressure = f"{at.pressure_MPa:.4g} MPa"
    if at.edge:
        text = f"{pressure}; {words}; it lies on an edge and has no limit"
        return Check(name, None, text, of_strength=True)
    error, limit = contact.error_MPa, Limit(most, Sense.AT_MOST, "fatigue.yield_strength")
    return _check(name, at.pressure_MPa, error, limit, (f"{pressure} ({_stated(error)})", words))
