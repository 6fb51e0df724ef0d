"""Published values in a design file, section [published], beside the computed quantities."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from swgpar.errors import InputError
from swgpar.input.quantities import show, show_key
from swgpar.results.quantity import Quantity

STATISTICS = {"mean": "mean", "deviation": "standard deviation"}
"""Of results that vary at random: part of the names of quantities -> meaning."""


@dataclass(frozen=True)
class Comparison:
    """A published value beside the computed one.

    quantity : its name;  meaning : with its unit
    difference_percent : in % of the published value, None where that is 0
    """

    quantity: str
    meaning: str
    published: float
    computed: float
    difference_percent: float | None


SAMPLING_ERROR = Quantity("standard error of a deviation by Monte Carlo", "%", detail=True)
"""Of normal samples, in % of the deviation."""


def numbered(name: str, count: int) -> list[str]:
    """Names of the numbers of a quantity: its own name, or with the position in brackets."""
    return [name] if count == 1 else [f"{name}[{number}]" for number in range(1, count + 1)]


def number_label(value: float) -> str:
    """A number in the name of a quantity."""
    return f"{value:g}".replace(".", "p").replace("+", "")


def check_published(published: Mapping[str, Any], known: Mapping[str, Quantity]) -> None:
    """Refuse names that are no quantity, and values that are not as many numbers as it has."""
    for name, given in published.items():
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1)
            hint = f"did you mean {near[0]}?" if near else f"allowed {', '.join(known)}"
            key = show_key(name)
            raise InputError(f"published.{key} is not a quantity of this gear train: {hint}")
        values, count = given if isinstance(given, list) else [given], known[name].count
        numbers = all(
            isinstance(v, (int, float)) and not isinstance(v, bool) and np.isfinite(v)
            for v in values
        )
        if not numbers or len(values) != count:
            wanted = "one number" if count == 1 else f"a list of {count} numbers"
            raise InputError(
                f"published.{name} = {show(given)} is not {wanted}: allowed {known[name].text}"
            )


def compare(
    published: Mapping[str, Any],
    computed: Mapping[str, float | Sequence[float]],
    known: Mapping[str, Quantity],
) -> list[Comparison]:
    """Rows of published.csv."""
    return [
        Comparison(
            title,
            known[name].text,
            float(old),
            float(new),
            float(100.0 * (new - old) / abs(old)) if old else None,
        )
        for name, given in published.items()
        for title, old, new in zip(
            numbered(name, np.size(given)),
            np.atleast_1d(given),
            np.atleast_1d(computed[name]),
            strict=True,
        )
    ]
