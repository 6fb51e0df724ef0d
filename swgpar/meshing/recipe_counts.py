"""Mesh recipes with other element counts: coarser for a start, finer for an accuracy."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from swgpar.input.toml_file import validate
from swgpar.meshing.recipe import MeshRecipe

ROUND_OFF = 1e-9
"""Of a product of a count and a ratio."""

SMALLEST = {"tip": 2, "root": 2}
"""Smallest counts of a recipe by name; all others reach 1, along the face width 2 or 3."""

FEWEST_ALONG_ROOT = 3
"""Elements along the root of a mesh for comparison, where the mesh itself has more. Windows on a
mesh with two can find a stress that is off by half (docs/verification/effectivity.md)."""

RATIO = 1.5
"""Elements in every direction of a mesh over those of the one before it, at least."""

FLANKS = {"flexible_spline": ("flank",), "ring_gear": ("flank",)}
"""Counts along the flanks, by section."""

CONTACT = {**FLANKS, "face_width": ("elements",)}
"""Counts that decide about the contact of the flanks, by section. All others decide about the
stiffness of teeth and rim."""

BODY = ("root", "under", "rim")
"""Counts of the flexible spline that decide most about its stiffness."""


WALL = {"cup": ("cylinder", "fillet", "closed_end"), "face_width": ("elements",)}
"""Counts that decide about the wall of a cup, by section."""


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


def coarsened(recipe: MeshRecipe) -> MeshRecipe:
    """The recipe with 1/RATIO of every count, rounded down, so that no ratio is smaller; counts
    that are the smallest already stay. Four elements along the root become three."""

    def count(_: str, name: str, own: int) -> int:
        fewest = min(FEWEST_ALONG_ROOT, own - 1) if name == "root" else 1
        return max(SMALLEST.get(name, 1), fewest, int(own / RATIO + ROUND_OFF))

    return with_counts(recipe, count)


def with_wall_rounded_up(coarse: MeshRecipe, recipe: MeshRecipe) -> MeshRecipe:
    """The coarser recipe with 1/RATIO of the counts of the cup, rounded up: a cylinder of two
    elements is too stiff to tell what four leave."""
    return with_counts(
        coarse,
        lambda section, name, own: (
            math.ceil(getattr(recipe.cup, name) / RATIO - ROUND_OFF) if section == "cup" else own
        ),
    )


def refined(recipe: MeshRecipe) -> MeshRecipe:
    """The recipe with RATIO times every count, rounded up; InputError if too many."""
    return with_counts(recipe, lambda _, name, count: math.ceil(RATIO * count - ROUND_OFF))


def with_flanks_of(body: MeshRecipe, flanks: MeshRecipe) -> MeshRecipe:
    """The recipe `body` with the elements along the flanks of `flanks`."""

    def count(section: str, name: str, own: int) -> int:
        of_flank = name in FLANKS.get(section, ())
        return getattr(getattr(flanks, section), name) if of_flank else own

    return with_counts(body, count)


def contact_ratio(coarse: MeshRecipe, fine: MeshRecipe) -> float | None:
    """Smallest ratio of the counts for the contact of the flanks that differ; None if none do."""
    return _smallest_ratio(coarse, fine, CONTACT)


def body_ratio(coarse: MeshRecipe, fine: MeshRecipe) -> float | None:
    """Smallest ratio of the counts `BODY` that differ; None if none do."""
    return _smallest_ratio(coarse, fine, {"flexible_spline": BODY})


def wall_ratio(coarse: MeshRecipe, fine: MeshRecipe) -> float | None:
    """Smallest ratio of the counts of a cup's wall and width that differ; None if none do."""
    return _smallest_ratio(coarse, fine, WALL)


def _smallest_ratio(
    coarse: MeshRecipe, fine: MeshRecipe, names: Mapping[str, Sequence[str]]
) -> float | None:
    ratios = [
        getattr(getattr(fine, section), name) / getattr(getattr(coarse, section), name)
        for section, counts in names.items()
        if getattr(fine, section) is not None
        for name in counts
    ]
    return min((ratio for ratio in ratios if ratio > 1.0), default=None)


def with_equal_doubled(recipe: MeshRecipe, coarse: MeshRecipe) -> MeshRecipe:
    """The recipe with twice the counts that a coarser one has too, because they are too small to be
    coarsened; InputError if too many."""
    return with_counts(
        recipe,
        lambda section, name, count: (
            2 * count if count == getattr(getattr(coarse, section), name) else count
        ),
    )


def resized(recipe: MeshRecipe, ratio: float) -> MeshRecipe:
    """The recipe with `ratio` times the elements in every direction; InputError if too many."""
    return with_counts(
        recipe, lambda _, name, count: max(SMALLEST.get(name, 1), round(ratio * count))
    )
