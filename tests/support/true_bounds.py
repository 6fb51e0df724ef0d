"""Whether the bounds that refusals print are those from which on values are refused.

A number of a right design grows, and falls, until the design is refused. The last accepted and the
first refused value are bisected, and compared with the numbers that the refusal names.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

import swgpar
from support.bad_inputs import Path_, leaves, value_at
from support.right_files import Table
from swgpar.errors import SwgparError

NEAR = 1e-5
"""Part of a value to which it is bisected."""

PRINTED = 6e-3
"""Part by which a printed number may differ: three digits."""

FACTORS = np.concatenate([1.0 + np.geomspace(0.01, 1.0, 8), np.geomspace(4.0, 1e18, 16)])
"""Of the changes of a value until it is refused."""

NUMBER = re.compile(r"(?<![\w.])[-+]?\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?")

CONDITION = re.compile(r"divisors|multiples|twice")

VERDICTS = {
    "true": "the bound is among the numbers that are allowed",
    "condition": "divisors, multiples and the like, which have no bound",
    "other key": "the sentence is about another key, or a part of a list",
    "other number": "a number is allowed, but not that",
    "no number": "none is named",
}

SENTENCE = re.compile(
    r"^(?!.*with the other keys)"  # the length of a profile that is advised may be another key's
    r"(?P<key>[\w.]+) = (?P<value>.+?) (?:is|are) .*?allowed (?P<allowed>.+)$"
)


@dataclass(frozen=True)
class Bound:
    """accepted, refused : values on both sides;  sentence : of the refusal
    verdict : one of `VERDICTS`
    """

    key: str
    accepted: float
    refused: float
    sentence: str
    verdict: str


def bounds(table: Table, keys: tuple[str, ...] = ()) -> Iterator[Bound]:
    """All bounds of the numbers of a right table. keys : beginnings of the keys; none: all"""
    for path in leaves(table):
        value, key = value_at(table, path), ".".join(map(str, path))
        if keys and not any(key.startswith(one) for one in keys):
            continue
        if isinstance(value, bool) or not isinstance(value, (int, float)) or "published" in path:
            continue
        for way in (1, -1):
            if (found := _bound(table, path, key, value, way)) is not None:
                yield found


def _bound(table: Table, path: Path_, key: str, value: float, way: int) -> Bound | None:
    """The bound in one direction; None where nothing is refused."""

    def refusal(number: float) -> str:
        changed = json.loads(json.dumps(table))
        whole = isinstance(value, int)
        value_at(changed, path[:-1])[path[-1]] = round(number) if whole else number
        try:
            swgpar.load_design(changed)
        except SwgparError as error:
            return str(error)
        return ""

    good, bad = float(value), None
    for number in _values(float(value), way, isinstance(value, int)):
        if refusal(number):
            bad = number
            break
        good = number
    if bad is None:
        return None
    good, bad = _bisect(refusal, good, bad, isinstance(value, int))
    sentence = refusal(bad)
    return Bound(key, good, bad, sentence, verdict(key, good, bad, sentence))


def _values(value: float, way: int, whole: bool) -> Iterator[float]:
    """Values further and further away, at last on the other side of 0."""
    scale = abs(value) or 1.0
    if way * value >= 0.0:
        steps = value + way * scale * (FACTORS - 1.0)
    else:
        steps = np.concatenate([value / FACTORS, -value * (FACTORS - 1.0)])
    seen = value
    for step in steps.tolist():
        number = float(round(step)) if whole else step
        if number != seen:
            seen = number
            yield number


def _bisect(
    refusal: Callable[[float], str], good: float, bad: float, whole: bool
) -> tuple[float, float]:
    least = 1.0 if whole else NEAR * max(abs(good), abs(bad), 1e-9)
    while abs(bad - good) > least:
        same = good * bad > 0.0 and not 0.25 < good / bad < 4.0
        middle = float(np.sign(good) * np.sqrt(good * bad)) if same else 0.5 * (good + bad)
        middle = float(round(middle)) if whole else middle
        if middle in (good, bad):
            break
        good, bad = (good, middle) if refusal(middle) else (middle, bad)
    return good, bad


def verdict(key: str, good: float, bad: float, sentence: str) -> str:
    """Whether the sentence has the bound of the key between an accepted and a refused value."""
    found = SENTENCE.match(sentence)
    if found is None or found["key"] != key:
        return "other key"
    if CONDITION.search(found["allowed"]):
        return "condition"
    numbers = [float(n.replace(",", "")) for n in NUMBER.findall(found["allowed"])]
    numbers += [0.0] if re.search(r"positive|no value|none", found["allowed"]) else []
    if not numbers:
        return "no number"
    scale = max(abs(good), abs(bad))
    low, high = sorted((good, bad))
    near = any(low - PRINTED * scale <= n <= high + PRINTED * scale for n in numbers)
    return "true" if near else "other number"


def count(found: list[Bound]) -> dict[str, int]:
    """Bounds by verdict."""
    return {one: sum(bound.verdict == one for bound in found) for one in VERDICTS}
