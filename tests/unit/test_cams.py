"""The cam's surface: distance, gradient and Hessian."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from swgpar.cams import EllipticalCam
from swgpar.design import load_design
from swgpar.micro_geometry import WaveGeneratorSurface, crowning

DRIVERS = Path(__file__).parents[2] / "drivers"


def test_distance_against_a_dense_search() -> None:
    cam = EllipticalCam(59.2, 57.2)
    rng = np.random.default_rng(1)
    angle, radius = rng.uniform(0, 2 * np.pi, 40), rng.uniform(56.0, 61.0, 40)
    points = np.column_stack([radius * np.sin(angle), radius * np.cos(angle)])
    distance, normal, _ = cam.evaluate(points)
    for p, d, n in zip(points, distance, normal):
        t = np.linspace(0, 2 * np.pi, 20001)
        for _ in range(4):  # refine around the nearest sample
            away = np.hypot(57.2 * np.sin(t) - p[0], 59.2 * np.cos(t) - p[1])
            best = t[away.argmin()]
            width = 2.0 * (t[1] - t[0])
            t = np.linspace(best - width, best + width, 2001)
        assert abs(d) == pytest.approx(away.min(), abs=1e-9)
        assert np.sign(d) == np.sign((p[0] / 57.2) ** 2 + (p[1] / 59.2) ** 2 - 1.0)
        foot = p - d * n
        assert (foot[0] / 57.2) ** 2 + (foot[1] / 59.2) ** 2 == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("shape", ["parabolic", "circular"])
def test_derivatives_of_the_modified_surface(shape: str) -> None:
    design = load_design(DRIVERS / "cup_45deg.toml", [f"micro_geometry.crowning_shape={shape}"])
    surface = WaveGeneratorSurface(design)
    rng = np.random.default_rng(2)
    angle, radius = rng.uniform(0, 2 * np.pi, 50), rng.uniform(57.0, 60.0, 50)
    x = np.column_stack([radius * np.sin(angle), radius * np.cos(angle), rng.uniform(-5, 5, 50)])
    _, gradient, hessian = surface.evaluate(x)
    h = 1e-5
    for k in range(3):
        step = np.zeros(3)
        step[k] = h
        up, down = surface.evaluate(x + step), surface.evaluate(x - step)
        assert np.allclose((up[0] - down[0]) / (2 * h), gradient[:, k], atol=1e-8)
        assert np.allclose((up[1] - down[1]) / (2 * h), hessian[:, :, k], atol=1e-7)


def test_slope_raises_the_open_end_at_the_major_axis() -> None:
    surface = WaveGeneratorSurface(load_design(DRIVERS / "cup_45deg.toml", ["micro_geometry.wg_crowning=0"]))
    open_end, closed_end = surface.evaluate(np.array([[0.0, 59.2, -5.0], [0.0, 59.2, 5.0]]))[0]
    assert open_end == pytest.approx(-0.09) and closed_end == pytest.approx(0.09)


@pytest.mark.parametrize("shape", ["parabolic", "circular"])
def test_crowning_is_the_amount_at_the_edges_and_nothing_in_the_middle(shape: str) -> None:
    value, slope, _ = crowning(0.1, np.array([-5.0, 0.0, 5.0]), 10.0, shape)
    assert value == pytest.approx([0.1, 0.0, 0.1], abs=1e-12)
    assert slope[0] == -slope[2] and slope[1] == 0.0
