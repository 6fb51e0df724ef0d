"""Drives of catalogue sizes: similar within a ratio, which the verification page relies on."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from support.paths import DRIVERS, ROOT
from support.scripts import load_script
from swgpar import load_design

FILES = sorted((DRIVERS / "catalogue").glob("size_*.toml"))
BASE = 17

ROUNDED = 2e-3
"""Face widths have three digits, other lengths four."""


def numbers(table: dict[str, Any], name: str = "") -> Iterator[tuple[str, float]]:
    """Keys with their numbers."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from numbers(value, f"{name}{key}.")
        elif not isinstance(value, str):
            yield f"{name}{key}", float(value)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_lengths_are_in_proportion_to_the_size(path: Path) -> None:
    """All but lengths are the same."""
    _, size, _, ratio = path.stem.split("_")
    base = path.with_name(f"size_{BASE}_ratio_{ratio}.toml")
    here, there = (dict(numbers(tomllib.loads(one.read_text("utf-8")))) for one in (path, base))
    assert here.keys() == there.keys()
    scale, scaled = int(size) / BASE, 0
    for key in here.keys() - {"load.torque"}:
        is_length = here[key] == pytest.approx(scale * there[key], rel=ROUNDED)
        scaled += is_length
        assert is_length or here[key] == pytest.approx(there[key], rel=ROUNDED), key
    assert scaled > 15


@pytest.mark.parametrize("ratio", [30, 50, 100])
def test_designs_are_those_of_the_script(ratio: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """`scripts/bench/catalogue --what designs` writes the files as they are; other sizes follow
    from the test above."""
    monkeypatch.chdir(ROOT)
    curves, designs, fit = (
        load_script(ROOT / "scripts" / "bench" / f"catalogue_{name}.py")
        for name in ("curves", "designs", "fit")
    )
    rated = curves.break_points(BASE)[1]
    written = designs.catalogue_design(BASE, ratio, rated, fit.bent_alike(ratio))
    path = DRIVERS / "catalogue" / f"size_{BASE}_ratio_{ratio}.toml"
    assert tomllib.loads(path.read_text("utf-8")) == written


def test_a_drive_is_a_valid_design() -> None:
    design = load_design(FILES[0])
    assert design.bearing is not None and design.cup.attachment == "clamped"
