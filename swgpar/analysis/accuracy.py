"""The accuracy that a run is asked for: which designs allow one, and how many angles suit it."""

from __future__ import annotations

import numpy as np

from swgpar.checks.output_bearing_checks import SIDEWAYS
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.input.require import require

LOWEST, HIGHEST = 1e-3, 0.2
"""Accuracies that may be asked for."""

ROUGH = 0.04
"""Accuracy from which an answer may be rough: the first windows are few."""

SAMPLES = ((ROUGH, 2), (0.02, 4), (0.005, 8), (0.0, 16))
"""Smallest accuracy and number of angles in a period. Four instead of eight change the means of the
plane half turn by 0.3 %, those of the cup drive by 0.5 %. Two instead of four change s1 of the cup
drive by 0.7 %, its input torque by 0.2 %. The summary of a run has the change by half of its own
angles."""


def not_refinable(design: DriveDesign) -> tuple[str, str] | None:
    """What keeps the mesh from being chosen by an accuracy, and what is allowed; None without."""
    for given, what, allowed in (
        (design.has_program, "a load program", "a mesh recipe"),
        (design.is_loaded_sideways, SIDEWAYS, "without them"),
    ):
        if given:
            return what, allowed
    return None


def require_refinable(design: DriveDesign, accuracy: float) -> None:
    """Refuse an accuracy for designs whose mesh is not chosen by one."""
    if (found := not_refinable(design)) is not None:
        what, allowed = found
        raise InputError(f"--accuracy {accuracy:g} is not available with {what}: allowed {allowed}")


def require_accuracy(accuracy: float) -> None:
    """Refuse an accuracy that is out of range."""
    fits = LOWEST <= accuracy <= HIGHEST
    require(fits, "--accuracy", accuracy, f"{LOWEST:g} to {HIGHEST:g}")


def with_accuracy(design: DriveDesign, accuracy: float) -> DriveDesign:
    """The design with the angles of the period that suit an accuracy, unless it says them itself;
    not with bolts, whose period is long.

    Raises InputError where the accuracy is out of range.
    """
    require_accuracy(accuracy)
    whole_period = design.steps.rotation >= 0.999999 * design.periods * np.degrees(
        design.kinematics.period_angle
    )
    given, kinematics = "samples" in design.steps.model_fields_set, design.kinematics
    if given or not whole_period or kinematics.pitches > 1:
        return design
    samples = next(count for least, count in SAMPLES if accuracy >= least)
    while kinematics.states(samples) < samples:  # some angles would show the same state
        samples += 1
    return design.model_copy(update={"steps": design.steps.model_copy(update={"samples": samples})})
