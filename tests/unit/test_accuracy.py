"""What an accuracy asked for changes in design and recipe."""

from __future__ import annotations

from pathlib import Path

import pytest
from small_drive import DATA, PLANE

from swgpar.accuracy import RTOL, refined, with_accuracy
from swgpar.design import load_design
from swgpar.errors import InputError
from swgpar.meshing import load_recipe
from swgpar.meshing.recipe import to_toml


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


def test_accuracies_that_cannot_be_had() -> None:
    design = load_design(DATA / "small.toml", PLANE)
    for accuracy in (0.0, 0.5, float("nan")):
        with pytest.raises(InputError, match="out of range: allowed 0.001 to 0.2"):
            with_accuracy(design, accuracy)
    with pytest.raises(InputError, match="--accuracy needs contact.friction = 0, not 0.1"):
        with_accuracy(load_design(DATA / "small.toml", [*PLANE, "contact.friction=0.1"]), 0.01)
