"""Contacts of S-shaped teeth with a conjugate ring gear, whose flanks nearly conform."""

from __future__ import annotations

import pytest

import swgpar
from swgpar.drive_results.summary import DriveSummary
from swgpar.meshing import load_recipe
from swgpar.meshing.recipe import make_recipe


def loaded(along_flanks: int) -> DriveSummary:
    """The plane start of ratio 50 under load. along_flanks : elements"""
    design = swgpar.new(ratio=50, diameter=64.0, torque=10.0, model="plane").with_values(
        {"steps.rotation": 0.0, "output.root_stress": False, "fatigue": None, "rating": None}
    )
    content = load_recipe("plane_coarse").model_dump(exclude_none=True)
    for gear in ("flexible_spline", "ring_gear"):
        content[gear]["flank"] = along_flanks
    return swgpar.run(design, make_recipe(content), progress=False).summary


def test_elements_along_the_flanks_do_not_decide_about_forces_and_pressures() -> None:
    """With cubics between the nodes of the ring gear six elements give a largest force that is a
    quarter too large."""
    usual, fine = loaded(6), loaded(14)
    for name, share in (("sharing.largest_force", 0.02), ("contact.pressure", 0.02)):
        assert usual[name].value == pytest.approx(fine[name].value, rel=share)
