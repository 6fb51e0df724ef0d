"""Masses of bodies, and what [frequencies] refuses."""

from __future__ import annotations

import numpy as np
import pytest

from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar import load_design
from swgpar.errors import InputError
from swgpar.evaluation.frequencies import NaturalFrequencies, NaturalMode
from swgpar.fem.masses import sector_masses
from swgpar.meshing import build_sector_meshes, load_recipe
from swgpar.meshing.quality import hex_volumes
from swgpar.model.layouts import build_gear

ASKED = ("frequencies.number=3", "material.density=7850.0")


@pytest.mark.parametrize("model", ["cup", "plane"])
def test_the_nodes_have_the_mass_of_the_body(model: str) -> None:
    design = load_design(DESIGN, [*(PLANE if model == "plane" else ()), *ASKED])
    mesh = build_sector_meshes(design.geometry, load_recipe(RECIPE))["flexible_spline"]
    body = build_gear(mesh, design.materials, design.drive.face_width)
    found = sector_masses(body).sum()
    if model == "cup":
        volume = hex_volumes(mesh.coords, mesh.elements).sum()
    else:
        x, y = np.moveaxis(mesh.coords[mesh.elements][..., :2], -1, 0)
        area = 0.5 * np.abs(np.sum(x * np.roll(y, -1, 1) - np.roll(x, -1, 1) * y, axis=1))
        volume = area.sum() * design.drive.face_width
    assert found == pytest.approx(7850e-12 * volume, rel=2e-3)


@pytest.mark.parametrize(
    "change, words",
    [
        ("contact.friction=0.1", "contact.friction = 0.1 is out of range: allowed only 0"),
        ("load.torque=0", "load.torque = 0 is out of range: allowed above"),
        ("stiffness.torque=0.2", r"\[frequencies\] is not available with"),
        ("frequencies.number=0", "frequencies.number = 0 is out of range: allowed 1 to 50"),
        ("ring_gear.material={E=70e3, nu=0.33}", "the density of ring_gear is missing"),
    ],
)
def test_what_has_no_frequencies(change: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        load_design(DESIGN, [*ASKED, change])


def test_all_of_the_drive_is_modelled() -> None:
    design = load_design(DESIGN, ASKED)
    assert design.copies == 1
    assert not design.condenses_teeth
    assert not design.leaves_out_sectors


def test_answers_say_what_moves() -> None:
    modes = [
        NaturalMode(100.0, {"flexible_spline": 0.2, "ring_gear": 0.001, "output": 0.799}, 3),
        NaturalMode(900.0, {"flexible_spline": 0.9, "ring_gear": 0.1}, 1),
    ]
    first, second = NaturalFrequencies(modes=modes).answers()
    assert (first.name, first.value, first.unit) == ("frequency.1", 100.0, "Hz")
    assert first.remark == "kinetic energy: output 80%, flexible spline 20%"
    assert second.remark == "kinetic energy: flexible spline 90%, ring gear 10%; 1 wave around"
    kinds = NaturalFrequencies.kinds(load_design(DESIGN, ASKED))
    assert [kind.name for kind in kinds] == ["frequency.1", "frequency.2", "frequency.3"]
