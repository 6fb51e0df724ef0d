"""Two discs beside each other along the axis, one for each lobe."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN, RECIPE
from swgpar.errors import InputError

DISCS = {"type": "two_roller", "face_width": 1.8, "r_2": 16.0, "distance": 2.2}


def design_on(keys: dict[str, Any], **values: Any) -> swgpar.DriveDesign:
    """The small drive, whose bore has a radius of 18.6 mm, with discs that would overlap."""
    changed = {key.replace("__", "."): value for key, value in values.items()}
    plain = {"micro_geometry.wg_slope": 0.0, "micro_geometry.wg_crowning": 0.02}
    return swgpar.load_design(DESIGN, {**plain, "wave_generator": {**DISCS, **keys}, **changed})


def test_each_disc_lies_on_its_side() -> None:
    """Distances to the two cylinders, whose axes are 3.6 mm off that of the drive."""
    design = design_on({})
    surface = design.cam_surface()
    x, y, z = 4.0, 15.0, np.array([1.1, -1.1, 0.1, 2.1])
    level, _, _ = surface.evaluate(np.column_stack([np.full(4, x), np.full(4, y), z]))
    reach = 18.6 + 1.0 - 16.0
    expected = [np.hypot(x, y - reach) - 16.0, np.hypot(x, y + reach) - 16.0, 1.0, 1.0]
    assert level == pytest.approx(expected, abs=1e-12)
    assert design.copies == 1 and design.geometry.cam_width == pytest.approx(4.0)


def test_derivatives() -> None:
    surface, h = design_on({}).cam_surface(), 1e-5
    rng = np.random.default_rng(1)
    angle, radius = rng.uniform(0.0, 2.0 * np.pi, 60), rng.uniform(17.5, 20.0, 60)
    z = rng.uniform(0.25, 1.95, 60) * rng.choice([-1.0, 1.0], 60)
    x = np.column_stack([radius * np.sin(angle), radius * np.cos(angle), z])
    _, gradient, hessian = surface.evaluate(x)
    for k in range(3):
        step = h * np.eye(3)[k]
        up, down = surface.evaluate(x + step), surface.evaluate(x - step)
        assert np.allclose((up[0] - down[0]) / (2.0 * h), gradient[:, k], atol=1e-8)
        assert np.allclose((up[1] - down[1]) / (2.0 * h), hessian[:, :, k], atol=1e-8)


def test_the_spline_lies_on_both_discs(tmp_path: Path) -> None:
    """Each disc presses on its side alone, and the bore has its deflection at the middle of the
    disc, within the crowning of 0.02 mm; the cup makes a cone of the rest."""
    values = {"steps__rotation": 0.0, "load__torque": 1.0, "output__fields": True}
    design = design_on({}, **values)
    result = swgpar.run(design, RECIPE, out=tmp_path / "run", progress=False)
    grid = result.grid(-1)
    x, u = np.asarray(grid.points), np.asarray(grid.point_data["displacement"])
    bore = np.abs(np.hypot(x[:, 0], x[:, 1]) - design.inner_radius) < 1e-6
    pressed = bore & (np.nan_to_num(grid.point_data["pressure"]) > 0.0)
    for side in (1.0, -1.0):
        lobe = pressed & (side * x[:, 1] > 0.0)
        assert lobe.any() and (side * x[lobe, 2]).min() == pytest.approx(0.0, abs=1e-9)
        at_axis = bore & (np.abs(x[:, 0]) < 0.8) & (side * x[:, 1] > 0.0)
        height = [
            np.hypot(*(x + u)[at_axis & (np.abs(x[:, 2] - z) < 0.01)][:, :2].T).mean()
            for z in (0.0, 2.0 * side)
        ]
        at_middle = height[0] + 0.55 * (height[1] - height[0])
        assert at_middle == pytest.approx(design.major_semi_axis, abs=0.02)
    assert abs(result.history["torque_balance_Nmm"][-1]) < 1.0
    files = swgpar.export(design, tmp_path, formats=["step"])
    assert any(path.stem == "wave_generator" for path in files)


@pytest.mark.parametrize(
    ("keys", "values", "words"),
    [
        ({"distance": 1.0}, {}, "distance = 1 is out of range: allowed 1.8"),
        ({"distance": 3.0}, {}, "to 2.2 mm"),
        ({"distance": 0.0}, {}, "where the rollers touch"),
        ({"r_2": 25.0}, {}, "r_2 = 25 is out of range: allowed below 19.6"),
        ({}, {"micro_geometry__wg_slope": 0.02}, "wg_slope = 0.02 is not available"),
        (
            {},
            {
                "drive__model": "plane",
                "micro_geometry__wg_crowning": 0.0,
                "micro_geometry__fs_crowning": 0.0,
            },
            'not available with drive.model = "plane"',
        ),
    ],
)
def test_discs_that_do_not_fit(keys: dict[str, Any], values: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        design_on(keys, **values)


def test_a_job_of_calculix_has_no_discs(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"wave_generator.distance is not available .* inp"):
        swgpar.export(design_on({}), tmp_path, formats=["inp"], mesh=RECIPE)
