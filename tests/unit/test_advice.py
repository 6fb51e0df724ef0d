"""Refusals of profiles name a length, a direction, a range that passes and a value that works."""

from __future__ import annotations

import re
from typing import Any

import pytest

import swgpar
from support.paths import DESIGN
from swgpar.errors import InputError

DOUBLE_ARC = {"type": "double_arc", "r_addendum": 1.0}
GEARS = ("flexible_spline", "ring_gear")
CASES: list[dict[str, Any]] = [
    {"flexible_spline.profile.r_tip": 3.0},
    {"flexible_spline.profile.r_root": 40.0},
    {"ring_gear.profile.r_root": 5.0},
    {"ring_gear.profile.straight_l": 3.0},
    {f"{gear}.profile": {**DOUBLE_ARC, "r_dedendum": 0.8} for gear in GEARS},
    {"flexible_spline.profile": {"type": "involute", "cutter_radius": 0.9}},
]
SENTENCE = re.compile(
    r"make (?P<key>\S+) (?P<way>larger|smaller): allowed (?P<low>\S+) to (?P<high>\S+) mm "
    r".*example (?P<x>\S+)"
)


def refusal(values: dict[str, Any]) -> re.Match[str]:
    with pytest.raises(InputError) as refused:
        swgpar.load_design(DESIGN, values)
    found = SENTENCE.search(str(refused.value))
    assert found, str(refused.value)
    return found


@pytest.mark.parametrize("values", CASES, ids=lambda values: ", ".join(values))
def test_the_range_that_is_named_passes(values: dict[str, Any]) -> None:
    found = refusal(values)
    key = found["key"]
    gear, _, name = key.partition(".profile.")

    def passes(value: float) -> bool:
        profile = swgpar.load_design(DESIGN).model_dump()[gear]["profile"] | values.get(
            f"{gear}.profile", {}
        )
        given = {k: v for k, v in values.items() if not k.startswith(f"{gear}.profile")}
        own = {
            k.rpartition(".")[2]: v for k, v in values.items() if k.startswith(f"{gear}.profile.")
        }
        profile = values.get(f"{gear}.profile", profile) | own | {name: value}
        try:
            swgpar.load_design(DESIGN, {**given, f"{gear}.profile": profile})
        except InputError as error:
            return not str(error).startswith(gear)  # the other gear may have its own refusal
        return True

    low, high, example = (float(found[name]) for name in ("low", "high", "x"))
    assert low <= example <= high
    assert passes(low) and passes(high) and passes(example)
    near = low if found["way"] == "larger" else high  # the end towards the refused value is exact
    assert not passes(near * (0.97 if found["way"] == "larger" else 1.03))


def test_radii_that_fit_together_where_no_single_one_helps() -> None:
    values = {"flexible_spline.profile.r_tip": 5.0, "flexible_spline.profile.r_root": 7.0}
    with pytest.raises(
        InputError, match="several keys of flexible_spline.profile do not fit"
    ) as refused:
        swgpar.load_design(DESIGN, values)
    pairs = re.findall(r"(\w+) = ([\d.]+)", str(refused.value).partition("example")[2])
    found = {f"flexible_spline.profile.{key}": float(value) for key, value in pairs}
    assert swgpar.load_design(DESIGN, {**values, **found})
