"""Section [rating] of the drive's design file."""

from __future__ import annotations

from typing import Any, Literal

from swgpar.input.quantities import Section, positive, quantity


def _torque(text: str) -> Any:
    return positive(text, "N·m", None)


def _safety(text: str) -> Any:
    return positive(f"least safety {text}", default=1.0, le=100.0)


class RatingSection(Section):
    """Section [rating]: loads of a drive in its application, and what is required of it. Present
    for `swgpar rate`; other commands leave it aside."""

    rated_torque: float | None = _torque(
        "rated torque on the output: efficiency, transmission error, stiffness, natural "
        "frequencies; default load.torque"
    )
    repeated_peak_torque: float | None = _torque(
        "peak torque of every cycle: fatigue; default the rated torque"
    )
    average_torque: float | None = _torque(
        "average torque: life of the bearing; default the rated torque"
    )
    momentary_torque: float | None = _torque(
        "largest torque that may act for a moment: yield, static safety, ratcheting; without it "
        "the largest of the others, and no verdict on ratcheting"
    )
    average_speed: float | None = positive(
        "average speed of the input: losses and lives; default load.input_speed",
        "1/min",
        None,
        le=1e6,
    )
    largest_speed: float | None = positive(
        "largest speed of the input: natural frequencies have to be above that of the lobes",
        "1/min",
        None,
        le=1e6,
    )
    life: float | None = positive("required life of bearing and flexible spline", "h", None)
    yield_safety: float = _safety("against yield under the largest torque")
    fatigue_safety: float = _safety("against fatigue under the repeated peak torque")
    static_safety: float = _safety("of the bearing's balls under the largest torque")
    ratcheting_safety: float = _safety("of the ratcheting torque over the momentary one")
    flank_pressure: float | None = positive(
        "largest pressure of the flanks that their materials bear under the rated torque",
        "MPa",
        None,
    )
    flank_pressure_source: str = quantity("", text="where this pressure comes from")
    flank_treatment: (
        Literal["through_hardened", "induction_hardened", "nitrided", "case_hardened"] | None
    ) = quantity(
        None,
        text="instead of flank_pressure: treatment of the softer flank, of steel, whose pressure "
        "follows from flank_hardness",
    )
    flank_hardness: float | None = positive("hardness of the softer flank", "HV", None)
    ring_yield_strength: float | None = positive(
        "yield strength of the ring gear; default fatigue.yield_strength where both gears are of "
        "one material",
        "MPa",
        None,
    )
    K1: float | None = positive("least stiffness up to the first break point", "N·m/rad", None)
    K2: float | None = positive("least stiffness between the break points", "N·m/rad", None)
    K3: float | None = positive("least stiffness above the second break point", "N·m/rad", None)
    hysteresis: float | None = positive(
        "largest width of the stiffness loop at zero torque", "arc minutes", None
    )
    lost_motion: float | None = positive("largest lost motion", "arc minutes", None)
    transmission_error: float | None = positive(
        "largest transmission error, peak to peak", "arcsec", None
    )
    efficiency: float | None = positive(
        "least efficiency under the rated torque", default=None, lt=1.0
    )
    no_load_torque: float | None = positive("largest input torque without a load", "N·m", None)
    starting_torque: float | None = positive(
        "largest input torque that starts the drive without a load", "N·m", None
    )
