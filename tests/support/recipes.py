"""Mesh recipes with other numbers of elements."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from swgpar.input.toml_file import to_toml
from swgpar.meshing import MeshRecipe, load_recipe
from swgpar.meshing.recipe_counts import with_counts


def refined(mesh: str, path: Path, factor: float, keys: Sequence[str] = ()) -> Path:
    """Write a recipe with `factor` times as many elements: by the given keys (section.key), or in
    every direction."""
    recipe = load_recipe(mesh)
    finer = with_counts(recipe, lambda *count: -int(-factor * count[-1] // 1))
    if keys:
        content = recipe.model_dump(exclude_none=True)
        for section, name in (key.split(".") for key in keys):
            content[section][name] = getattr(getattr(finer, section), name)
        finer = MeshRecipe.model_validate(content)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(to_toml(finer.model_dump()), encoding="utf-8")
    return path
