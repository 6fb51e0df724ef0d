"""Splines in place of curves that cost much to evaluate."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import swgpar
from support.paths import DATA
from swgpar.geometry.arrays import Floats
from swgpar.profiles.curved_segment import CurvedSegment, CurvePoints, points_of
from swgpar.profiles.fitted_curve import CLOSE, TURNED, fitted

T = np.linspace(0.0, 1.0, 1234)


def wave(t: Floats) -> CurvePoints:
    """A curve whose tangent turns by more than half a turn, past that of angle pi."""
    return points_of(
        t + 0.3j * np.cos(9.0 * t) - 1.2 * t**2,
        1.0 - 2.7j * np.sin(9.0 * t) - 2.4 * t,
        -24.3j * np.cos(9.0 * t) - 2.4,
    )


def unwrapped(t: Floats) -> CurvePoints:
    """The same with angles that do not jump by a turn."""
    curve, middle = wave(t), wave(np.array([0.5])).angle
    angle = middle + np.angle(np.exp(1j * (curve.angle - middle)))
    return CurvePoints(curve.point, angle, curve.speed, curve.angle_rate)


def bent(t: Floats) -> CurvePoints:
    """A curve with a curvature without bound at one of its points."""
    x = t - 0.37
    size = np.sqrt(np.abs(x) + 1e-12)
    return points_of(t + 1j * size**3, 1.0 + 1.5j * np.sign(x) * size, 0.75j / size)


def test_a_spline_has_the_points_tangents_and_curvatures_of_its_curve() -> None:
    curve = CurvedSegment("wave", unwrapped)
    spline = fitted(curve)
    assert spline is not curve and spline.name == "wave"
    exact, found = curve.evaluate(T), spline.evaluate(T)
    assert np.abs(found.point - exact.point).max() < CLOSE * curve.length
    assert np.abs(found.angle - exact.angle).max() < 2.0 * TURNED
    assert found.speed == pytest.approx(exact.speed, rel=1e-8)
    assert np.abs(found.angle_rate - exact.angle_rate).max() < 1e-6
    assert spline.length == pytest.approx(curve.length, rel=1e-10)
    points = exact.point + [0.02, -0.01]
    assert spline.nearest(points).place == pytest.approx(curve.nearest(points).place, abs=1e-9)


def test_a_curve_with_a_sharp_bend_stays_as_it_is() -> None:
    curve = CurvedSegment("bent", bent)
    assert fitted(curve) is curve


def test_a_curve_that_ends_at_its_end_stays_as_it_is() -> None:
    def ends(t: Floats) -> CurvePoints:
        with np.errstate(invalid="ignore"):
            x = np.sqrt(1.0 - t)
        return points_of(x + 0j, 0.0 * x + 1.0, 0.0 * x + 0j)

    curve = CurvedSegment("ends", ends)
    assert fitted(curve) is curve


BUILT = sorted(
    path
    for path in (DATA / "public").glob("*.toml")
    if "_fail_" not in path.stem or path.stem.endswith("undercut_envelope")
)


@pytest.mark.parametrize("path", BUILT, ids=lambda path: path.stem)
def test_flanks_of_public_designs_join(path: Path) -> None:
    """Splines of short pieces of an envelope had tangents that were off by 1.4e-9 rad, so that one
    of these drives was refused."""
    assert len(BUILT) == 14
    assert len(swgpar.load_design(path).geometry.gears) >= 2
