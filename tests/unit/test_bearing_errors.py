"""Errors of the loads of balls by a coarser mesh and by the increments."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from support.bearing import BEARING
from support.paths import DESIGN
from support.small_drive import PLANE
from swgpar import load_design
from swgpar.analysis.bearing_errors import LEAST, NOT_SHOWN, bearing_errors
from swgpar.analysis.drive_mesh_error import (
    ORDER,
    SAFETY,
    CoarserMesh,
    smallest_ratio,
)
from swgpar.answers.answer import NO_ESTIMATE
from swgpar.evaluation.bearing_loads import BallLoads, evaluate_bearing
from swgpar.evaluation.contact_error_shares import MISSED
from swgpar.meshing import load_recipe
from swgpar.meshing.recipe_counts import coarsened
from swgpar.results.history import Row

FINE = load_recipe("plane_coarse")
COARSE = coarsened(FINE)
BALLS = 20


def rows(increment: int, load: float) -> list[Row]:
    """Of balls.csv: every tenth ball has the load, N."""
    one = {"increment": increment, "wg_angle_deg": 2.0 * increment, "cam_angle_deg": 0.0}
    return [
        {
            **one,
            "load_N": here,
            "approach_um": here ** (2.0 / 3.0),
            "inner_pressure_MPa": 100.0 * here ** (1.0 / 3.0),
            "outer_pressure_MPa": 90.0 * here ** (1.0 / 3.0),
        }
        for ball in range(BALLS)
        for here in [0.0 if ball % 10 else load]
    ]


def bearing(loads: Sequence[float], shares: dict[str, float] | None = None) -> BallLoads:
    """Of increments in which the largest load of a ball is one of these, N."""
    every = [row for k, load in enumerate(loads, start=1) for row in rows(k, load)]
    increments = range(1, len(loads) + 1)
    design = load_design(DESIGN, [*PLANE, *BEARING])
    race = {"race_s1": 5.0 * max(loads), "race_vm": 6.0 * max(loads)}
    return evaluate_bearing(design, every, increments, {}, race, shares or {})


def test_a_coarser_mesh_shows_the_errors() -> None:
    coarser = CoarserMesh(COARSE, {}, bearing=bearing([27.0]))
    found = bearing_errors(coarser, FINE, bearing([30.0]))
    factor = SAFETY / (smallest_ratio(COARSE, FINE) ** ORDER - 1.0)
    assert found["bearing.largest_load"] == pytest.approx(factor * 3.0 / 30.0)
    # of the power 1/3 of the load, and of its power -3
    pressure = factor * (1.0 - 0.9 ** (1.0 / 3.0))
    assert found["bearing.pressure"] == pytest.approx(pressure)
    assert found["bearing.life_turns"] == pytest.approx(factor * (0.9**-3.0 - 1.0))
    assert found["bearing.race_s1"] == pytest.approx(factor * 0.1)
    assert found.keys().isdisjoint(kind.name for kind in NOT_SHOWN)
    # one increment has no range
    assert "bearing.load_ripple" not in found and "bearing.load_rating" not in found
    same = bearing_errors(CoarserMesh(COARSE, {}, bearing=bearing([30.0])), FINE, bearing([30.0]))
    assert set(same.values()) == {LEAST}


def test_without_a_bearing_on_the_coarser_mesh_no_error_is_known() -> None:
    assert bearing_errors(CoarserMesh(COARSE, {}), FINE, bearing([30.0])) == {}
    assert bearing_errors(None, FINE, bearing([30.0])) == {}
    answers = {one.name: one for one in bearing([30.0]).answers()}
    assert answers["bearing.largest_load"].no_error == NO_ESTIMATE


def test_increments_may_miss_the_largest_load() -> None:
    found = bearing([20.0, 30.0, 25.0], {"bearing.largest_load": 0.03, "bearing.mean_load": 0.02})
    answers = {one.name: one for one in found.answers()}
    error = 0.03 * 30.0 + MISSED * (30.0 - 25.0)
    assert answers["bearing.largest_load"].error == pytest.approx(error)
    mean = answers["bearing.mean_load"]
    assert mean.error == pytest.approx(0.02 * mean.value) and mean.no_error == ""
    assert answers["bearing.pressure"].no_error == NO_ESTIMATE
