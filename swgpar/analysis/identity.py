"""Identity of what a run computes, by which a restart knows its own files."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from swgpar.input.quantities import show
from swgpar.meshing import MeshRecipe
from swgpar.results.atomic import to_json

MOST_NAMED = 3
"""Keys that are named where two runs differ in more."""


@dataclass(frozen=True)
class RunContent:
    """What a run computes.

    content : design, recipe and accuracy, as JSON has them
    """

    content: Mapping[str, Any]

    @classmethod
    def of(
        cls, decisive: Mapping[str, Any], recipe: MeshRecipe, accuracy: float | None
    ) -> RunContent:
        """decisive : `DriveDesign.decisive_keys`"""
        content = {"design": decisive, "recipe": recipe.model_dump(), "accuracy": accuracy}
        return cls(json.loads(to_json(content)))

    @cached_property
    def identity(self) -> str:
        """Two runs with the same one compute the same."""
        return hashlib.sha256(to_json(dict(self.content))).hexdigest()

    def differs_from(self, other: RunContent) -> str:
        """The first keys in which another run differs, with its values; empty for none."""
        found = list(_differences(self.content, other.content))
        named = [f"{key} = {here}, there {there}" for key, here, there in found[:MOST_NAMED]]
        more = len(found) - MOST_NAMED
        return "; ".join(named) + (f"; {more} more" if more > 0 else "")


def identity(decisive: Mapping[str, Any], recipe: MeshRecipe, accuracy: float | None) -> str:
    """Identity of what is computed. decisive : `DriveDesign.decisive_keys`"""
    return RunContent.of(decisive, recipe, accuracy).identity


def _differences(
    mine: Mapping[str, Any], others: Mapping[str, Any], before: str = ""
) -> Iterator[tuple[str, str, str]]:
    """Keys with different values, and both of these. Sections that both have are compared key by
    key."""
    for key in {**mine, **others}:
        here, there = mine.get(key), others.get(key)
        if here == there:
            continue
        if isinstance(here, Mapping) and isinstance(there, Mapping):
            yield from _differences(here, there, f"{before}{key}.")
        else:
            name = f"{before}{key}".removeprefix("design.")
            yield name, _text(here), _text(there)


def _text(value: Any) -> str:
    """A value as in a design file."""
    if isinstance(value, Mapping):
        return "given"
    return "not given" if value is None else show(value)
