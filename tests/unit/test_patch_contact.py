"""Contact of half spaces over a patch: Hertz's ellipse wherever the force acts, ends of the
bodies."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from swgpar.flank_pressure.patch_contact import Gap, patch_contact
from swgpar.materials import Isotropic, contact_modulus

E = contact_modulus(*[Isotropic(E=210e3, nu=0.29)] * 2, plane_stress=False)
ENDS = -5.0, 5.0


def parabola(short: float, long: float, place: float) -> Gap:
    """Gap with these radii (mm) across and along, least at z = place."""
    return lambda s, z: (s - 1.0) ** 2 / (2.0 * short) + (z - place) ** 2 / (2.0 * long)


def hertz(force: float, short: float, long: float) -> tuple[float, float, float]:
    """Half length and half width (mm) and largest pressure (MPa) of Hertz's ellipse (Johnson,
    section 4.2)."""

    def ratio(k: float) -> float:
        m = 1.0 - k**2
        return (ellipe(m) / k**2 - ellipk(m)) / (ellipk(m) - ellipe(m)) - long / short

    k = brentq(ratio, 1e-4, 0.9999)
    m = 1.0 - k**2
    half_length = (3.0 * force * (ellipk(m) - ellipe(m)) * long / (np.pi * E * m)) ** (1.0 / 3.0)
    return half_length, k * half_length, 1.5 * force / (np.pi * k * half_length**2)


@pytest.mark.parametrize(("short", "long"), [(1.0, 278.0), (0.5, 5.0), (1.0, 2.0)])
@pytest.mark.parametrize(("force", "place"), [(123.0, 0.0), (20.0, -3.0)])
@pytest.mark.parametrize("width", [0.05, 1.0])
def test_hertz(short: float, long: float, force: float, place: float, width: float) -> None:
    """The width that is looked at first does not matter."""
    found = patch_contact(
        parabola(short, long, place), np.ones_like, ENDS, width, force=force, place=place, modulus=E
    )
    half_length, half_width, peak = hertz(force, short, long)
    cell = found.z[1] - found.z[0]
    assert found.pressure.max() == pytest.approx(peak, rel=0.015)
    assert found.half_width.max() == pytest.approx(half_width, rel=0.05)
    assert 0.5 * len(found.z) * cell == pytest.approx(half_length, abs=cell)
    assert found.line_load.sum() * cell == pytest.approx(force, rel=1e-9)
    assert (found.line_load @ found.z) * cell == pytest.approx(force * place, abs=1e-6 * force)
    assert not found.at_end and not found.reaches


@pytest.mark.parametrize(("offset", "slope"), [(0.03, 0.0), (0.0, 0.02), (-0.1, 0.05)])
def test_a_line_of_the_least_gap_beside_the_contact_does_not_matter(
    offset: float, slope: float
) -> None:
    """The line that is handed over is only where the contact is looked for."""
    found = patch_contact(
        parabola(1.0, 278.0, 0.0),
        lambda z: 1.0 + offset + slope * z,
        ENDS,
        0.05,
        force=20.0,
        place=0.0,
        modulus=E,
    )
    half_length, half_width, peak = hertz(20.0, 1.0, 278.0)
    assert found.pressure.max() == pytest.approx(peak, rel=0.015)
    assert found.half_width.max() == pytest.approx(half_width, rel=0.05)
    assert 0.5 * len(found.z) * (found.z[1] - found.z[0]) == pytest.approx(
        half_length, abs=found.z[1] - found.z[0]
    )
    assert found.middle == pytest.approx(1.0, abs=0.1 * half_width)


def test_a_tilt_of_the_bodies_does_not_matter() -> None:
    """The force and its place are given: the bodies turn until the gap is least there."""
    results = [
        patch_contact(
            lambda s, z, tilt=tilt: parabola(1.0, 278.0, 0.0)(s, z) + tilt * z,
            np.ones_like,
            ENDS,
            0.05,
            force=100.0,
            place=1.0,
            modulus=E,
        )
        for tilt in (0.0, 1e-3)
    ]
    assert results[0].pressure.max() == pytest.approx(results[1].pressure.max(), rel=1e-6)


def test_a_short_body_has_its_largest_pressure_at_its_end() -> None:
    found = patch_contact(
        parabola(1.0, 1e5, 0.0), np.ones_like, ENDS, 0.05, force=500.0, place=0.0, modulus=E
    )
    assert found.reaches
    assert found.pressure[0] > found.pressure[len(found.z) // 2]


def test_a_body_that_ends_across() -> None:
    def gap(s: np.ndarray, z: np.ndarray) -> np.ndarray:
        return np.where(s > 0.99, parabola(1.0, 278.0, 0.0)(s, z), np.inf)

    found = patch_contact(gap, np.ones_like, ENDS, 0.05, force=123.0, place=0.0, modulus=E)
    assert found.at_end


def test_no_contact_is_said() -> None:
    with pytest.raises(ArithmeticError, match="no contact was found for a force of 1 N"):
        patch_contact(
            lambda s, z: np.full_like(s * z, np.inf),
            np.ones_like,
            ENDS,
            0.05,
            force=1.0,
            place=0.0,
            modulus=E,
        )
