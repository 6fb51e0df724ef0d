"""Documents name what exists: files, tests, classes with their members, and lines of at most 100 columns."""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path

import pytest

from support.paths import ROOT

DOCS = ROOT / "docs"
PAGES = sorted(page for folder in ("theory", "developer", "verification") for page in (DOCS / folder).glob("*.md"))
COLUMNS = 100

FIRST_LAYOUT = "number.md"
"""Names files of another commit as well."""

by_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(DOCS)))


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
            places = [folder / path for folder in (ROOT, ROOT / "swgpar", DOCS)]
            assert any(place.exists() for place in places), name
        if test:
            assert f"def {test}(" in sources(), name


@by_page
def test_classes_have_their_members(page: Path) -> None:
    if page.name == FIRST_LAYOUT:
        return
    for name in quoted(page):
        for owner, member in re.findall(r"\b([A-Z][a-z]\w+)\.(\w+)", name):
            if f"class {owner}" in sources():
                assert re.search(rf"\b{member}\b", sources()), name
            else:
                assert re.search(rf"\b{owner}\b", sources()), name


@by_page
def test_lines_wrap(page: Path) -> None:
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), start=1):
        # a row of a table is one line, and so is a generated sentence that refuses a design
        assert len(line) <= COLUMNS or line.startswith("|") or ": refused: " in line, f"{page.name}:{number}"
