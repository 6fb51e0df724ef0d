"""The start design beside the best ones: a row for every variable, objective and constraint."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from swgpar.optimisation.optimisation_data import OptimisationData
from swgpar.results.quantity import with_unit


@dataclass(frozen=True)
class ComparedRow:
    """name : of a variable or quantity, with its unit;  wanted : goal, limit or bounds
    cells : value in every column, None where it is not known
    """

    name: str
    wanted: str
    cells: tuple[Any, ...]


@dataclass(frozen=True)
class DesignComparison:
    """heads : of the columns;  rows : of the table
    starts : whether the first column is the start design
    """

    heads: tuple[str, ...]
    rows: tuple[ComparedRow, ...]
    starts: bool

    def parts(self, columns: int) -> Iterator[DesignComparison]:
        """The comparison in parts with so many columns. The start design, if there is one, is in
        each of them."""
        fixed = 1 if self.starts and len(self.heads) > 1 else 0
        step = max(columns - fixed, 1)
        for first in range(fixed, len(self.heads), step):
            chosen = [*range(fixed), *range(first, min(first + step, len(self.heads)))]
            yield DesignComparison(
                tuple(self.heads[k] for k in chosen),
                tuple(
                    ComparedRow(row.name, row.wanted, tuple(row.cells[k] for k in chosen))
                    for row in self.rows
                ),
                self.starts,
            )


def comparison(result: OptimisationData, numbers: Sequence[int]) -> DesignComparison:
    """The designs of these evaluations beside each other."""
    section, every = result.section, [result.evaluations[number] for number in numbers]

    def named(name: str) -> str:
        return with_unit(name, result.units.get(name, ""))

    rows = [
        ComparedRow(named(one.name), one.range_text, tuple(each.values[one.name] for each in every))
        for one in section.variable
    ]
    wanted: dict[str, list[str]] = {}
    for objective in section.objective:
        wanted.setdefault(objective.name, []).append(objective.goal)
    for constraint in section.constraint:
        wanted.setdefault(constraint.name, []).append(constraint.words)
    for name, words in wanted.items():
        cells = tuple(each.verdicts.get(name, each.quantities.get(name)) for each in every)
        rows.append(ComparedRow(named(name), ", ".join(words), cells))
    further = dict.fromkeys(name for each in every for name in each.verdicts if name not in wanted)
    rows += [
        ComparedRow(name, "", tuple(each.verdicts.get(name, "") for each in every))
        for name in further
    ]
    rows.append(ComparedRow("status", "", tuple(each.status for each in every)))
    return DesignComparison(
        tuple(_head(result, n) for n in numbers), tuple(rows), result.start in numbers
    )


def _head(result: OptimisationData, number: int) -> str:
    kinds = {"start": number == result.start, "best": number in result.best}
    return f"{number} ({', '.join(word for word, is_so in kinds.items() if is_so)})"


def bound_sentences(result: OptimisationData) -> list[str]:
    """The variables of the best designs that are at a bound."""
    return [
        f"evaluation {number}: {one.text}"
        for number, found in result.at_bounds.items()
        for one in found
    ]


def start_sentence(result: OptimisationData) -> str:
    """What is to know of the start design; empty where it stands beside the best."""
    if result.without_start:
        return f"The start design is no point of the search: {result.without_start}."
    return "" if result.start is not None else "The start design has not been tried."
