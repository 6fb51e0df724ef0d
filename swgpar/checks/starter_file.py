"""The file of a starter design, with the meaning of every key."""

from __future__ import annotations

import shlex
from typing import Any

from swgpar.checks.starter import Request
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import printable
from swgpar.input.quantities import Section
from swgpar.input.toml_file import toml_value


def as_toml(request: Request, design: DriveDesign, table: dict[str, Any], name: str) -> str:
    """The design file with the meaning of every key.

    design, table : of `starter_design`;  name : of the file, for the commands in its head
    """
    size = (
        f"bore {request.bore:g} mm"
        if request.diameter is None
        else f"pitch diameter {request.diameter:g} mm"
    )
    drive = design.drive
    shown = printable(name).replace("\n", "\\n")  # a comment ends with its line
    stem, name = shown.removesuffix(".toml"), shlex.quote(shown)
    lines = [
        f"# Strain wave gear: ratio {request.ratio:g}, {size}, torque {request.torque:g} N·m.",
        "# These are given, with the kinds of profile and cam. All other values are assumptions to "
        "start from: sizes",
        f"# of the blank are shares of the pitch diameter, {drive.module * drive.teeth_fs:.5g} mm, "
        "those of the teeth multiples of the module.",
        f"#   swgpar check {name}",
        f"#   mpirun -n 2 swgpar run {name} --out {shlex.quote(f'results/{stem}')}",
        f"#   mpirun -n 2 swgpar rate {name} --out {shlex.quote(f'results/{stem}_rating')}",
    ]
    for section, content in table.items():
        lines += _section(section, getattr(design, section), content)
    return "\n".join(lines) + "\n"


def _section(title: str, section: Section, content: dict[str, Any]) -> list[str]:
    """Lines of a section: its plain keys with the texts of their fields, then the sections in
    it."""
    tables = {key: value for key, value in content.items() if isinstance(value, dict)}
    entries = {
        key: f"{key} = {toml_value(value)}" for key, value in content.items() if key not in tables
    }
    width = max(map(len, entries.values()))
    fields = type(section).model_fields
    lines = [
        "",
        f"[{title}]",
        *(f"{entry:{width}s}  # {fields[key].description}" for key, entry in entries.items()),
    ]
    for key, value in tables.items():
        lines += _section(f"{title}.{key}", getattr(section, key), value)
    return lines
