"""The key of a body's temperature."""

from __future__ import annotations

from typing import Any

from swgpar.input.quantities import quantity


def temperature(of: str) -> Any:
    """Declare the uniform temperature of a body. of : words that name it"""
    return quantity(
        None,
        unit="°C",
        text=f"temperature of {of}, the same everywhere in it; without it "
        "load.reference_temperature",
        ge=-273.15,
        le=1000.0,
    )
