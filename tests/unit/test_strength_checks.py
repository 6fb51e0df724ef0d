"""Verdicts on strength change where a limit is crossed."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import pytest

from swgpar.drive_results.check import Check
from swgpar.drive_results.strength_checks import FIRST_YIELD, strength_checks
from swgpar.drive_results.summary import DriveSummary

YIELD = 1000.0


def verdicts(
    safety: float = 2.0,
    *,
    error: float | None = 0.1,
    pressure: float = 500.0,
    edge: int = 0,
    known: bool = True,
    pressure_error: float | None = 20.0,
    bolts: SimpleNamespace | None = None,
) -> dict[str, Check]:
    least = {
        "goodman": SimpleNamespace(safety=safety),
        "crossland": SimpleNamespace(safety=safety + 1.0),
        "yield": SimpleNamespace(safety=safety + 1.0),
    }
    largest = SimpleNamespace(pressure_MPa=pressure, edge=edge)
    summary = SimpleNamespace(
        design=SimpleNamespace(fatigue=SimpleNamespace(yield_strength=YIELD) if known else None),
        fatigue=SimpleNamespace(least=least, goodman_error=error),
        contact=SimpleNamespace(largest=largest, error_MPa=pressure_error),
        bolts=bolts,
    )
    return {one.name: one for one in strength_checks(cast(DriveSummary, summary))}


def test_without_strengths_nothing_is_judged() -> None:
    assert verdicts(known=False)["strength"].good is None


@pytest.mark.parametrize(("safety", "good"), [(1.11, True), (0.89, False), (1.09, None)])
def test_safety_is_judged_beyond_its_error(safety: float, good: bool | None) -> None:
    assert verdicts(safety)["safety"].good is good


def test_safety_without_an_error_is_judged_by_its_value() -> None:
    assert verdicts(1.01, error=None)["safety"].good is True
    assert verdicts(0.99, error=None)["safety"].good is False


@pytest.mark.parametrize(
    ("over_limit", "good"), [(-21.0, True), (21.0, False), (19.0, None), (-19.0, None)]
)
def test_pressure_is_judged_where_yield_begins(over_limit: float, good: bool | None) -> None:
    pressure = FIRST_YIELD * YIELD + over_limit
    assert verdicts(pressure=pressure)["pressure of the flanks"].good is good


def test_a_pressure_on_an_edge_is_not_judged() -> None:
    assert verdicts(pressure=100.0, edge=1)["pressure of the flanks"].good is None


def test_a_pressure_without_an_error_says_so() -> None:
    check = verdicts(pressure=FIRST_YIELD * YIELD - 1.0, pressure_error=None)[
        "pressure of the flanks"
    ]
    assert check.good is True
    assert "no estimate of the error" in check.text


@pytest.mark.parametrize(
    ("sliding", "gaping", "good"),
    [(1.01, 1.5, True), (0.99, 1.5, False), (1.5, 0.99, False), (None, 1.5, True)],
)
def test_a_joint_holds_where_it_neither_slides_nor_gapes(
    sliding: float | None, gaping: float, good: bool
) -> None:
    bolts = SimpleNamespace(judged=True, sliding=sliding, gaping=gaping)
    assert verdicts(bolts=bolts)["bolts"].good is good
    assert "bolts" not in verdicts(bolts=SimpleNamespace(judged=False))
