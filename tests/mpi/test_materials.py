"""Materials of bodies in whole runs: the body decides, not the section that its material stands
in."""

from __future__ import annotations

import numpy as np
import pytest

import swgpar
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE
from swgpar.presentation.drive_result import DriveResult

STEEL, SOFT = {"E": 210e3, "nu": 0.29}, {"E": 120e3, "nu": 0.33}
HOUSING = "ring_gear.housing.thickness=3"
BEARING = (
    "wave_generator.bearing.balls=20",
    "wave_generator.bearing.ball_diameter=2",
    "wave_generator.bearing.race_thickness=0.5",
)


def given(**materials: dict[str, float]) -> list[str]:
    """Overrides for materials by the section they are in, with __ for the dot; `drive` is
    [material]."""
    sections = {name: f"{name.replace('__', '.')}.material" for name in materials} | {
        "drive": "material"
    }
    return [
        f"{sections[name]}.{key}={value}"
        for name, law in materials.items()
        for key, value in law.items()
    ]


def run(*overrides: str) -> DriveResult:
    return swgpar.run(swgpar.load_design(DESIGN, overrides), RECIPE, progress=False)


def assert_same(first: DriveResult, second: DriveResult, tolerance: float) -> None:
    """Columns of the tables agree, relative to their largest entry."""
    for table in ("history", "pairs", "contact_lines", "losses", "balls"):
        one, other = getattr(first, table), getattr(second, table)
        for name, values in one.items():
            assert len(values) == len(other[name])
            if values.dtype.kind in "fi" and not name.startswith(("wall", "seconds")):
                scale = np.nanmax(np.abs(values), initial=1e-30)
                assert np.allclose(
                    values, other[name], rtol=0.0, atol=tolerance * scale, equal_nan=True
                ), name


@pytest.mark.parametrize("more", [(HOUSING,), BEARING])
def test_an_equal_material_given_twice_changes_nothing(more: tuple[str, ...]) -> None:
    sections = {"flexible_spline": STEEL, "ring_gear": STEEL}
    sections |= (
        {"ring_gear__housing": STEEL} if more == (HOUSING,) else {"wave_generator__bearing": STEEL}
    )
    plain = run(*PLANE, *more, *given(drive=STEEL))
    assert_same(plain, run(*PLANE, *more, *given(drive=STEEL, **sections)), 1e-12)


@pytest.mark.parametrize("model", [PLANE, ()], ids=["plane", "cup"])
def test_the_body_decides_and_not_the_section(model: tuple[str, ...]) -> None:
    """A soft ring gear in a drive of steel, and a steel flexible spline in a soft drive: windows
    and losses too."""
    more = (
        *model,
        "output.root_stress=true",
        "losses.flank_friction=0.05",
        "steps.samples=2",
        "steps.rotation=9",
    )
    soft_ring = run(*more, *given(drive=STEEL, ring_gear=SOFT))
    steel_spline = run(*more, *given(drive=SOFT, flexible_spline=STEEL))
    assert_same(soft_ring, steel_spline, 1e-8)
    first, second = (result.summary["root.s1"].value for result in (soft_ring, steel_spline))
    assert first == pytest.approx(second, rel=1e-8)
