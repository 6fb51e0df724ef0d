"""Section [rating] of the drive's design file."""

from __future__ import annotations

from typing import Any

from swgpar.input.quantities import Section, quantity


def _torque(text: str) -> Any:
    return quantity(None, unit="N·m", text=text, gt=0.0)


def _safety(text: str) -> Any:
    return quantity(1.0, text=f"least safety {text}", gt=0.0, le=100.0)


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
    average_speed: float | None = quantity(
        None,
        unit="1/min",
        text="average speed of the input: losses and lives; default load.input_speed",
        gt=0.0,
        le=1e6,
    )
    largest_speed: float | None = quantity(
        None,
        unit="1/min",
        text="largest speed of the input: natural frequencies have to be above that of the lobes",
        gt=0.0,
        le=1e6,
    )
    life: float | None = quantity(
        None, unit="h", text="required life of bearing and flexible spline", gt=0.0
    )
    yield_safety: float = _safety("against yield under the largest torque")
    fatigue_safety: float = _safety("against fatigue under the repeated peak torque")
    static_safety: float = _safety("of the bearing's balls under the largest torque")
    ratcheting_safety: float = _safety("of the ratcheting torque over the momentary one")
    flank_pressure: float | None = quantity(
        None,
        unit="MPa",
        text="largest pressure of the flanks that their materials bear under the rated torque",
        gt=0.0,
    )
    flank_pressure_source: str = quantity("", text="where this pressure comes from")
    K1: float | None = quantity(
        None, unit="N·m/rad", text="least stiffness up to the first break point", gt=0.0
    )
    K2: float | None = quantity(
        None, unit="N·m/rad", text="least stiffness between the break points", gt=0.0
    )
    K3: float | None = quantity(
        None, unit="N·m/rad", text="least stiffness above the second break point", gt=0.0
    )
    hysteresis: float | None = quantity(
        None, unit="arc minutes", text="largest width of the stiffness loop at zero torque", gt=0.0
    )
    lost_motion: float | None = quantity(
        None, unit="arc minutes", text="largest lost motion", gt=0.0
    )
    transmission_error: float | None = quantity(
        None, unit="arcsec", text="largest transmission error, peak to peak", gt=0.0
    )
    efficiency: float | None = quantity(
        None, text="least efficiency under the rated torque", gt=0.0, lt=1.0
    )
    no_load_torque: float | None = quantity(
        None, unit="N·m", text="largest input torque without a load", gt=0.0
    )
