"""The table of combinations says what the program accepts, for every pair."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from typing import Any

import pytest

import swgpar
from support.cup_shapes import bolted
from support.paths import DESIGN
from swgpar.api.ratings import load_rated_design
from swgpar.errors import InputError
from swgpar.rating.planned_runs import plan_runs

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "combinations.md"

RACE = "wave_generator.bearing"
FEATURES: dict[str, dict[str, Any]] = {
    "bearing": {
        f"{RACE}.balls": 12,
        f"{RACE}.ball_diameter": 2.5,
        f"{RACE}.race_thickness": 1.0,
        "wave_generator.face_width": 4.0,
    },
    "slope": {"micro_geometry.wg_slope": 0.02},
    "windows": {"output.root_stress": True},
    "bolts": {f"cup.{key}": value for key, value in bolted(8).items()},
    "friction": {"contact.friction": 0.1},
    "fatigue": {"fatigue.size_factor": 1.0},
    "stiffness": {"stiffness.positions": 1},
    "deviations": {"deviations.ring_gear.eccentricity": 0.01},
    "ratcheting": {"ratcheting.limit": 0.2},
    "period": {"steps.samples": 6, "steps.rotation": 100.0},
}
"""Overrides of the small cup drive that give a feature. Six angles are enough for eight bolts."""

WITHOUT = {"micro_geometry.wg_slope": 0.0}
RATED = {"rating.rated_torque": 1.0, "rating.momentary_torque": 1.0}


def table() -> dict[frozenset[str], str]:
    """What the page says of every pair."""
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    begin = next(k for k, line in enumerate(lines) if line.startswith("| | "))
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[begin:]]
    head, found = cells[0][1:], {}
    for row in cells[2 : 1 + len(FEATURES)]:
        for name, cell in zip(head, row[1:], strict=True):
            if cell:
                found[frozenset((row[0], name))] = cell
    return found


def test_every_pair_stands_in_the_table() -> None:
    assert set(table()) == {frozenset(pair) for pair in combinations(FEATURES, 2)}


@pytest.mark.parametrize("pair", [*combinations(FEATURES, 2)], ids="+".join)
def test_the_program_does_what_the_table_says(pair: tuple[str, str]) -> None:
    said = table()[frozenset(pair)]
    keys = WITHOUT | FEATURES[pair[0]] | FEATURES[pair[1]]
    if said == "yes":
        swgpar.load_design(DESIGN, keys)
        return
    with pytest.raises(InputError) as refused:
        swgpar.load_design(DESIGN, keys)
    assert ("swgpar rate has a run for each" in str(refused.value)) == (said == "rate")
    if said == "rate":
        runs = plan_runs(load_rated_design(DESIGN, keys | RATED)).runs
        assert all(run.design is not None and not run.left_out for run in runs)
