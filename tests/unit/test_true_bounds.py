"""Bounds that refusals print are those from which on values are refused; scripts/bench/faults has
all keys."""

from __future__ import annotations

import re

import pytest

from support.paths import DRIVERS
from support.right_files import newer_sections
from support.true_bounds import bounds, verdict
from swgpar import load_design
from swgpar.errors import InputError

SECTIONS = {
    "ratcheting": (),
    "output_bearing": ("output_bearing.radial", "output_bearing.tilting"),
    "gear train, planetary_stage": ("errors.sun_ecc", "planet.clearance", "mesh.", "teeth."),
    "gear train, ring 2": ("ring.",),
}


@pytest.mark.parametrize("name", SECTIONS)
def test_bounds_of_newer_sections(name: str) -> None:
    section = newer_sections()[name]
    found = list(bounds(section.table, SECTIONS[name] or section.keys))
    assert len(found) >= 4 and any(bound.verdict == "true" for bound in found)
    wrong = [bound for bound in found if bound.verdict in ("other number", "no number")]
    assert not wrong, wrong


@pytest.mark.parametrize(
    ("key", "refused", "bound"),
    [
        ("flexible_spline.rim", 56.0, r"up to (\S+) mm, a strain"),
        ("wave_generator.C", 0.3, r"allowed (\S+) and more"),
    ],
)
def test_bounds_that_depend_on_other_keys(key: str, refused: float, bound: str) -> None:
    """The printed bound is accepted to its digits, and a value a little beyond is not."""
    design = DRIVERS / "plane_half_turn.toml"
    with pytest.raises(InputError) as refusal:
        load_design(design, {key: refused})
    found = re.search(bound, str(refusal.value))
    assert found, refusal.value
    away = 1e-3 if refused > float(found[1]) else -1e-3
    load_design(design, {key: float(found[1]) * (1.0 - away)})
    with pytest.raises(InputError, match=re.escape(key)):
        load_design(design, {key: float(found[1]) * (1.0 + away)})


def test_verdicts() -> None:
    sentence = "a.b = 3 is out of range: allowed 0 to {} mm"
    assert verdict("a.b", 2.0, 2.00001, sentence.format(2)) == "true"
    assert verdict("a.b", 2.0, 2.00001, sentence.format(3)) == "other number"
    assert verdict("a.c", 2.0, 2.00001, sentence.format(2)) == "other key"
    assert verdict("a.b", 2.0, 2.1, "a.b = 3 is out of range: allowed small values") == "no number"
    assert verdict("a.b", 2, 3, "a.b = 3 is out of range: allowed divisors of 4") == "condition"
