"""The ring between two supports (Appendix A of the source) against closed forms, and in the plane
against the solid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from plain_ring import PlainRingDesign, RingCounts
from support.paths import DRIVERS
from support.scripts import load_script

EXPERIMENT = load_script(DRIVERS / "ring_experiment.py")
OUTER_DIAMETER, THICKNESS, OUTWARD = (
    EXPERIMENT.OUTER_DIAMETER,
    EXPERIMENT.THICKNESS,
    EXPERIMENT.OUTWARD,
)
STEEL, closed_form, press = EXPERIMENT.STEEL, EXPERIMENT.closed_form, EXPERIMENT.press

PLANE = PlainRingDesign(OUTER_DIAMETER, THICKNESS, 10.0, True, STEEL)
SMALL = np.array([1e-3])  # the ratio at 90 degrees grows by 0.014 per mm of travel


def ratios(thickness: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Inward over outward deflection at 45 and at 90 degrees: computed, thin, with shear; and
    thickness over R."""
    found = press(replace(PLANE, thickness=thickness), RingCounts(240, 4, 1), SMALL)
    slenderness = thickness / (0.5 * (OUTER_DIAMETER - thickness))
    forms = [
        np.array(
            [
                -closed_form(x, *shear) / closed_form(0.0, *shear)
                for x in (0.25 * np.pi, 0.5 * np.pi)
            ]
        )
        for shear in ((), (slenderness, STEEL.nu))
    ]
    return np.array([found["centre"][0], found["minor"][0]]) / found["top"][0], *forms, slenderness


def test_series_without_shear_is_the_closed_form() -> None:
    """Known values: diameters change by (pi/4 - 2/pi) and (2/pi - 1/2) P R^3 / EI."""
    assert closed_form(0.0) == pytest.approx(0.5 * (np.pi / 4.0 - 2.0 / np.pi), rel=1e-12)
    assert closed_form(0.5 * np.pi) == pytest.approx(-0.5 * (2.0 / np.pi - 0.5), rel=1e-12)
    n = np.arange(2.0, 2001.0, 2.0)
    series = 2.0 / np.pi * np.sum(np.cos(0.25 * np.pi * n) / (n**2 - 1.0) ** 2)
    assert closed_form(0.25 * np.pi) == pytest.approx(series, abs=1e-9)


def test_small_deflection_against_the_thin_ring() -> None:
    """Shear and extension are of the order of (t / R)^2 of the bending, so is the deviation from
    the thin ring."""
    deviations = []
    for thickness in (THICKNESS, 0.5 * THICKNESS):
        found, thin, shear, slenderness = ratios(thickness)
        deviations.append(np.abs(found - thin))
        assert (deviations[-1] < 1.5 * slenderness**2).all(), (found, thin)
        # what is left is local: under the force P per width the section is squeezed by some P / E,
        # (t / R)^3 of the deflection, with a logarithm of the mesh; shear and extension themselves
        # are 1.1 (t / R)^2 at 90 degrees
        assert (np.abs(found - shear) < 0.25 * slenderness**2).all(), (found, shear)
        print(f"t / R = {slenderness:.4f}: computed {found}, thin {thin}, with shear {shear}")
    assert (deviations[0] > 3.0 * deviations[1]).all()


def test_plane_equals_solid() -> None:
    """Displacements do not depend on the state across the width: plane stress and a 10 mm wide
    solid agree."""
    travels = OUTWARD[[0, -1]]
    plane = press(PLANE, RingCounts(60, 1, 2), travels)
    solid = press(replace(PLANE, plane=False), RingCounts(60, 1, 2), travels)
    for name in ("moving", "minor"):
        assert solid[name] == pytest.approx(plane[name], rel=1e-3), name  # 5e-4 is reached
    # a dial that moves by a along the major axis leaves the ring by a cos 45 degrees
    assert plane["moving"] - plane["centre"] == pytest.approx(travels * np.sqrt(0.5), rel=0.02)
