"""Verdicts on the strength of a drive: they compare stresses with the strengths of [fatigue]."""

from __future__ import annotations

from swgpar.drive_results.check import Check
from swgpar.drive_results.summary import DriveSummary
from swgpar.evaluation.bolt_loads import BoltLoads
from swgpar.evaluation.largest_contact import LargestContact
from swgpar.evaluation.safety_and_life import CRITERIA, SafetyAndLife

FIRST_YIELD = 1.67
"""Largest pressure of a line contact without friction, over the yield strength, at which yield
begins below the surface, by Tresca [Johnson, Contact Mechanics, 6.1]."""

UNKNOWN = "no strengths are given ([fatigue]): compare stresses and pressures with your material"


def strength_checks(summary: DriveSummary) -> list[Check]:
    """Safety of bolts and of the flexible spline, and pressure of the flanks."""
    strengths = summary.design.fatigue
    found = [_joints(summary.bolts)] if summary.bolts and summary.bolts.judged else []
    if strengths is None:
        return [*found, Check("strength", None, UNKNOWN, of_strength=True)]
    found += [_safety(summary.fatigue)] if summary.fatigue else []
    return [*found, _pressure(summary.contact, FIRST_YIELD * strengths.yield_strength)]


def _joints(bolts: BoltLoads) -> Check:
    safeties = {"sliding": bolts.sliding, "gaping": bolts.gaping}
    known = {name: safety for name, safety in safeties.items() if safety is not None}
    stated = ", ".join(f"against {name} {safety:.3g}" for name, safety in known.items())
    good = all(safety >= 1.0 for safety in known.values())
    text = f"least safety of a bolt {stated or 'without limit'} (no estimate of the error)"
    return Check("bolts", good, f"{text}; good from 1", of_strength=True)


def _safety(fatigue: SafetyAndLife) -> Check:
    least = min(CRITERIA, key=lambda criterion: fatigue.least[criterion].safety)
    safety = fatigue.least[least].safety
    error = fatigue.goodman_error if least == "goodman" else None
    stated = "no estimate of the error" if error is None else f"± {error:.2g}"
    text = f"least safety of the flexible spline {safety:.3g} ({stated}), {CRITERIA[least]}"
    good = None if error is not None and abs(safety - 1.0) <= error else safety >= 1.0
    within = "; within its error of 1" if good is None else "; good from 1"
    return Check("safety", good, text + within, of_strength=True)


def _pressure(contact: LargestContact | None, limit: float) -> Check:
    """limit : MPa"""
    name = "pressure of the flanks"
    at = None if contact is None else contact.largest
    if contact is None or at is None:
        return Check(name, None, "no pressure is known", of_strength=True)
    good_up_to = (
        f"good up to {limit:.4g} MPa, {FIRST_YIELD:g} times the yield strength of [fatigue], where "
        "yield begins below the surface"
    )
    pressure = f"{at.pressure_MPa:.4g} MPa"
    if at.edge:
        text = f"{pressure}; {good_up_to}; it lies on an edge and has no limit"
        return Check(name, None, text, of_strength=True)
    error = contact.error_MPa
    stated = "no estimate of the error" if error is None else f"± {error:.2g}"
    near = error is not None and abs(at.pressure_MPa - limit) <= error
    good = None if near else at.pressure_MPa <= limit
    within = "; within its error of the limit" if good is None else ""
    return Check(name, good, f"{pressure} ({stated}); {good_up_to}{within}", of_strength=True)
