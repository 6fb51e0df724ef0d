"""Designs that a search has tried, from its files: also while it goes on."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swgpar.errors import OutputError
from swgpar.input.toml_file import parse_value
from swgpar.optimisation.files import TABLE
from swgpar.optimisation.optimisation_data import SearchedDesigns, number_of
from swgpar.optimisation.problem import Evaluation, Problem, make_problem
from swgpar.optimisation.spec import OptimiseSection, Variable, load_specification
from swgpar.results.atomic import reason_of
from swgpar.results.table import is_number


@dataclass(frozen=True, kw_only=True)
class TriedDesigns(SearchedDesigns):
    """The evaluations are without violations. problem : what is sought"""

    problem: Problem

    def table(self, number: int) -> dict[str, Any]:
        """Content of the design file of a tried design."""
        return self.problem.applied(self.problem.table, self.evaluations[number].values)


def read_tried(specification: Path, folder: Path) -> TriedDesigns:
    """Designs in the folder of a search. Raises InputError and OutputError where a file cannot be
    read."""
    problem = make_problem(load_specification(specification))
    path = folder / TABLE
    try:
        rows = list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8-sig"))))
    except (OSError, ValueError) as error:
        raise OutputError(f"{path} cannot be read: {reason_of(error)}") from None
    evaluations = {int(row["evaluation"]): _evaluation(problem.section, row) for row in rows}
    best = [int(row["evaluation"]) for row in rows if row["best"] == "1"]
    return TriedDesigns(
        section=problem.section,
        units=problem.units,
        evaluations=evaluations,
        best=best,
        start=number_of(evaluations, problem.start.values),
        problem=problem,
    )


def _evaluation(section: OptimiseSection, row: dict[str, str]) -> Evaluation:
    return Evaluation(
        {one.name: _value(one, row[one.name]) for one in section.variable if row.get(one.name)},
        row["status"],
        row.get("reason", ""),
        {name: float(row[name]) for name in section.quantities if is_number(row.get(name) or "")},
        {},
    )


def _value(variable: Variable, text: str) -> Any:
    value = parse_value(text)
    taken = variable.taken(value)
    return value if taken is None else taken
