"""Keys in which two designs differ."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from swgpar.input.design import Design
from swgpar.input.toml_file import flat


@dataclass(frozen=True)
class Difference:
    """A key, dotted, and its values in two designs; None where a design lacks it."""

    key: str
    first: Any
    second: Any


def differences(first: Design, second: Design) -> list[Difference]:
    """Keys in which two designs differ, defaults included, in the order of the first one's file.

    A section that one of both lacks is named by its keys.
    """
    one, other = (dict(flat(design.model_dump())) for design in (first, second))
    return [
        Difference(key, one.get(key), other.get(key))
        for key in [*one, *(key for key in other if key not in one)]
        if one.get(key) != other.get(key)
    ]


def differ_little(first: Any, second: Any, share: float) -> bool:
    """Whether contents of files have the same keys, and floating-point numbers that differ by up to
    a share of the larger one; all else is the same."""
    if isinstance(first, Mapping) and isinstance(second, Mapping):
        return first.keys() == second.keys() and all(
            differ_little(first[name], second[name], share) for name in first
        )
    if isinstance(first, list | tuple) and isinstance(second, list | tuple):
        return len(first) == len(second) and all(
            differ_little(one, other, share) for one, other in zip(first, second, strict=True)
        )
    if isinstance(first, float) and isinstance(second, float):
        return abs(first - second) <= share * max(abs(first), abs(second))
    return bool(first == second)
