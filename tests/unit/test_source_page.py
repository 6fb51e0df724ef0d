"""The page of the sources lists every table and figure, with names that the program has."""

from __future__ import annotations

import ast
import re
from functools import lru_cache

import pytest

from support.paths import ROOT

PAGE = ROOT / "docs" / "verification" / "gear_train_sources.md"

COUNTS = {
    "Cascade gearbox": ({"": 10}, {"": 31}),
    "Gear pair, ring, planetary train": (
        {"1": 1, "3": 2, "4": 1, "5": 4},
        {"1": 5, "2": 1, "3": 15, "4": 13, "5": 6, "6": 9, "A": 18},
    ),
    "Strain wave gear": (
        {"1": 2, "4": 6, "5": 8, "6": 12, "7": 4, "A": 2},
        {"1": 7, "2": 17, "3": 27, "4": 34, "5": 56, "6": 44, "7": 37, "A": 7},
    ),
}
"""By section of the page: numbers of tables and of figures of each chapter of the source."""

STATES = ("compared", "shown", "input", "described", "not")


def rows(section: str) -> list[list[str]]:
    """Cells of the table of tables and figures of a source."""
    text = PAGE.read_text(encoding="utf-8").partition(f"## {section}\n")[2]
    table = text.partition("| number |")[2].partition("\n\n")[0].splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table]


def numbers(text: str) -> list[tuple[str, int]]:
    """Chapters and numbers of "3.5, 3.7 to 3.9"."""
    found = []
    for part in text.split(", "):
        first, _, last = part.partition(" to ")
        chapter, _, start = first.rpartition(".")
        end = last.rpartition(".")[2] or start
        found += [(chapter, k) for k in range(int(start), int(end) + 1)]
    return found


@pytest.mark.parametrize("section", COUNTS)
def test_every_table_and_figure_has_a_state(section: str) -> None:
    tables: list[tuple[str, int]] = []
    figures: list[tuple[str, int]] = []
    for name, shows, state, place in rows(section):
        assert state in STATES and shows and place, name
        for part in name.split("; "):
            if re.match(r"Tables? ", part):
                tables += numbers(part.partition(" ")[2])
            elif not part.startswith("appendix"):
                figures += numbers(part)
    for found, counts in zip((tables, figures), COUNTS[section], strict=True):
        assert sorted(found) == sorted((c, k) for c, n in counts.items() for k in range(1, n + 1))


@lru_cache
def known_names() -> re.Pattern[str]:
    """Names in strings of the gear trains; what a format fills in is any text."""
    found = set()
    for path in (ROOT / "swgpar" / "gear_trains").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.JoinedStr):
                parts = [getattr(part, "value", None) for part in node.values]
                found.add("".join(p if isinstance(p, str) else ".+" for p in parts))
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                found.add(node.value)
    # with a word of the name itself, or any name would do
    names = [one for one in found if re.fullmatch(r"[\w.+]+", one) and re.search("[a-z]{4}", one)]
    return re.compile("|".join(names))


@pytest.mark.parametrize("section", list(COUNTS)[:2])
def test_names_of_figures_and_quantities_exist(section: str) -> None:
    for _, _, _, place in rows(section):
        for name in re.findall(r"`([a-z]\w+…?\w*)`", place):
            assert known_names().fullmatch(name.replace("…", "x")), name
    assert not known_names().fullmatch("load_sharing_of_nobody")
