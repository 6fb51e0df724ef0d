"""Reference pages say what the program reads and writes; examples of the how-to pages are accepted."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

import swgpar
from support.markdown import examples
from support.paths import DRIVERS, ROOT
from support.scripts import load_script
from swgpar.input.quantities import Section
from swgpar.results import history

DOCS = ROOT / "docs"
KEY_TABLES = load_script(DOCS / "generators" / "key_tables.py")
COLUMN_TABLES = load_script(DOCS / "generators" / "column_tables.py")


def first_cells(page: Path) -> list[str]:
    """Names in code font in the first column of the tables of a page."""
    lines = page.read_text(encoding="utf-8").splitlines()
    return [name for line in lines if line.startswith("| `") for name in re.findall(r"`(\w+)`", line.split("|")[1])]


def keys(section: type[Section]) -> set[str]:
    """Names of all plain keys of a section and of the sections inside it."""
    found = set()
    for name, field in section.model_fields.items():
        inner = KEY_TABLES.choices(field)
        found |= set().union(*map(keys, inner)) if inner else {name}
    return found


@pytest.mark.parametrize("name", KEY_TABLES.FILES)
def test_the_tables_list_every_key_with_its_meaning(name: str) -> None:
    design, alike = KEY_TABLES.FILES[name]
    rows = re.findall(r"^\| `([\w.]+)` \| (.*?) \|", KEY_TABLES.file_tables(design, alike), flags=re.MULTILINE)
    sections = {name for name, field in design.model_fields.items() if not KEY_TABLES.choices(field)}
    assert {key.rpartition(".")[2] for key, _ in rows} == keys(design) - sections
    assert all(meaning and "None" not in meaning for _, meaning in rows)


def test_history_columns() -> None:
    """The page includes the generated tables of all columns."""
    page = (DOCS / "reference" / "history.md").read_text(encoding="utf-8")
    drives = dict.fromkeys(column.drives for column in history.DECLARED)
    assert all(f"_generated/columns_{name.replace(' ', '_')}.md" in page for name in drives)
    rows = [line for name in drives for line in COLUMN_TABLES.table(name).splitlines() if line.startswith("| `")]
    assert len(rows) == len(history.COLUMNS) and not any(line.endswith("|  |") for line in rows)


def test_summary_keys() -> None:
    gear = {"tip": 2, "layers": 1, "flank": 2, "root": 2, "under": 1, "rim": 1}
    design = swgpar.load_design(DRIVERS / "plane_half_turn.toml", {"steps.rotation": 0.0})
    result = swgpar.run(design, mesh={"flexible_spline": gear, "ring_gear": gear}, progress=False)
    assert set(first_cells(DOCS / "reference" / "summary.md")) == set(result.summary)


def test_the_own_drive_and_the_own_recipe_are_accepted() -> None:
    assert swgpar.load_design(DOCS / "howto" / "own_drive.toml").ratio == -100.0
    (recipe,) = examples(DOCS / "howto" / "mesh.md", "toml")
    assert swgpar.load_mesh(tomllib.loads(recipe)).flexible_spline.flank == 14


def test_length_of_the_readme() -> None:
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 130
