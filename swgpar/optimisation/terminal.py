"""Terminal output of an optimisation: a line for each evaluation with the best value so far."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from swgpar.log import console
from swgpar.optimisation.problem import STATUS, Evaluation
from swgpar.optimisation.result import OptimisationResult
from swgpar.optimisation.spec import OptimiseSection
from swgpar.results.page import number
from swgpar.studies.many_runs import note_ended, print_line
from swgpar.studies.terminal import folded_table


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
            name, choose = objective.quantity, min if objective.sign > 0.0 else max
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
            name = objective.quantity
            if name in evaluation.quantities:
                best = f" (best {self._best[name]:.5g})" if name in self._best else ""
                words.append(f"{name} {evaluation.quantities[name]:.5g}{best}")
        print_line([*words, ": ".join(filter(None, (evaluation.status, evaluation.reason)))])


def print_result(result: OptimisationResult) -> None:
    """Print the best designs."""
    counts = Counter(each.status for each in result.evaluations.values())
    console.print(", ".join(f"{counts[status]} {status}" for status in STATUS))
    best = {
        index: {**result.evaluations[index].values, **result.evaluations[index].quantities}
        for index in result.best[:20]
    }
    if not best:
        return
    table = folded_table(title="best")
    names = list(best[result.best[0]])
    for name in ("evaluation", *names):
        table.add_column(name, justify="right", overflow="fold")
    for index, values in best.items():
        table.add_row(str(index), *(number(values[name]) for name in names))
    console.print(table)
