"""Published values in a design file beside the computed quantities: results of models in section
[published], measured ones in section [measured]."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from swgpar.errors import InputError
from swgpar.input.quantities import show, show_key
from swgpar.log import logger
from swgpar.results.quantity import Quantity

D = TypeVar("D")

SECTIONS = ("published", "measured")
"""Sections of a design file with values to compare."""

STATISTICS = {"mean": "mean", "deviation": "standard deviation"}
"""Of results that vary at random: part of the names of quantities -> meaning."""


@dataclass(frozen=True)
class Comparison:
    """A published value beside the computed one.

    quantity : its name;  meaning : with its unit
    source : the section of the value, published or measured
    difference_percent : in % of the published value, None where that is 0
    """

    quantity: str
    meaning: str
    published: float
    computed: float
    difference_percent: float | None
    source: str = "published"


SAMPLING_ERROR = Quantity("standard error of a deviation by Monte Carlo", "%", detail=True)
"""Of normal samples, in % of the deviation."""


def numbered(name: str, count: int) -> list[str]:
    """Names of the numbers of a quantity: its own name, or with the position in brackets."""
    return [name] if count == 1 else [f"{name}[{number}]" for number in range(1, count + 1)]


def number_label(value: float) -> str:
    """A number in the name of a quantity."""
    return f"{value:g}".replace(".", "p").replace("+", "")


def made_of_changed(
    make: Callable[[dict[str, Any]], D], table: dict[str, Any], changed: dict[str, Any]
) -> D:
    """The checked design of the changed content of a design file.

    Published and measured values of the file that fit its own design and not the changed one are
    left out; lines of the log name them.
    """
    kept, given = {}, {}
    for section in SECTIONS:
        old, new = (one.get(section) for one in (table, changed))
        if isinstance(old, dict) and isinstance(new, dict):
            kept[section] = {name: value for name, value in new.items() if old.get(name) == value}
            given[section] = {name: value for name, value in new.items() if old.get(name) != value}
    if any(kept.values()) and changed != table:
        with suppress(InputError):  # changes may complete a file; what is wrong is found below
            make(table)
            make(changed | given)
            for section, values in kept.items():
                given[section] |= dict(_fitting(make, changed | given, section, values))
            changed = changed | given
    return make(changed)


def _fitting(
    make: Callable[[dict[str, Any]], object],
    table: dict[str, Any],
    section: str,
    values: Mapping[str, Any],
) -> Iterator[tuple[str, Any]]:
    for name, given in values.items():
        try:
            make(table | {section: {name: given}})
        except InputError:
            logger.warning(
                "%s.%s is left out: the changed design has no such quantity, or another number of "
                "values",
                section,
                name,
            )
        else:
            yield name, given


def check_published(
    values: Mapping[str, Any], known: Mapping[str, Quantity], section: str = "published"
) -> None:
    """Refuse names that are no quantity, and values that are not as many numbers as it has."""
    for name, given in values.items():
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1)
            hint = f"did you mean {near[0]}?" if near else f"allowed {', '.join(known)}"
            key = show_key(name)
            raise InputError(f"{section}.{key} is not a quantity of this gear train: {hint}")
        given_list, count = given if isinstance(given, list) else [given], known[name].count
        numbers = all(
            isinstance(v, (int, float)) and not isinstance(v, bool) and np.isfinite(v)
            for v in given_list
        )
        if not numbers or len(given_list) != count:
            wanted = "one number" if count == 1 else f"a list of {count} numbers"
            raise InputError(
                f"{section}.{name} = {show(given)} is not {wanted}: allowed {known[name].text}"
            )


def compare(
    published: Mapping[str, Any],
    computed: Mapping[str, float | Sequence[float]],
    known: Mapping[str, Quantity],
    source: str = "published",
) -> list[Comparison]:
    """Rows of published.csv."""
    return [
        Comparison(
            title,
            known[name].text,
            float(old),
            float(new),
            float(100.0 * (new - old) / abs(old)) if old else None,
            source,
        )
        for name, given in published.items()
        for title, old, new in zip(
            numbered(name, np.size(given)),
            np.atleast_1d(given),
            np.atleast_1d(computed[name]),
            strict=True,
        )
    ]
