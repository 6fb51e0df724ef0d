"""Reference pages say what the program reads and writes; examples of the how-to pages are
accepted."""

from __future__ import annotations

import re
import tomllib
from dataclasses import fields
from pathlib import Path

import pytest

import swgpar
from support.markdown import examples
from support.paths import DRIVERS, ROOT
from support.scripts import load_script
from swgpar.drive_results.summary import ANSWER_GROUPS, DriveSummary, known_answers
from swgpar.input.quantities import Section
from swgpar.results import history

DOCS = ROOT / "docs"
ANSWER_TABLES = load_script(DOCS / "generators" / "answer_tables.py")
KEY_TABLES = load_script(DOCS / "generators" / "key_tables.py")
COLUMN_TABLES = load_script(DOCS / "generators" / "column_tables.py")


def first_cells(page: Path) -> list[str]:
    """Names in code font in the first column of the tables of a page."""
    lines = page.read_text(encoding="utf-8").splitlines()
    return [
        name
        for line in lines
        if line.startswith("| `")
        for name in re.findall(r"`(\w+)`", line.split("|")[1])
    ]


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
    rows = re.findall(
        r"^\| `([\w.]+)` \| (.*?) \|", KEY_TABLES.file_tables(design, alike), flags=re.MULTILINE
    )
    sections = {
        name for name, field in design.model_fields.items() if not KEY_TABLES.choices(field)
    }
    assert {key.rpartition(".")[2] for key, _ in rows} == keys(design) - sections
    assert all(meaning and "None" not in meaning for _, meaning in rows)


def test_drawings_of_the_keys_are_made() -> None:
    """Sections exist, and the scripts of the drawings name each file."""
    scripts = "".join(
        path.read_text(encoding="utf-8") for path in (DOCS / "drawings").glob("[!_]*.py")
    )
    design, alike = KEY_TABLES.FILES["drive"]
    assert set(KEY_TABLES.DRAWINGS) <= set(design.model_fields)
    table = KEY_TABLES.file_tables(design, alike)
    for drawing in [name for names in KEY_TABLES.DRAWINGS.values() for name in names]:
        assert f'"{drawing}": ' in scripts
        assert f"../_generated/{drawing}.png" in table


def test_history_columns() -> None:
    """The page includes the generated tables of all columns."""
    page = (DOCS / "reference" / "history.md").read_text(encoding="utf-8")
    drives = dict.fromkeys(column.drives for column in history.DECLARED)
    assert all(f"_generated/columns_{name.replace(' ', '_')}.md" in page for name in drives)
    rows = [
        line
        for name in drives
        for line in COLUMN_TABLES.table(name).splitlines()
        if line.startswith("| `")
    ]
    assert len(rows) == len(history.COLUMNS) and not any(line.endswith("|  |") for line in rows)


def test_summary_entries() -> None:
    entries = {field.name for field in fields(DriveSummary)} | {"format", "answers"}
    assert set(first_cells(DOCS / "reference" / "summary.md")) == entries


def test_every_answer_is_in_the_tables_with_its_unit_and_meaning() -> None:
    """The tables come from the kinds; a run has no other answers, and has those that its design
    promises."""
    rows = re.findall(
        r"^\| `([^`]+)` \| `([^`]+)` \| (.*?) \| (.*) \|$",
        "\n".join(ANSWER_TABLES.tables()),
        flags=re.MULTILINE,
    )
    kinds = [kind for name in ANSWER_GROUPS for kind in ANSWER_TABLES.kinds_of(name)]
    assert rows == [
        (kind.name, kind.path, kind.unit, kind.text.replace("|", "\\|")) for kind in kinds
    ]
    gear = {"tip": 2, "layers": 1, "flank": 2, "root": 2, "under": 1, "rim": 1}
    design = swgpar.load_design(
        DRIVERS / "plane_half_turn.toml", {"steps.rotation": 3.0, "steps.samples": 2}
    )
    summary = swgpar.run(
        design, mesh={"flexible_spline": gear, "ring_gear": gear}, progress=False
    ).summary
    names = {name for name, *_ in rows}
    found = {name for name in summary if not name.startswith("step") and " in " not in name}
    assert found <= names
    for name, kind in known_answers(design).items():
        if name in summary:
            assert (summary[name].unit, summary[name].text) == (kind.unit, kind.text)
    assert {
        "mean.fs_s1",
        "sharing.pairs",
        "transmission_error.peak_to_peak",
        "largest.fs_s1",
    } <= found


def test_the_own_drive_and_the_own_recipe_are_accepted() -> None:
    assert swgpar.load_design(DOCS / "howto" / "own_drive.toml").kinematics.ratio == -100.0
    (recipe,) = examples(DOCS / "howto" / "mesh.md", "toml")
    assert swgpar.load_mesh(tomllib.loads(recipe)).flexible_spline.flank == 14


def test_length_of_the_readme() -> None:
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 130
