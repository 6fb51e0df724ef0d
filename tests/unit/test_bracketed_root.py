"""Roots between two places."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from scipy.optimize import brentq

from swgpar.geometry.bracketed_root import root_between

FUNCTIONS: list[tuple[Callable[[float], float], float, float]] = [
    (lambda x: x**3 - 2.0 * x - 5.0, 2.0, 3.0),
    (lambda x: math.cos(x) - x, 0.0, 1.0),
    (lambda x: math.exp(-x) - 1e-9, 0.0, 40.0),
    (lambda x: (x - 1.0 / 3.0) ** 9 + 1e-3 * (x - 1.0 / 3.0), -1.0, 3.0),
    (lambda x: -1.0 if x < 0.7 else 2.0, 0.0, 1.0),  # a jump
    (lambda x: math.atan(1e6 * (x - 0.1)), -5.0, 90.0),
]


@pytest.mark.parametrize(("function", "low", "high"), FUNCTIONS)
def test_the_root_is_that_of_scipy(
    function: Callable[[float], float], low: float, high: float
) -> None:
    exact = brentq(function, low, high, xtol=1e-15)
    for ends in ((low, high), (high, low)):
        assert root_between(function, *ends) == pytest.approx(exact, abs=1e-13)


@pytest.mark.parametrize(("function", "low", "high"), FUNCTIONS)
def test_few_evaluations_are_needed(
    function: Callable[[float], float], low: float, high: float
) -> None:
    calls = []

    def counted(x: float) -> float:
        calls.append(x)
        return function(x)

    root_between(counted, low, high)
    assert len(calls) <= 70 and all(low <= x <= high for x in calls)


def test_a_tolerance_is_kept_and_ends_it_early() -> None:
    calls = []

    def function(x: float) -> float:
        calls.append(x)
        return math.cos(x) - x

    assert abs(root_between(function, 0.0, 1.0, xtol=1e-3) - 0.7390851332151607) < 1e-3
    assert len(calls) < 8


def test_an_end_may_be_the_root() -> None:
    assert root_between(lambda x: x, 0.0, 1.0) == 0.0
    assert root_between(lambda x: x - 1.0, 0.0, 1.0) == 1.0


def test_equal_signs_are_refused() -> None:
    with pytest.raises(ValueError, match="no change of sign between 1 and 2"):
        root_between(lambda x: x, 1.0, 2.0)
