"""The README's table of keys says what the design file's sections say."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Literal, get_args, get_origin

from pydantic.fields import FieldInfo

from swgpar.design import DriveDesign
from swgpar.quantities import Section, allowed

README = Path(__file__).parents[2] / "README.md"


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


def expected() -> list[str]:
    rows = [f"| `{key}` | {' | '.join(row)} |" for key, *row in table("", [DriveDesign])]
    # the ring gear has the keys of the flexible spline, and one of its own cutter
    known = {row.replace("`flexible_spline.", "`ring_gear.") for row in rows if "`flexible_spline." in row}
    return [row for row in rows if row not in known]


def test_the_table_lists_every_key() -> None:
    lines = README.read_text(encoding="utf-8").splitlines()
    first = lines.index("| key | meaning (unit) | default | allowed |") + 2
    last = next(i for i in range(first, len(lines)) if not lines[i].startswith("|"))
    assert lines[first:last] == expected(), "write these rows:\n" + "\n".join(expected())
