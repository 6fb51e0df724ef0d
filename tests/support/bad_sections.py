"""Bad values in the newer sections of design files and searches, drawn by plain random numbers: all
sections alike, and as many small changes as large ones, so that many inputs are accepted."""

from __future__ import annotations

import datetime
import json
import random
from collections.abc import Iterator
from typing import Any

import tomli_w

from support.bad_inputs import EXTREME, TEXTS, BadInput, Path_, leaves, value_at
from support.right_files import newer_sections


def bad_sections(count: int, number: int) -> Iterator[BadInput]:
    """So many bad inputs, the same for the same number (the seed)."""
    names, rng = list(newer_sections()), random.Random(number)
    for k in range(count):
        name = names[k % len(names)]
        section = newer_sections()[name]
        table = json.loads(json.dumps(section.table))
        what = [_change(table, section.keys, rng) for _ in range(rng.choice((1, 1, 1, 2, 3)))]
        content = tomli_w.dumps(table).encode(errors="surrogatepass")
        yield BadInput(section.kind, {"input.toml": content}, ", ".join(what), name)


def _begins(path: Path_, keys: tuple[str, ...]) -> bool:
    name = ".".join(map(str, path)) + "."
    return not keys or any(name.startswith(f"{key}.") for key in keys)


def _change(table: Any, keys: tuple[str, ...], rng: random.Random) -> str:
    """Change one value below these keys, and say how."""
    paths = [path for path in leaves(table) if _begins(path, keys)]
    if not paths:
        return "nothing is left"
    path = rng.choice(paths)
    parent, old = value_at(table, path[:-1]), value_at(table, path)
    way = rng.choice(("scale", "scale", "scale", "replace", "remove", "add", "exchange"))
    if way == "scale" and isinstance(old, (int, float)) and not isinstance(old, bool):
        new = old * rng.choice((-1.0, 0.0, rng.uniform(0.3, 3.0), 10.0 ** rng.randint(-12, 12)))
        whole = isinstance(old, int) and rng.random() < 0.8
        parent[path[-1]] = round(new) if whole else new
    elif way == "remove":
        del parent[path[-1]]
    elif way == "add" and isinstance(old, dict):
        old[rng.choice(TEXTS)] = _hostile(rng)
    elif way == "add" and isinstance(old, list):
        old.append(old[0] if old and rng.random() < 0.5 else _hostile(rng))
    elif way == "exchange":
        other = rng.choice(paths)
        if other[: len(path)] != path and path[: len(other)] != other:
            parent[path[-1]], value_at(table, other[:-1])[other[-1]] = value_at(table, other), old
    else:
        parent[path[-1]] = _hostile(rng)
    return f"{way} {'.'.join(map(str, path))}"


def _hostile(rng: random.Random, deep: bool = True) -> Any:
    """A value of any type."""
    way = rng.randint(0, 9 if deep else 6)
    if way <= 2:
        return rng.choice(EXTREME)
    if way == 3:
        return rng.choice(
            (rng.uniform(-10.0, 10.0), rng.randint(-3, 3000), 10 ** rng.randint(1, 30))
        )
    if way == 4:
        return rng.choice(TEXTS)
    if way <= 6:
        return rng.choice((True, False, datetime.date(2020, 2, 29)))
    if way == 7:
        return [_hostile(rng, deep=False) for _ in range(rng.randint(0, 4))]
    if way == 8:
        return {rng.choice(TEXTS): _hostile(rng, deep=False) for _ in range(rng.randint(0, 3))}
    return rng.choice(([[]], [{}]))
