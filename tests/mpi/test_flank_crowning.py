"""Crowning of the flanks of any gear."""

from __future__ import annotations

import numpy as np
import pytest

from support.paths import DATA
from support.stepping import loaded, small
from swgpar.api import load_design
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.flank_pressure.pair_contact import FACE_END, PairContact, pair_contacts

AMOUNT = 0.004
"""mm, at the ends of the face width."""


def contacts(design: DriveDesign) -> list[PairContact]:
    """Contacts of the loaded drive."""
    stepper, _ = loaded(design)
    return pair_contacts(stepper.model, stepper.load_state)


def test_either_gear_of_a_cup_may_have_it() -> None:
    """Contact knows the sum of both; the teeth differ by the microns that are taken from them."""
    found = [
        contacts(
            small("cup", "micro_geometry.fs_crowning=0", f"micro_geometry.{key}_crowning={AMOUNT}")
        )
        for key in ("fs", "rg")
    ]
    assert len(found[0]) == len(found[1]) > 0
    for on_spline, on_ring in zip(*found, strict=True):
        assert on_ring.key == on_spline.key
        for name in ("force_N", "pressure_MPa", "z_mm"):
            value, other = getattr(on_ring, name), getattr(on_spline, name)
            assert value == pytest.approx(other, rel=3e-3, abs=1e-3), name
    without = contacts(small("cup", "micro_geometry.fs_crowning=0"))
    largest = [max(np.nan_to_num([one.pressure_MPa for one in each])) for each in found]
    assert max(np.nan_to_num([one.pressure_MPa for one in without])) < 0.95 * largest[0]


def test_it_takes_the_load_from_the_ends_of_the_ring_gears_of_a_pancake() -> None:
    design = load_design(DATA / "pancake.toml")
    at_ends = [one for one in contacts(design) if FACE_END in one.edge_place]
    assert at_ends
    keys = {f"micro_geometry.{gear}_crowning": 0.003 for gear in ("rg", "ds")}
    crowned = design.with_values(keys)
    assert not any(FACE_END in one.edge_place for one in contacts(crowned))
    ring, second = crowned.crowning("ring_gear"), crowned.crowning("dynamic_spline")
    assert ring.middle == pytest.approx(-1.625) and second.middle == pytest.approx(1.625)
    for crowning, gear in ((ring, "ring_gear"), (second, "dynamic_spline")):
        ends = np.array(crowned.axial_range(gear))
        assert crowning.removed(ends) == pytest.approx([0.003, 0.003])
        assert crowning.removed(ends.mean()) == 0.0
        assert crowning.removed(ends + [-1.0, 1.0]) == pytest.approx([0.003, 0.003])


@pytest.mark.parametrize(
    ("model", "key", "value", "said"),
    [
        ("cup", "rg_crowning", 1.0, "allowed 0 to .* mm .a quarter of the module"),
        ("cup", "ds_crowning", 0.001, "only 0 without a dynamic_spline"),
        ("plane", "rg_crowning", 0.001, "only 0 with drive.model"),
    ],
)
def test_refusals(model: str, key: str, value: float, said: str) -> None:
    with pytest.raises(InputError, match=said) as refused:
        small(model, f"micro_geometry.{key}={value}")
    assert f"micro_geometry.{key} = {value:g}" in str(refused.value)
