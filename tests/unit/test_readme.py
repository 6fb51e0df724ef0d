"""The tables of keys in the documentation say what the design files' sections say."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, get_args, get_origin

import pytest
from pydantic.fields import FieldInfo

from support.paths import ROOT
from swgpar.design.drive_design import DriveDesign
from swgpar.input.quantities import Section, allowed


def sections(field: FieldInfo) -> list[type[Section]]:
    choices = get_args(field.annotation) or (field.annotation,)
    return [choice for choice in choices if isinstance(choice, type) and issubclass(choice, Section)]


def kind(section: type[Section]) -> str:
    return get_args(section.model_fields["type"].annotation)[0]


def cells(field: FieldInfo) -> tuple[str, str, str]:
    """Meaning, default and allowed values."""
    default = "required" if field.is_required() else str(field.default)
    if get_origin(field.annotation) is Literal:
        values = " or ".join(get_args(field.annotation))
    elif field.annotation is bool:
        values = "true or false"
    elif get_origin(field.annotation) in (list, dict):
        values = "numbers" if get_origin(field.annotation) is list else "a table"
    else:
        values = allowed(field).removeprefix("allowed ")
    return str(field.description), default if field.default is not None else "none", values


def table(prefix: str, choices: list[type[Section]], only: str = "") -> Iterator[tuple[str, str, str, str]]:
    """Rows of a section, or of one with several types: then with the types that have the key."""
    several = len(choices) > 1

    def owners_among(owners: list[type[Section]]) -> str:
        return ", ".join(map(kind, owners)) + ": " if several and len(owners) < len(choices) else only

    if several:
        types = [kind(section) for section in choices]
        yield f"{prefix}type", str(choices[0].model_fields["type"].description), types[0], " or ".join(types)
    names = dict.fromkeys(name for section in choices for name in section.model_fields)
    for name in names:
        owners = [section for section in choices if name in section.model_fields]
        inner = sections(owners[0].model_fields[name])
        if inner:
            yield from table(f"{prefix}{name}.", inner, owners_among(owners))
        elif not (several and name == "type"):
            for row in dict.fromkeys(cells(section.model_fields[name]) for section in owners):
                same = [section for section in owners if cells(section.model_fields[name]) == row]
                yield f"{prefix}{name}", owners_among(same) + row[0], row[1], row[2]


def expected(design: type[Section], alike: dict[str, str]) -> list[str]:
    """Rows of a design file. alike : section -> another, whose rows are not repeated for it"""
    rows = [f"| `{key}` | {' | '.join(row)} |" for key, *row in table("", [design])]
    known = {
        row.replace(f"`{other}.", f"`{section}.")
        for section, other in alike.items()
        for row in rows
        if f"`{other}." in row
    }
    return [row for row in rows if row not in known]


@pytest.mark.parametrize(
    ("file", "place", "design", "alike"),
    [
        ("README.md", 0, DriveDesign, {"ring_gear": "flexible_spline"}),
    ],
)
def test_the_table_lists_every_key(file: str, place: int, design: type[Section], alike: dict[str, str]) -> None:
    """place : of the table in the file"""
    lines = (ROOT / file).read_text(encoding="utf-8").splitlines()
    first = [i for i, line in enumerate(lines) if line == "| key | meaning (unit) | default | allowed |"][place] + 2
    last = next(i for i in range(first, len(lines)) if not lines[i].startswith("|"))
    rows = expected(design, alike)
    assert lines[first:last] == rows, "write these rows:\n" + "\n".join(rows)
