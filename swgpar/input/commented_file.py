"""Design files with the meaning of every key beside it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from swgpar.input.design import Design
from swgpar.input.quantities import Section
from swgpar.input.toml_file import to_toml, toml_value


def commented_toml(design: Design) -> str:
    """The design file of a design: the keys that it gives, with their meanings and units."""
    table = design.model_dump(exclude_unset=True, exclude_none=True)
    lines: list[str] = []
    for name, content in table.items():
        section = getattr(design, name)
        if isinstance(section, Section) and isinstance(content, dict):
            lines += section_lines(name, section, content)
        else:
            lines += ["", to_toml({name: content}).rstrip()]
    return "\n".join(lines).lstrip() + "\n"


def section_lines(
    title: str, section: Section, content: Mapping[str, Any], sources: Mapping[str, str] = {}
) -> list[str]:
    """Lines of a section: its source, its plain keys with the texts of their fields, then the
    sections in it.

    content : of the section;  sources : by the titles of sections
    """
    tables = {
        key: value
        for key, value in content.items()
        if isinstance(value, dict) and isinstance(getattr(section, key), Section)
    }
    entries = {
        key: f"{key} = {toml_value(value)}" for key, value in content.items() if key not in tables
    }
    width = max(map(len, entries.values()), default=0)
    fields = type(section).model_fields
    lines = [
        "",
        f"[{title}]",
        *(f"# {source}" for source in [sources.get(title)] if source),
        *(f"{entry:{width}s}  # {fields[key].description}" for key, entry in entries.items()),
    ]
    for key, value in tables.items():
        lines += section_lines(f"{title}.{key}", getattr(section, key), value, sources)
    return lines
