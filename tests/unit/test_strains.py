"""Strains before and after a run: the limit, and what is said of the law."""

from __future__ import annotations

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN
from support.small_drive import PLANE
from swgpar.checks.remarks import remarks
from swgpar.checks.strain_checks import (
    LARGEST_NOMINAL,
    LARGEST_STRAIN,
    deflection_strain,
    torque_strain,
)
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError
from swgpar.evaluation.strains import largest_strains
from swgpar.largest_stress.places import Place
from swgpar.materials import Isotropic


def design(*overrides: str) -> DriveDesign:
    return swgpar.load_design(DESIGN, [*PLANE, *overrides])


def test_strain_by_the_cam_is_that_of_a_thin_ring() -> None:
    """A cam that bends the ring by w0 cos 2 theta: (t / 2) 3 w0 / r²."""
    found = design("wave_generator.type=harmonic", "wave_generator.deflection=0.1")
    rim, line = found.flexible_spline.rim, found.tooth_motion().line
    expected = 0.5 * rim * 3.0 * line.deflections[0] / line.radius**2
    assert deflection_strain(found) - line.stretch == pytest.approx(expected, rel=0.02)


def test_a_rim_that_the_cam_strains_too_much_is_refused() -> None:
    refusal = r"flexible_spline.rim = 12 .* allowed up to 11.28 mm, .* of up to 10 %"
    with pytest.raises(InputError, match=refusal):
        design("flexible_spline.rim=12")


def test_torques_are_limited_by_the_strain_of_rim_or_wall() -> None:
    per_torque, of = torque_strain(design())
    most = LARGEST_NOMINAL / per_torque
    assert of == "rim"
    sentences = remarks(design(f"load.torque={0.99 * most}"))
    assert any("strains the rim by 5 % (nominal)" in one for one in sentences)
    with pytest.raises(InputError, match=r"a nominal strain of the rim of 5 %"):
        design(f"load.torque={1.01 * most}")
    assert not any("strains the rim" in one for one in remarks(design()))


def place(value: float, warning: str = "") -> Place:
    return Place(value, "flexible_spline", "tooth root", 0, 10.0, 0.0, 0.0, warning, error=0.3)


@pytest.mark.parametrize(
    ("stress", "words"),
    [(0.2, None), (1.5, "5 %: laws with the same E and nu are up to 7.5 % apart"), (4.5, "15 %")],
)
def test_a_run_says_what_the_law_leaves_open(stress: float, words: str | None) -> None:
    materials = {"flexible_spline": Isotropic(E=30.0, nu=0.48)}
    found = largest_strains({"fs_vm_apart": place(stress)}, materials)
    assert found.fs == pytest.approx(100.0 * stress / 30.0) and found.rg is None
    sentences = list(found.remarks())
    assert (words is None) == (not sentences) and all(words in one for one in sentences)
    assert any("no results of a material" in one for one in sentences) == (found.fs > found.limit)
    (answer,) = found.answers()
    assert answer.error == pytest.approx(1.0) and answer.limit == 100.0 * LARGEST_STRAIN


def test_a_stress_without_a_limit_has_no_error() -> None:
    materials = {"flexible_spline": Isotropic(E=30.0, nu=0.48)}
    (answer,) = largest_strains({"fs_vm_apart": place(1.0, "an edge")}, materials).answers()
    assert answer.error is None and np.isfinite(answer.value)
