"""Figures of an optimisation as PNG, for its report."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from swgpar.optimisation.problem import Problem
from swgpar.optimisation.result import OptimisationResult
from swgpar.results.figure_set import line_through
from swgpar.results.quantity import with_unit
from swgpar.studies.figures import as_png, axes_grid

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ENOUGH = 5
"""Feasible designs from which the axis of an objective is theirs."""

SHOWN = {"minimise": (0.0, 75.0), "maximise": (25.0, 100.0)}
"""Percentiles of the values that the axis of an objective covers: a few bad designs are far
away."""

COLOURS = {"infeasible": "#c9c9c9", "feasible": "#2f7fd0"}
BEST = "#d07a20"


def _values(result: OptimisationResult, status: str, *names: str) -> np.ndarray:
    """Numbers of the evaluations of a status that have all these quantities, and their values
    (1 + len(names), n)."""
    rows = [
        [number, *(each.quantities[name] for name in names)]
        for number, each in sorted(result.evaluations.items())
        if each.status == status and each.quantities.keys() >= set(names)
    ]
    return np.reshape(rows, (-1, 1 + len(names))).T


def _draw(axes: Axes, result: OptimisationResult, names: list[str], xlabel: str) -> None:
    """Draw the evaluations by status: the last quantity over the first one, or over the number."""
    for status, colour in COLOURS.items():
        *_, x, y = _values(result, status, *names)
        axes.plot(x, y, "o", ms=4, color=colour, label=status)
    axes.set_xlabel(xlabel)


def progress(problem: Problem, result: OptimisationResult) -> bytes:
    """Every objective against the number of the evaluation, with the best value so far."""
    objectives, last = problem.section.objective, max(result.evaluations)
    figure, axes = axes_grid(len(objectives), 6.0, columns=len(objectives))
    for objective, panel in zip(objectives, axes):
        name = objective.quantity
        _draw(panel, result, [name], "evaluation")
        numbers, values = _values(result, "feasible", name)
        if len(values):
            best = objective.sign * np.minimum.accumulate(objective.sign * values)
            x, y = np.append(numbers, last), np.append(best, best[-1])
            panel.step(x, y, where="post", color=BEST, label="best so far")
        if len(values) < ENOUGH:
            values = np.append(values, _values(result, "infeasible", name)[1])
        if len(values):
            low, high = np.percentile(values, SHOWN[objective.goal])
            span = max(high - low, 1e-3 * abs(high))
            panel.set_ylim(low - 0.05 * span, high + 0.1 * span)
        panel.locator_params(axis="x", integer=True)
        panel.grid(alpha=0.3)
        panel.set_ylabel(with_unit(name, problem.known[name].unit))
        panel.legend(fontsize=8)
    return as_png(figure)


def pareto(problem: Problem, result: OptimisationResult) -> list[bytes]:
    """Every pair of objectives against each other, with the Pareto front; none with one
    objective."""
    pictures = []
    titles = {
        objective.quantity: with_unit(objective.quantity, problem.known[objective.quantity].unit)
        for objective in problem.section.objective
    }
    for x, y in itertools.combinations(titles, 2):
        figure, (panel,) = axes_grid(1, 6.0, 4.2)
        _draw(panel, result, [x, y], titles[x])
        best = [result.evaluations[number].quantities for number in result.best]
        front = np.array(sorted((each[x], each[y]) for each in best)).reshape(-1, 2)
        style = line_through(len(front))
        panel.plot(*front.T, "s", ls=style, ms=5, color=BEST, label="Pareto front")
        panel.set_ylabel(titles[y])
        panel.legend(fontsize=8)
        pictures.append(as_png(figure))
    return pictures


def importance(result: OptimisationResult) -> bytes:
    """Importance of the variables for every objective."""
    rows = max(map(len, result.importance.values()))
    count = len(result.importance)
    figure, axes = axes_grid(count, 6.0, 0.8 + 0.35 * rows, columns=count)
    for (name, shares), panel in zip(result.importance.items(), axes):
        ordered = dict(sorted(shares.items(), key=lambda item: item[1]))
        panel.barh(list(ordered), list(ordered.values()), color=COLOURS["feasible"])
        panel.set_xlabel(f"importance for {name}")
    return as_png(figure)
