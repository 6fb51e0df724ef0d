"""Designs that a search has tried, from its files: also while it goes on."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swgpar.errors import OutputError
from swgpar.input.toml_file import apply_overrides, parse_value, read_toml
from swgpar.optimisation.files import TABLE
from swgpar.optimisation.spec import Specification, load_specification
from swgpar.results.atomic import reason_of


@dataclass(frozen=True)
class TriedDesign:
    """A design of a search.

    number : of its evaluation;  status : as in optimise.csv;  best : whether it is one of the best
    values : of the variables, by name
    quantities : of objectives and constraints, by name; without those that it does not have
    """

    number: int
    status: str
    best: bool
    values: dict[str, Any]
    quantities: dict[str, float]


@dataclass(frozen=True)
class TriedDesigns:
    """objectives : names of what is sought;  designs : in the order of the table"""

    specification: Specification
    objectives: tuple[str, ...]
    designs: tuple[TriedDesign, ...]

    def table(self, design: TriedDesign) -> dict[str, Any]:
        """Content of the design file of a tried design."""
        section = self.specification.section
        table = read_toml(self.specification.folder / section.design)
        values = {
            key: design.values[variable.name]
            for variable in section.variable
            for key in variable.keys
            if variable.name in design.values
        }
        return apply_overrides(apply_overrides(table, section.set), values)


def read_tried(specification: Path, folder: Path) -> TriedDesigns:
    """Designs in the folder of a search. Raises InputError and OutputError where a file cannot be
    read."""
    spec = load_specification(specification)
    path = folder / TABLE
    try:
        rows = list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8-sig"))))
    except (OSError, ValueError) as error:
        raise OutputError(f"{path} cannot be read: {reason_of(error)}") from None
    section = spec.section
    variables = [variable.name for variable in section.variable]
    wanted = list(dict.fromkeys(one.name for one in section.wanted))
    designs = tuple(
        TriedDesign(
            int(row["evaluation"]),
            row["status"],
            row["best"] == "1",
            {name: parse_value(row[name]) for name in variables if row.get(name)},
            {name: float(row[name]) for name in wanted if _is_number(row.get(name))},
        )
        for row in rows
    )
    return TriedDesigns(spec, tuple(one.name for one in section.objective), designs)


def _is_number(text: str | None) -> bool:
    try:
        float(text or "")
    except ValueError:
        return False
    return True
