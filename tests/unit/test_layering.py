"""A module imports only from modules that come before it on the way of the data."""

from __future__ import annotations

import ast
from pathlib import Path

import swgpar
from swgpar.rooms import ROOMS

ROOT = Path(swgpar.__file__).parent


def imported(path: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("swgpar."):
            names.add(node.module.split(".")[1])
        elif isinstance(node, ast.Import):
            names |= {a.name.split(".")[1] for a in node.names if a.name.startswith("swgpar.")}
    return names


def test_every_module_has_its_place() -> None:
    there = {
        p.stem if p.is_file() else p.name for p in ROOT.iterdir() if p.suffix == ".py" or (p / "__init__.py").exists()
    }
    assert there - {"__init__"} == set(ROOMS), swgpar.__file__


def test_imports_go_upwards_only() -> None:
    wrong = []
    for path in sorted(ROOT.rglob("*.py")):
        own = path.relative_to(ROOT).parts[0].removesuffix(".py")
        if own == "__init__":
            continue
        wrong += [
            f"{path.relative_to(ROOT)} imports {name}"
            for name in imported(path)
            if ROOMS.index(name) > ROOMS.index(own)
        ]
    assert not wrong
