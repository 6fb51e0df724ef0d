"""Elements of windows around the root arcs, whose split lies where the tension may be largest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import swgpar
from support.paths import DRIVERS, REFERENCE
from swgpar.design.drive_design import DriveDesign
from swgpar.largest_stress.window_recipes import LEVELS, MOST_LEVELS, window_recipe
from swgpar.meshing.half_tooth import HalfTooth
from swgpar.meshing.recipe import ToothRecipe


@dataclass(frozen=True)
class Split:
    """Lengths (mm) of the elements of the root arc above its split, and the first one below it;
    thickness of the layer at the flank above it, and of that at the root below it."""

    above: np.ndarray
    below: float
    beside: float
    under: float


def half_tooth(design: DriveDesign, recipe: ToothRecipe) -> HalfTooth:
    gear = design.geometry.gears["flexible_spline"]
    inner = design.geometry.inner_radius
    interface = inner + design.geometry.cup_thickness
    return HalfTooth(gear.profile, recipe, interface, inner)


def split_of(half: HalfTooth) -> Split:
    profile, s = half.profile, half.s
    at = int(np.abs(s - half.s_side[-1]).argmin())
    arc = s[(s >= profile.root_start - 1e-9) & (s <= s[at] + 1e-9)]
    _, side, *_, root, _, _ = half.blocks()
    # the bottom of the side block runs from J to Q, the left side of the root block from B to Q
    beside, under = np.linalg.norm(np.diff(side[0], axis=0), axis=1), root[3]
    depth = np.linalg.norm(np.diff(under, axis=0), axis=1)
    return Split(np.diff(arc), float(s[at + 1] - s[at]), float(beside[-1]), float(depth[-1]))


@pytest.mark.parametrize("name", ["cup_45deg", "silk_hat"])
def test_windows_resolve_the_root_arc_on_both_sides_of_its_split(name: str) -> None:
    design = swgpar.load_design(DRIVERS / f"{name}.toml")
    for level in range(MOST_LEVELS["cup"]):
        split = split_of(half_tooth(design, window_recipe("cup", level).flexible_spline))
        # half of the elements of the flank are too few by up to 5 %
        assert split.above.max(initial=0.0) <= 1.1 * split.below
    level = LEVELS["cup"] - 1
    split = split_of(half_tooth(design, window_recipe("cup", level).flexible_spline))
    assert split.beside < 2.0 * split.under


def test_even_roots_take_their_elements_from_the_flank() -> None:
    design = swgpar.load_design(REFERENCE)
    recipe = window_recipe("cup", 2).flexible_spline
    even = half_tooth(design, recipe)
    plain = half_tooth(design, recipe.model_copy(update={"even_root": False}))
    assert len(even.s) == len(plain.s)
    assert np.array_equal(even.s[[0, -1]], plain.s[[0, -1]])
    assert even.profile.root_start in even.s
    assert np.array_equal(np.sort(even.s), even.s)
