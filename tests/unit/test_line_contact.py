"""Line contact of half planes: Hertz's formulas, any start, gaps whose curvature jumps, bodies that
end."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from support.line_contact import line_contact
from swgpar.materials import Isotropic, contact_modulus

E = contact_modulus(*[Isotropic(E=210e3, nu=0.29)] * 2, plane_stress=False)


def parabola(radius: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda x: x**2 / (2.0 * radius)


def hertz(radius: float, load: float) -> tuple[float, float]:
    """Half width (mm) and largest pressure (MPa) of Hertz's line contact."""
    half_width = float(np.sqrt(4.0 * load * radius / (np.pi * E)))
    return half_width, 2.0 * load / (np.pi * half_width)


def test_moduli() -> None:
    assert contact_modulus(*[Isotropic(E=2.0, nu=0.3)] * 2, plane_stress=True) == 1.0
    assert contact_modulus(*[Isotropic(E=2.0, nu=0.3)] * 2, plane_stress=False) == pytest.approx(
        1.0 / 0.91
    )


@pytest.mark.parametrize("radius", [0.5, 20.0])
@pytest.mark.parametrize("load", [1.0, 75.0])
@pytest.mark.parametrize("start", [0.0, 0.03, -0.4])
def test_hertz(radius: float, load: float, start: float) -> None:
    """The start lies in the contact, or far beside it."""
    found = line_contact(parabola(radius), start, 0.05, load, E)
    half_width, peak = hertz(radius, load)
    assert found.peak == pytest.approx(peak, rel=2e-3)
    assert found.half_width == pytest.approx(half_width, rel=0.01)
    assert found.middle == pytest.approx(0.0, abs=0.01 * half_width)
    # Johnson, Contact Mechanics, section 4.2: 0.30 p0 at a depth of 0.78 half widths
    assert found.largest_shear() == pytest.approx(0.300 * peak, rel=4e-3)
    assert not found.at_end
    size = found.x[1] - found.x[0]
    assert found.pressure.sum() * size == pytest.approx(load, rel=1e-9)


def test_a_jump_of_the_curvature_lies_between_both_parabolas() -> None:
    def gap(x: np.ndarray) -> np.ndarray:
        return np.where(x > 0.0, parabola(0.5)(x), parabola(2.0)(x))

    found = line_contact(gap, 0.0, 0.05, 40.0, E)
    assert 1.15 * hertz(2.0, 40.0)[1] < found.peak < 0.85 * hertz(0.5, 40.0)[1]
    assert (
        found.middle < -0.1 * found.half_width
    )  # the contact reaches farther where the gap is flat


def test_a_body_that_ends_has_its_largest_pressure_there() -> None:
    half_width, peak = hertz(0.5, 40.0)

    def gap(x: np.ndarray) -> np.ndarray:
        return np.where(x >= -0.2 * half_width, parabola(0.5)(x), np.inf)

    found = line_contact(gap, 0.0, 0.05, 40.0, E)
    assert found.middle - found.half_width == pytest.approx(-0.2 * half_width, abs=0.1 * half_width)
    assert found.pressure.argmax() == np.flatnonzero(found.pressure > 0.0)[0]
    assert found.peak > 1.5 * peak and found.at_end
