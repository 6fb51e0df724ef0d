"""Terminal output of an optimisation: a line for each evaluation with the best value so far."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from rich import box
from rich.table import Table

from swgpar.log import console
from swgpar.optimisation.comparison import (
    DesignComparison,
    bound_sentences,
    comparison,
    start_sentence,
)
from swgpar.optimisation.optimisation_data import OptimisationData
from swgpar.optimisation.problem import STATUS, Evaluation
from swgpar.optimisation.spec import OptimiseSection
from swgpar.results.page import number
from swgpar.studies.many_runs import note_ended, print_line

SHOWN = 20
"""Designs in the tables at the end: optimise.csv has all."""


class OptimiseProgress:
    """Lines of rank 0.

    known : evaluations of earlier calls, by number;  wanted : number of all
    """

    def __init__(
        self,
        name: str,
        section: OptimiseSection,
        known: Mapping[int, Evaluation],
        wanted: int,
        terminal: bool,
    ) -> None:
        self._name, self._objectives = name, section.objective
        self._wanted, self._shown = wanted, terminal
        self._done = 0
        self._best: dict[str, float] = {}
        for evaluation in known.values():
            self._take(evaluation)

    def _take(self, evaluation: Evaluation) -> None:
        self._done += 1
        for objective in self._objectives if evaluation.status == "feasible" else ():
            name, choose = objective.name, min if objective.sign > 0.0 else max
            value = evaluation.quantities[name]
            self._best[name] = choose(value, self._best.get(name, value))

    def receive(self, message: tuple[int, Evaluation]) -> None:
        """An evaluation has ended."""
        index, evaluation = message
        self._take(evaluation)
        note_ended("evaluations", self._done, self._wanted)
        if not self._shown:
            return
        words = [f"{self._name}  {self._done}/{self._wanted}  evaluation {index}"]
        words.append(f"{evaluation.wall_s:.1f} s")
        for objective in self._objectives:
            name = objective.name
            if name in evaluation.quantities:
                best = f" (best {self._best[name]:.5g})" if name in self._best else ""
                words.append(f"{name} {evaluation.quantities[name]:.5g}{best}")
        print_line([*words, ": ".join(filter(None, (evaluation.status, evaluation.reason)))])


LONGEST = 11
"""Letters of a number in a table, of a verdict and of a status."""

NAMES = 0.4
"""Part of the terminal's width that names may take."""


def print_result(result: OptimisationData) -> None:
    """Print the start design beside the best ones, and which variables are at a bound."""
    counts = Counter(each.status for each in result.evaluations.values())
    console.print(", ".join(f"{counts[status]} {status}" for status in STATUS))
    if result.compared:
        found = comparison(result, result.compared[:SHOWN])
        width = min(max(len(row.name) for row in found.rows), int(NAMES * console.width))
        columns = (console.width - width - 2) // (LONGEST + 1)
        for part in found.parts(columns):
            _print_part(part, width)
    for sentence in (start_sentence(result), *bound_sentences(result)):
        if sentence:
            console.print(sentence, markup=False)


def _print_part(part: DesignComparison, width: int) -> None:
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
    table.add_column("evaluation", overflow="fold", width=width)
    for head in part.heads:
        table.add_column(head, justify="right", overflow="fold", max_width=LONGEST)
    for row in part.rows:
        table.add_row("\n".join(filter(None, (row.name, row.wanted))), *map(number, row.cells))
    console.print(table)
