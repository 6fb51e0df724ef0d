"""Terminal output of an optimisation: a line for each evaluation with the best value so far."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress

from rich import box
from rich.table import Table

from swgpar import watch
from swgpar.log import console
from swgpar.optimisation.problem import Evaluation
from swgpar.optimisation.result import OptimisationResult
from swgpar.optimisation.spec import OptimiseSection


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
        self._name = name
        self._objectives = section.objective
        self._wanted = wanted
        self._shown = terminal
        self._done = 0
        self._best: dict[str, float] = {}
        for evaluation in known.values():
            self._take(evaluation)

    def _take(self, evaluation: Evaluation) -> None:
        self._done += 1
        if evaluation.status == "feasible":
            for objective in self._objectives:
                name, choose = objective.quantity, min if objective.goal == "minimise" else max
                value = evaluation.quantities[name]
                self._best[name] = choose(value, self._best.get(name, value))

    def receive(self, message: tuple[int, Evaluation]) -> None:
        """An evaluation has ended."""
        number, evaluation = message
        self._take(evaluation)
        watch.saved("evaluations", self._done, self._wanted)
        watch.doing(f"{self._done} of {self._wanted} evaluations have ended")
        if not self._shown:
            return
        words = [
            f"{self._name}  {self._done}/{self._wanted}  evaluation {number}",
            f"{evaluation.wall_s:.1f} s",
        ]
        for objective in self._objectives:
            name = objective.quantity
            value, best = evaluation.quantities.get(name), self._best.get(name)
            if value is not None:
                words.append(
                    f"{name} {value:.5g}" + (f" (best {best:.5g})" if best is not None else "")
                )
        words.append(
            evaluation.status
            if not evaluation.reason
            else f"{evaluation.status}: {evaluation.reason}"
        )
        with suppress(
            OSError, SystemExit
        ):  # the reader of our output has gone: the others are at work
            console.print("  ".join(words), markup=False)
            watch.note_output()


def print_result(result: OptimisationResult) -> None:
    """Print the best designs."""
    counts = {
        s: sum(e.status == s for e in result.evaluations.values())
        for s in ("feasible", "infeasible", "failed")
    }
    console.print(", ".join(f"{count} {status}" for status, count in counts.items()))
    if not result.best:
        return
    first = result.evaluations[result.best[0]]
    table = Table(title="best", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
    names = [*first.values, *first.quantities]
    for name in ("evaluation", *names):
        table.add_column(name, justify="right", overflow="fold")
    for number in result.best[:20]:
        row = {**result.evaluations[number].values, **result.evaluations[number].quantities}
        texts = [
            f"{row[name]:.5g}" if isinstance(row[name], float) else str(row[name]) for name in names
        ]
        table.add_row(str(number), *texts)
    console.print(table)
