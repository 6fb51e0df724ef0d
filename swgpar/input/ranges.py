"""Magnitudes of numbers by their unit: far beyond those of any drive or gear train, far inside
those of arithmetic.

A number beyond them is a slip, and would end in an overflow or in a division by zero somewhere in a
run.
"""

from __future__ import annotations

from typing import Any

SMALLEST_AND_LARGEST = {
    "": (1e-15, 1e12),
    "modules": (1e-9, 1e3),
    "pitches": (1e-9, 1e3),
    "mm": (1e-9, 1e6),
    "1/mm": (1e-9, 1e9),
    "deg": (1e-3, 1e6),
    "N·m": (1e-15, 1e9),
    "1/min": (1e-6, 1e6),
    "MPa": (1e-6, 1e14),
    "GPa": (1e-3, 1e5),
    "s": (1e-12, 1e9),
    "GB": (1e-6, 1e9),
    "µm": (1e-6, 1e6),
    "N·m/deg": (1e-6, 1e12),
    "N·m/rad": (1e-6, 1e15),
    "N·m·s/rad": (1e-9, 1e12),
    "kg·m²": (1e-12, 1e9),
    "mrad": (1e-6, 1e3),
    "kN": (1e-9, 1e9),
    "N/m": (1e-3, 1e15),
    "N/mm": (1e-6, 1e12),
    "kg": (1e-9, 1e9),
    "m": (1e-6, 1e6),
    "m/s²": (1e-6, 1e3),
    "standard deviations": (1e-3, 1e2),
    "1/s": (1e-9, 1e9),
    "N": (1e-9, 1e12),
    "rad/s": (1e-9, 1e9),
    "cycles": (1e-9, 1e3),
    "kg/m³": (1e-3, 1e6),
    "°C": (1e-6, 1e4),
    "1/K": (1e-9, 1e-2),
    "km/h": (1e-6, 1e5),
    "h": (1e-6, 1e9),
    "arc minutes": (1e-6, 1e6),
    "arcsec": (1e-6, 1e6),
    "N·√s": (1e-12, 1e9),
    "HV": (1.0, 1e5),
    "mm²/s": (1e-3, 1e7),
}
"""Unit -> smallest magnitude of a number that is not 0, and largest."""


def magnitudes(unit: str) -> tuple[float, float]:
    """Smallest magnitude of a number that is not 0, and largest, with this unit."""
    return SMALLEST_AND_LARGEST.get(unit, SMALLEST_AND_LARGEST[""])


def beyond(value: Any, unit: str) -> bool:
    """Whether a number, or one of a list, has another magnitude than numbers of this unit; False
    for all else."""
    if isinstance(value, list):
        return any(beyond(item, unit) for item in value)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    smallest, largest = magnitudes(unit)
    return abs(value) > largest or 0.0 < abs(value) < smallest
