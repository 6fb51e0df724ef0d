"""Teeth of the ring gear that get a window."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from swgpar.fem.body import RING_GEAR
from swgpar.largest_stress import ring_gear_stress
from swgpar.largest_stress.local_problem import WindowStress
from swgpar.largest_stress.window_recipes import RING_LEVELS, window_recipe
from swgpar.load.load_states import LoadState
from swgpar.model.drive_model import DriveModel

NAMES = NAME, _ = "rg_s1 in tooth root", "rg_vm in tooth root"
TEETH = 12


class Layout:
    """What a place asks a layout for."""

    name = RING_GEAR
    mesh = SimpleNamespace(n_sectors=TEETH, plane=True)

    def sector_angle(self, tooth: np.ndarray) -> np.ndarray:
        return 2.0 * np.pi / TEETH * tooth


def windows(
    monkeypatch: pytest.MonkeyPatch, largest: dict[int, float], further: int | None = None
) -> list[tuple[int, int]]:
    """Let windows give these stresses (MPa), 1 MPa elsewhere, and nodal averages be largest in the
    root between the teeth 0 and 11, with 80 % of that at a further tooth; the teeth and levels of
    the windows, in their order."""
    solved: list[tuple[int, int]] = []
    levels = {window_recipe("plane", level): level for level in range(RING_LEVELS["plane"])}

    @contextmanager
    def solved_window(_: Any, __: Any, tooth: int, recipe: Any, *others: Any) -> Iterator[Any]:
        solved.append((tooth, levels[recipe]))
        value = largest.get(tooth, 1.0) + levels[recipe]
        found = WindowStress(value, tooth, np.zeros(3), "tooth root", "", 1)
        yield SimpleNamespace(by_region=lambda: {tooth: dict.fromkeys(NAMES, found)})

    nodal = np.full(TEETH, 5.0)
    nodal[[0, TEETH - 1]] = 9.0
    if further is not None:
        nodal[further] = 0.8 * 9.0
    monkeypatch.setattr(ring_gear_stress, "solved_window", solved_window)
    monkeypatch.setattr(ring_gear_stress, "nodal_averages", lambda *_: None)
    monkeypatch.setattr(ring_gear_stress, "nodal_by_sector", lambda *_: dict.fromkeys(NAMES, nodal))
    return solved


def model() -> DriveModel:
    geometry = SimpleNamespace(model="plane", module=0.5)
    partition = SimpleNamespace(layouts={RING_GEAR: Layout()})
    return cast(
        DriveModel,
        SimpleNamespace(geometry=geometry, partition=partition),
    )


def test_the_tooth_on_the_other_side_of_the_root_may_have_the_larger_stress(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The root has the same nodal average in both teeth."""
    solved = windows(monkeypatch, {0: 12.0, TEETH - 1: 16.0})
    found = ring_gear_stress.ring_gear_stresses(model(), cast(LoadState, None), RING_GEAR, 3, 0)[
        NAME
    ]
    assert solved == [(0, 0), (1, 0), (10, 0), (11, 0), (11, 1), (11, 2)]
    assert found.place.tooth == TEETH - 1 and found.levels == (16.0, 17.0, 18.0)


def test_windows_that_are_left_out_still_tell_the_tooth(monkeypatch: pytest.MonkeyPatch) -> None:
    solved = windows(monkeypatch, {0: 12.0, TEETH - 1: 16.0})
    found = ring_gear_stress.ring_gear_stresses(model(), cast(LoadState, None), RING_GEAR, 2, 1)[
        NAME
    ]
    assert solved == [(0, 0), (1, 0), (10, 0), (11, 0), (11, 1)]
    assert np.isnan(found.levels[0]) and found.levels[1:] == (17.0,)


def test_a_root_with_a_smaller_nodal_average_may_have_the_largest_stress(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """They lose much beside a contact near the root."""
    solved = windows(monkeypatch, {0: 12.0, 5: 16.0}, further=5)
    found = ring_gear_stress.ring_gear_stresses(model(), cast(LoadState, None), RING_GEAR, 3, 0)[
        NAME
    ]
    assert solved[-2:] == [(5, 1), (5, 2)] and {tooth for tooth, _ in solved} == {
        0,
        1,
        4,
        5,
        6,
        10,
        11,
    }
    assert found.place.tooth == 5 and found.place.value == 18.0


def test_a_tooth_that_has_nearly_as_much_is_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    solved = windows(monkeypatch, {0: 15.5, TEETH - 1: 16.0})
    ring_gear_stress.ring_gear_stresses(model(), cast(LoadState, None), RING_GEAR, 3, 0)
    assert solved[4:] == [(0, 1), (11, 1), (0, 2), (11, 2)]
