"""What an accuracy asked for changes in design and recipe."""

from __future__ import annotations

from pathlib import Path

import pytest
from small_drive import DATA, PLANE

from swgpar.accuracy import RTOL, refined, relative_error, with_accuracy
from swgpar.design import load_design
from swgpar.errors import InputError
from swgpar.meshing import load_recipe
from swgpar.meshing.recipe import to_toml
from swgpar.multilevel import CoarserLevel


def test_every_count_is_refined_and_no_grading() -> None:
    recipe = load_recipe(DATA.parent.parent / "mesh/full.toml")
    finer = refined(recipe, 1.5)
    assert finer.flexible_spline.flank == 26 and finer.ring_gear.under == 3 and finer.cup.fillet == 6
    assert finer.cup.end_ratio == recipe.cup.end_ratio
    assert refined(recipe, 2.0).face_width.elements == 20


def test_a_chosen_recipe_can_be_read_again(tmp_path: Path) -> None:
    for name in ("full", "plane"):
        recipe = load_recipe(DATA.parent.parent / f"mesh/{name}.toml")
        (tmp_path / "recipe.toml").write_text(to_toml(recipe))
        assert load_recipe(tmp_path / "recipe.toml") == recipe


def test_what_the_design_says_itself_is_kept() -> None:
    design = with_accuracy(load_design(DATA / "small.toml", [*PLANE, "steps.rotation=9"]), 0.01)
    assert design.steps.samples == 8 and design.solver.rtol == RTOL
    own = [*PLANE, "steps.rotation=9", "steps.samples=3", "solver.rtol=1e-8"]
    design = with_accuracy(load_design(DATA / "small.toml", own), 0.01)
    assert design.steps.samples == 3 and design.solver.rtol == 1e-8
    # less than a period
    assert with_accuracy(load_design(DATA / "small.toml", [*PLANE, "steps.rotation=4"]), 0.01).steps.samples == 0


def test_sectors_are_condensed_where_that_leaves_out_little() -> None:
    plane = DATA.parent.parent / "drivers/plane_half_turn.toml"
    assert with_accuracy(load_design(plane), 0.02).solver.condensed_sectors
    assert not with_accuracy(load_design(plane), 0.005).solver.condensed_sectors
    assert not with_accuracy(load_design(plane, ["solver.condensed_sectors=false"]), 0.02).solver.condensed_sectors
    assert not with_accuracy(load_design(DATA / "small.toml", PLANE), 0.2).solver.condensed_sectors
    assert not with_accuracy(load_design(plane.with_name("cup_45deg.toml")), 0.1).solver.condensed_sectors


def test_accuracies_that_cannot_be_had() -> None:
    design = load_design(DATA / "small.toml", PLANE)
    for accuracy in (0.0, 0.5, float("nan")):
        with pytest.raises(InputError, match="out of range: allowed 0.001 to 0.2"):
            with_accuracy(design, accuracy)
    with pytest.raises(InputError, match="--accuracy needs contact.friction = 0, not 0.1"):
        with_accuracy(load_design(DATA / "small.toml", [*PLANE, "contact.friction=0.1"]), 0.01)


def level(elements: int, stress: float) -> CoarserLevel:
    return CoarserLevel(elements, {"fs_s1": stress})


@pytest.mark.parametrize("dimensions", [2, 3])
def test_error_of_a_stress_of_the_first_order(dimensions: int) -> None:
    levels = [level(n, 300.0 - 700.0 * n ** (-1.0 / dimensions)) for n in (1000, 3375, 27000)]
    assert relative_error(levels, dimensions) == pytest.approx(1.0 - levels[-1].stresses["fs_s1"] / 300.0)
    assert relative_error(levels[:1], dimensions) == 1.0


def test_a_difference_that_is_small_by_chance_is_no_convergence() -> None:
    """The larger one of the last two slopes counts, and meshes that are not finer than the one before say nothing."""
    chance = [level(100, 280.0), level(400, 260.0), level(1600, 260.1)]
    assert relative_error(chance, 2) == pytest.approx(10.0 / 270.1)
    assert relative_error([*chance, level(1600, 260.1)], 2) == 1.0
