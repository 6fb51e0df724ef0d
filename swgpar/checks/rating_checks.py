"""Checks of the torques of [rating], of the strengths of its limits, and of what it says of the
flanks.

Each refusal names the key, its value and what is allowed.
"""

from __future__ import annotations

from swgpar.checks.fatigue_checks import check_fatigue
from swgpar.design.drive_design import DriveDesign
from swgpar.design.rating_section import RatingSection
from swgpar.errors import InputError
from swgpar.input.require import require, require_available
from swgpar.materials.pitting import PITTING_LIMITS, STEEL_MODULUS


def check_torques(section: RatingSection, rated: float, peak: float, average: float) -> None:
    """Raise InputError where a torque that acts for a shorter time is below one that acts longer.

    rated, peak, average : N·m, the rated, repeated peak and average torque, with defaults in place
    """
    key = "rating.repeated_peak_torque"
    require(peak >= rated, key, peak, f"{rated:g} N·m (the rated torque) and more")
    require(average <= peak, "rating.average_torque", average, f"above 0 to {peak:g} N·m ({key})")
    momentary = section.momentary_torque
    if momentary is not None:
        allowed = f"{peak:g} N·m (the repeated peak torque) and more"
        require(momentary >= peak, "rating.momentary_torque", momentary, allowed)


def check_rating(design: DriveDesign) -> None:
    """Raise InputError where the strengths do not fit, or where treatment and hardness of the
    flanks give no limit.

    Strengths are checked here too: a run that leaves [fatigue] out has not seen them.
    """
    if design.fatigue is not None:
        check_fatigue(design, design.fatigue)
    section = design.rating
    if section is None:
        return
    treatment, hardness = section.flank_treatment, section.flank_hardness
    if treatment is None:
        allowed = "only with rating.flank_treatment"
        require(hardness is None, "rating.flank_hardness", hardness, allowed)
        return
    key = f'rating.flank_treatment = "{treatment}"'
    if hardness is None:
        raise InputError(f"rating.flank_hardness is missing: {key} needs it")
    given = f"rating.flank_pressure = {section.flank_pressure}"
    require_available(section.flank_pressure is None, key, given, "one of them")
    limit = PITTING_LIMITS[treatment]
    allowed = f"{limit.softest:g} to {limit.hardest:g} HV with {key}"
    require(limit.softest <= hardness <= limit.hardest, "rating.flank_hardness", hardness, allowed)
    low, high = STEEL_MODULUS
    for gear in design.gears:
        modulus = design.materials[gear].modulus
        steels = f"steels, {1e-3 * low:g} to {1e-3 * high:g} GPa"
        beside = f"a {gear.replace('_', ' ')} of {1e-3 * modulus:.4g} GPa"
        require_available(low <= modulus <= high, key, beside, steels)
