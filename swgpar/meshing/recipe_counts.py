"""Mesh recipes with other element counts: coarser for a start, finer for an accuracy."""

from __future__ import annotations

from collections.abc import Callable

from swgpar.input.toml_file import validate
from swgpar.meshing.recipe import MeshRecipe

SMALLEST = {"tip": 2, "root": 2}
"""Smallest counts of a recipe by name; all others reach 1, along the face width 2 or 3."""

RATIO = 1.5
"""Elements in every direction of a mesh over those of the one before it, but for rounding."""


def with_counts(recipe: MeshRecipe, count: Callable[[str, str, int], int]) -> MeshRecipe:
    """The recipe with ``count(section, name, elements)`` for every element count; gradings stay.

    The parity of the elements along the face width is kept, so that its middle stays a node or an
    element: a crowned cam touches there. With another parity the ring takes a shape that differs by
    0.1 micrometres, and a finer mesh has to find its contacts anew. Raises InputError where a count
    is out of range.
    """

    def section(title: str, counts: dict[str, int | float]) -> dict[str, int | float]:
        # a flag is an int too
        return {
            name: count(title, name, value) if type(value) is int else value
            for name, value in counts.items()
        }

    sections = recipe.model_dump(exclude_none=True)
    content = {title: section(title, counts) for title, counts in sections.items()}
    if recipe.face_width is not None:
        width = content["face_width"]
        width["elements"] += (width["elements"] + recipe.face_width.elements) % 2
    return validate(MeshRecipe, content)


def coarser(recipe: MeshRecipe) -> MeshRecipe:
    """The recipe with half of every count, rounded up."""
    return with_counts(recipe, lambda _, name, value: max(SMALLEST.get(name, 1), -(-value // 2)))


def resized(recipe: MeshRecipe, ratio: float) -> MeshRecipe:
    """The recipe with `ratio` times the elements in every direction; InputError if too many."""
    return with_counts(
        recipe, lambda _, name, count: max(SMALLEST.get(name, 1), round(ratio * count))
    )
