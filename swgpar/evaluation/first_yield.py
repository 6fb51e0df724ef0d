"""Torque at which a drive under a growing torque begins to yield (docs/theory/stiffness.md)."""

from __future__ import annotations

from collections.abc import Sequence

from swgpar.load.load_states import Stage
from swgpar.results.history import Row

GEAR_STRESSES = ("fs_vm", "rg_vm")
"""Columns of the history with the largest von Mises stresses (MPa) of the gears."""


def yield_torque(rows: Sequence[Row], sense: float, strength: float) -> float | None:
    """Torque (N·m) of the output at which a gear begins to yield; None where none does, and where
    one has yielded under the torque that the history begins with.

    Between two rows torque and stress are taken as linear. Gears that the wave generator alone
    makes yield have 0.

    By the lower bound theorem a structure of elastic, perfectly plastic material carries at least
    this torque, as long as displacements are small.

    rows : of the history of a load program;  sense : of a positive torque of the output, 1 or -1
    strength : yield strength (MPa) of both gears

    Source: D. C. Drucker, W. Prager, H. J. Greenberg, Extended limit design theorems for continuous
    media, Quarterly of Applied Mathematics 9 (1952) 381-389, theorem 1.
    """
    torque_before = stress_before = 0.0
    for number, row in enumerate(rows):
        stress = max(float(row[name]) for name in GEAR_STRESSES)
        loaded = row["step"] >= Stage.LOAD
        torque = sense * float(row["output_torque_Nmm"]) / 1000.0 if loaded else 0.0
        if stress >= strength:
            if loaded and not number:
                return None
            share = (strength - stress_before) / (stress - stress_before)
            return torque_before + share * (torque - torque_before)
        torque_before, stress_before = torque, stress
    return None
