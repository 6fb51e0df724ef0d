"""Figures of an optimisation as PNG, for its report."""

from __future__ import annotations

import io
import itertools
from typing import TYPE_CHECKING

import numpy as np

from swgpar.optimisation.problem import Problem
from swgpar.optimisation.result import OptimisationResult
from swgpar.results.quantity import with_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ENOUGH = 5
"""Feasible designs from which the axis of an objective is theirs."""

SHOWN = {"minimise": (0.0, 75.0), "maximise": (25.0, 100.0)}
"""Percentiles of the values that the axis of an objective covers: a few bad designs are far
away."""

COLOURS = {"feasible": "#2f7fd0", "infeasible": "#c9c9c9"}


def _png(figure: Figure) -> bytes:
    import matplotlib.pyplot as plt

    buffer = io.BytesIO()
    figure.savefig(buffer, dpi=110, bbox_inches="tight")
    plt.close(figure)
    return buffer.getvalue()


def _label(problem: Problem, name: str) -> str:
    return with_unit(name, problem.known[name].unit)


def _values(result: OptimisationResult, name: str, status: str) -> tuple[list[int], list[float]]:
    """Numbers of the evaluations of a status that have a quantity, and its values."""
    found = {
        n: each.quantities[name]
        for n, each in sorted(result.evaluations.items())
        if each.status == status and name in each.quantities
    }
    return list(found), list(found.values())


def progress(problem: Problem, result: OptimisationResult) -> bytes:
    """Every objective against the number of the evaluation, with the best value so far."""
    import matplotlib.pyplot as plt

    objectives, last = problem.section.objective, max(result.evaluations)
    figure, axes = plt.subplots(
        1, len(objectives), figsize=(6.0 * len(objectives), 3.6), squeeze=False
    )
    for objective, panel in zip(objectives, axes[0]):
        for status, colour in reversed(COLOURS.items()):
            panel.plot(
                *_values(result, objective.quantity, status), "o", ms=4, color=colour, label=status
            )
        numbers, values = _values(result, objective.quantity, "feasible")
        if values:
            best = (np.minimum if objective.goal == "minimise" else np.maximum).accumulate(values)
            panel.step(
                [*numbers, last],
                [*best, best[-1]],
                where="post",
                color="#d07a20",
                label="best so far",
            )
        known = (
            values
            if len(values) >= ENOUGH
            else values + _values(result, objective.quantity, "infeasible")[1]
        )
        if known:
            low, high = np.percentile(known, SHOWN[objective.goal])
            span = max(high - low, 1e-3 * abs(high))
            panel.set_ylim(low - 0.05 * span, high + 0.1 * span)
        panel.xaxis.get_major_locator().set_params(integer=True)
        panel.grid(alpha=0.3)
        panel.set_xlabel("evaluation")
        panel.set_ylabel(_label(problem, objective.quantity))
        panel.legend(fontsize=8)
    return _png(figure)


def pareto(problem: Problem, result: OptimisationResult) -> list[bytes]:
    """Every pair of objectives against each other, with the Pareto front; none with one
    objective."""
    import matplotlib.pyplot as plt

    pictures = []
    names = [objective.quantity for objective in problem.section.objective]
    for x, y in itertools.combinations(names, 2):
        figure, panel = plt.subplots(figsize=(6.0, 4.2))
        for status, colour in reversed(COLOURS.items()):
            found = [
                each.quantities for each in result.evaluations.values() if each.status == status
            ]
            found = [each for each in found if x in each and y in each]
            panel.plot(
                [each[x] for each in found],
                [each[y] for each in found],
                "o",
                ms=4,
                color=colour,
                label=status,
            )
        front = sorted(
            (result.evaluations[n].quantities[x], result.evaluations[n].quantities[y])
            for n in result.best
        )
        panel.plot(
            [a for a, _ in front],
            [b for _, b in front],
            "s-",
            ms=5,
            color="#d07a20",
            label="Pareto front",
        )
        panel.set_xlabel(_label(problem, x))
        panel.set_ylabel(_label(problem, y))
        panel.legend(fontsize=8)
        pictures.append(_png(figure))
    return pictures


def importance(result: OptimisationResult) -> bytes:
    """Importance of the variables for every objective."""
    import matplotlib.pyplot as plt

    found = result.importance
    rows = len(next(iter(found.values())))
    figure, axes = plt.subplots(
        1, len(found), figsize=(6.0 * len(found), 0.8 + 0.35 * rows), squeeze=False
    )
    for (name, shares), panel in zip(found.items(), axes[0]):
        ordered = sorted(shares.items(), key=lambda item: item[1])
        panel.barh([key for key, _ in ordered], [share for _, share in ordered], color="#2f7fd0")
        panel.set_xlabel(f"importance for {name}")
    figure.tight_layout()
    return _png(figure)
