"""Teeth whose stresses are looked at by windows, and which of them are followed on finer ones."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.largest_stress import root_stress
from swgpar.largest_stress.candidate_teeth import (
    LATER,
    candidates,
    followed,
    levels_of,
    may_be_largest,
    narrowed,
)
from swgpar.largest_stress.convergence import error_at_ends, error_of
from swgpar.largest_stress.local_problem import WindowStress


def teeth(**values: float) -> np.ndarray:
    """Largest stresses of 20 teeth, 10 MPa but for those of the numbers given as t0, t1, …"""
    found = np.full(20, 10.0)
    for name, value in values.items():
        found[int(name[1:])] = value
    return found


@pytest.mark.parametrize(
    ("ends", "between", "expected"),
    [
        ({}, {"t0": 100.0}, [0]),
        # the window of tooth 0 resolves its neighbours as well, on the other side of the closed
        # chain too
        ({}, {"t0": 100.0, "t1": 99.0, "t19": 98.0}, [0]),
        ({}, {"t0": 100.0, "t5": 90.0, "t8": 80.0}, [0, 5]),
        ({"t7": 110.0}, {"t0": 100.0, "t5": 90.0}, [0, 5, 7]),
        ({"t7": 80.0}, {"t0": 100.0}, [0]),
        ({"t5": 95.0}, {"t0": 100.0, "t5": 90.0}, [0, 5]),
        # the window of tooth 0 has the ends of its teeth
        ({"t1": 120.0, "t7": 84.0}, {"t0": 100.0}, [0]),
    ],
)
def test_candidates(ends: dict[str, float], between: dict[str, float], expected: list[int]) -> None:
    tension = teeth(**between)
    found = candidates(tension, teeth(**ends), in_root=tension, mises=tension)
    assert found == expected


@pytest.mark.parametrize(
    ("in_root", "expected"),
    [
        ({"t0": 60.0, "t7": 75.0}, [0, 7]),
        ({"t0": 60.0, "t7": 65.0}, [0]),
        # the window of tooth 0 has the roots of its neighbours
        ({"t0": 60.0, "t1": 75.0}, [0]),
        # the largest one is in a root: nodal averages lose the same share of both
        ({"t0": 100.0, "t7": 75.0}, [0]),
    ],
)
def test_roots_are_looked_at_where_the_largest_stress_is_not_in_one(
    in_root: dict[str, float], expected: list[int]
) -> None:
    tension = teeth(t0=100.0)
    assert candidates(tension, in_root=teeth(**in_root), mises=tension) == expected


@pytest.mark.parametrize("round_off", [-1e-9, 0.0, 1e-9])
def test_of_equal_stresses_the_first_is_taken(round_off: float) -> None:
    """The number of ranks changes the round-off."""
    tension = teeth(t1=100.0, t2=100.0 * (1.0 + round_off), t7=95.0, t8=95.0 * (1.0 - round_off))
    assert candidates(tension, in_root=tension, mises=tension) == [1, 7]


@pytest.mark.parametrize(("value", "expected"), [(86.0, [0, 7]), (84.0, [0])])
def test_a_tooth_with_a_large_von_mises_stress_is_looked_at(
    value: float, expected: list[int]
) -> None:
    tension = teeth(t0=100.0)
    assert candidates(tension, in_root=tension, mises=teeth(t1=100.0, t7=value)) == expected


def test_a_root_is_followed_below_a_stress_that_falls() -> None:
    """Inside of the rim s1 falls from window to window, in a root it rises."""
    rim = WindowStress(100.0, 0, np.zeros(3), "rim inside", "", 1)
    for level, value, expected in (
        (0, 83.0, True),
        (0, 80.0, False),
        (1, 95.0, True),
        (2, 96.0, False),
    ):
        root = WindowStress(value, 5, np.zeros(3), "tooth root", "", 1)
        assert may_be_largest(root, rim, level, LATER["plane"]) == expected


@pytest.mark.parametrize(
    ("model", "region", "value", "level", "expected"),
    [
        ("plane", "tooth root", 97.5, 0, True),
        ("plane", "tooth root", 96.5, 0, False),
        ("plane", "tooth root", 99.4, 1, False),
        ("plane", "tooth root", 99.9, 1, True),
        ("cup", "tooth root", 97.5, 0, True),
        ("cup", "tooth root", 98.4, 1, False),
        ("cup", "tooth root", 98.6, 1, True),
        ("cup", "tooth end", 91.0, 0, True),
        ("cup", "tooth end", 89.0, 0, False),
        ("cup", "tooth end", 99.0, 1, False),
        ("cup", "tooth end", 100.1, 1, True),
    ],
)
def test_stresses_of_one_region_converge_alike(
    model: str, region: str, value: float, level: int, expected: bool
) -> None:
    best = WindowStress(100.0, 0, np.zeros(3), "tooth root", "", 1)
    other = WindowStress(value, 5, np.zeros(3), region, "", 1)
    assert may_be_largest(other, best, level, LATER[model]) == expected
    assert may_be_largest(best, best, level, LATER[model])


@pytest.mark.parametrize(
    ("value", "level", "expected"), [(89.0, 0, True), (89.0, 2, True), (87.0, 1, False)]
)
def test_a_root_is_followed_while_the_end_of_a_tooth_gives_more(
    value: float, level: int, expected: bool
) -> None:
    """Stresses at the ends fall from the second window on."""
    for region in ("tooth end", "notch", "fillet at the back"):
        end = WindowStress(100.0, 0, np.zeros(3), region, "", 1)
        assert (
            may_be_largest(
                WindowStress(value, 0, np.zeros(3), "tooth root", "", 1), end, level, LATER["cup"]
            )
            == expected
        )


def test_the_first_of_each_part_is_followed_and_others_only_where_they_may_overtake_it() -> None:
    found = {
        (0, False): WindowStress(280.0, 0, np.zeros(3), "tooth root", "", 1),
        (5, False): WindowStress(276.0, 5, np.zeros(3), "tooth root", "", 1),
        (9, False): WindowStress(279.5, 9, np.zeros(3), "tooth root", "", 1),
        (0, True): WindowStress(265.0, 0, np.zeros(3), "tooth end", "", 1),
        (5, True): WindowStress(293.0, 5, np.zeros(3), "tooth end", "", 1),
    }
    assert followed(found, 1, LATER["plane"]) == [(0, False), (9, False), (5, True)]
    assert followed(found, 1, LATER["cup"]) == [(0, False), (5, False), (9, False), (5, True)]


def test_teeth_with_nearly_the_largest_stress_have_a_narrow_window_each() -> None:
    """Finer windows change which of two teeth has the largest. Of teeth that are images of each
    other, or that windows of two places read, one has it."""

    def of(**stresses: float) -> list[WindowStress]:
        return [
            WindowStress(value, int(tooth[1:]), np.zeros(3), "tooth root", "", 1)
            for tooth, value in stresses.items()
        ]

    found = {
        (58, False): of(t60=279.0, t61=270.0),  # images of 0 and 1
        (1, False): of(t0=280.0, t1=279.0, t2=265.0),
        (7, False): of(t8=279.5),
        (1, True): of(t0=250.0),
    }
    later = LATER["cup"]
    expected = {(1, False): [0, 1], (7, False): [8], (1, True): [0]}
    assert narrowed(found, 0, 60, later) == expected
    for round_off in (-1e-7, 1e-7):  # the number of ranks changes it
        equal = {(1, False): of(t0=280.0), (58, False): of(t60=280.0 + round_off)}
        assert narrowed(equal, 0, 60, later) == {(1, False): [0]}
    alone = narrowed({(1, False): of(t0=280.0, t1=275.0)}, 0, 60, later)
    assert alone == {(1, False): [0]}


def test_levels_of_a_place_that_is_not_followed_are_those_of_one_tooth() -> None:
    """The narrow window is there for the other part of the teeth."""
    read = [{2: 960.0, 3: 1000.0}, {2: 990.0, 3: 1010.0}, {2: 1088.0}]
    assert levels_of(read, False) == [960.0, 990.0, 1088.0]
    assert levels_of(read, True) == [1000.0, 1010.0, 1088.0]


def test_a_stress_at_the_ends_that_falls_is_bounded_by_the_one_between_them() -> None:
    falling, rising = [270.0, 292.0, 284.0], [270.0, 278.0, 284.0]
    between = [270.0, 278.0, 282.0]
    alone = error_of(falling, 1.5)
    assert error_at_ends(falling, between[:1], 1.5) == alone
    assert error_at_ends(falling, between, 1.5) == pytest.approx(2.0 + error_of(between, 1.5))
    assert 2.0 + error_of(between, 1.5) < alone
    assert error_at_ends(rising, between, 1.5) == error_of(rising, 1.5)
    # coarser windows have no node at the end that the last one reads
    moved, inside = [1752.3, 1793.4, 4389.6], [4330.5, 4346.5, 4347.5]
    expected = error_of([4330.5, 4346.5, 4389.6], 1.5)
    assert error_at_ends(moved, inside, 1.5) == pytest.approx(expected)
    assert expected < 100.0 < error_of(moved, 1.5)


def test_a_narrow_window_counts_for_the_roots_and_the_ends_of_its_tooth(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The ends have a narrow window around tooth 3, the roots one around tooth 2, whose ends have
    more."""
    stresses = {(3, True): 1080.0, (2, True): 1088.0, (3, False): 1025.0, (2, False): 1073.0}

    def by_tooth(middle: int, ends: bool) -> list[WindowStress]:
        return [WindowStress(stresses[middle, ends], middle, np.zeros(3), "", "", 1)]

    @contextmanager
    def solved(*_: Any, middle: int) -> Iterator[SimpleNamespace]:
        yield SimpleNamespace(by_tooth=lambda ends: by_tooth(middle, ends))

    monkeypatch.setattr(root_stress, "solved_window", solved)
    model = SimpleNamespace(
        geometry=SimpleNamespace(model="cup"),
        partition=SimpleNamespace(layouts={FLEXIBLE_SPLINE: None}),
    )

    def found(narrow: dict[tuple[int, bool], list[int]]) -> dict[bool, list[float]]:
        places = list(narrow)
        of = root_stress._solve(cast(Any, model), cast(Any, None), places, 2, narrow=narrow)
        return {ends: [one.value for one in stresses] for (_, ends), stresses in of.items()}

    both = {True: [1088.0, 1080.0], False: [1073.0, 1025.0]}
    assert found({(2, False): [2], (2, True): [3]}) == both
    # after the window before, the ends had too little to be followed
    assert found({(2, False): [2]}) == {True: [1088.0], False: [1073.0]}
