"""What is left over and left out by the solution of a run."""

from __future__ import annotations

from collections.abc import Sequence

from swgpar.answers.answer import AnswerGroup, answer, evaluation
from swgpar.results.history import Row

BALANCE = 1e-4
"""Largest torque that may be left over, over the largest torque of the teeth."""


@evaluation
class Numerics(AnswerGroup):
    """Residues of a run.

    largest_tooth_torque_Nmm : largest torque of the teeth
    condensed_MPa : None without condensed sectors
    """

    balance_error_Nmm: float = answer(
        "residue.torque",
        "torque that is left over in an increment, largest",
        "N·mm",
        exact=True,
        limit="largest_balance_Nmm",
    )
    largest_tooth_torque_Nmm: float
    condensed_MPa: float | None = answer(
        "residue.condensed", "bending stress that condensed sectors leave out", "MPa", exact=True
    )

    TITLE = "torque balance and reductions"

    @property
    def largest_balance_Nmm(self) -> float:
        """Torque (N mm) that may be left over."""
        return BALANCE * self.largest_tooth_torque_Nmm


def torque_left(rows: Sequence[Row]) -> float:
    """Largest torque (N·mm) that an increment of the history leaves over."""
    return max((row["torque_balance_Nmm"] for row in rows), default=0.0)


def evaluate_numerics(rows: Sequence[Row], condensed: float | None) -> Numerics:
    """From the rows of the history. condensed : MPa, as in `Numerics`"""
    return Numerics(
        balance_error_Nmm=torque_left(rows),
        largest_tooth_torque_Nmm=max((abs(row["tooth_torque_Nmm"]) for row in rows), default=0.0),
        condensed_MPa=condensed,
    )
