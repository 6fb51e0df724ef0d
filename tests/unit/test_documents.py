"""Documents name what exists: files, tests, classes with their members, and lines of at most 100 columns."""

from __future__ import annotations

import ast
import re
from functools import lru_cache
from pathlib import Path

import pytest

from support.paths import ROOT

DOCS = ROOT / "docs"
FOLDERS = ("tutorial", "howto", "theory", "reference", "developer", "verification")
PAGES = [ROOT / "README.md", *sorted(page for folder in FOLDERS for page in (DOCS / folder).rglob("*.md"))]
COLUMNS = 100

by_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))


def quoted(page: Path) -> list[str]:
    """Code spans outside of code blocks."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    return re.findall(r"`([^`\n]+)`", text)


@lru_cache
def sources() -> str:
    folders = ("swgpar", "scripts", "tests")
    files = [
        path for folder in folders for path in (ROOT / folder).rglob("*") if path.suffix in (".py", ".hpp", ".pyx")
    ]
    return "\n".join(path.read_text(encoding="utf-8") for path in files)


@by_page
def test_files_and_tests_exist(page: Path) -> None:
    for name in quoted(page):
        path, _, test = name.partition("::")
        if re.fullmatch(r"[\w./]+/[\w.]+\.(py|hpp|pyx|toml|md)", path):
            places = [folder / path for folder in (ROOT, ROOT / "swgpar", ROOT / "swgpar" / "gear_trains", DOCS)]
            assert any(place.exists() for place in places), name
        if test:
            assert f"def {test}(" in sources(), name


@lru_cache
def classes() -> dict[str, tuple[set[str], list[str]]]:
    """Members and bases of all classes of the package."""
    found: dict[str, tuple[set[str], list[str]]] = {}
    for path in (ROOT / "swgpar").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef):
                members, bases = found.setdefault(node.name, (set(), []))
                bases += [ast.unparse(base).split("[")[0].split(".")[-1] for base in node.bases]
                for part in ast.walk(node):
                    if isinstance(part, ast.FunctionDef):
                        members.add(part.name)
                    elif isinstance(part, (ast.Name, ast.Attribute)) and isinstance(part.ctx, ast.Store):
                        members.add(part.id if isinstance(part, ast.Name) else part.attr)
    return found


def members(name: str) -> set[str]:
    own, bases = classes().get(name, (set(), []))
    return own.union(*(members(base) for base in bases))


@by_page
def test_classes_have_their_members(page: Path) -> None:
    for name in quoted(page):
        for owner, member in re.findall(r"\b([A-Z][a-z]\w+)\.(\w+)", name):
            assert member in members(owner), name


@by_page
def test_lines_wrap(page: Path) -> None:
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), start=1):
        # a row of a table is one line, and so is a generated sentence about a design
        generated = line.startswith("|") or ": refused: " in line or ": failed: " in line
        assert len(line) <= COLUMNS or generated, f"{page.name}:{number}"
