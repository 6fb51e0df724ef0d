"""Design files for the tests: the reference cup drive with some of its sections replaced."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from support.paths import REFERENCE


def inline(value: Any) -> str:
    """A value in TOML, tables inline."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {inline(item)}" for key, item in value.items()) + "}"
    return json.dumps(value)


@pytest.fixture
def design_file(tmp_path: Path) -> Callable[[dict[str, dict]], Path]:
    """Function that writes the reference design with the given sections ("ring_gear.profile" too)
    replaced."""

    def write(sections: dict[str, dict]) -> Path:
        table = tomllib.loads(REFERENCE.read_text(encoding="utf-8"))
        for name, section in sections.items():
            *above, last = name.split(".")
            target = table
            for part in above:
                target = target[part]
            target[last] = section
        path = tmp_path / "design.toml"
        path.write_text(
            "\n".join(f"{key} = {inline(value)}" for key, value in table.items()), encoding="utf-8"
        )
        return path

    return write
