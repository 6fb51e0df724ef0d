"""Figures of an optimisation."""

from __future__ import annotations

import itertools
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from swgpar.optimisation.optimisation_data import OptimisationData
from swgpar.optimisation.parallel_coordinates import parallel_coordinates
from swgpar.results.figure_set import Drawings, line_through
from swgpar.results.quantity import with_unit
from swgpar.studies.figures import axes_grid

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PROGRESS, PARALLEL, PARETO, IMPORTANCE = (
    "progress",
    "parallel_coordinates",
    "pareto",
    "importance",
)
"""Names of figures; every pair of objectives has a Pareto front, with a number behind the name."""

ENOUGH = 5
"""Feasible designs from which the axis of an objective is theirs."""

SHOWN = {"minimise": (0.0, 75.0), "maximise": (25.0, 100.0)}
"""Percentiles of the values that the axis of an objective covers: a few bad designs are far
away."""

COLOURS = {"infeasible": "#c9c9c9", "feasible": "#2f7fd0"}
BEST = "#d07a20"


def _values(result: OptimisationData, status: str, *names: str) -> np.ndarray:
    """Numbers of the evaluations of a status that have all these quantities, and their values
    (1 + len(names), n)."""
    rows = [
        [number, *(each.quantities[name] for name in names)]
        for number, each in sorted(result.evaluations.items())
        if each.status == status and each.quantities.keys() >= set(names)
    ]
    return np.reshape(rows, (-1, 1 + len(names))).T


def _draw(axes: Axes, result: OptimisationData, names: list[str], xlabel: str) -> None:
    """Draw the evaluations by status: the last quantity over the first one, or over the number."""
    for status, colour in COLOURS.items():
        *_, x, y = _values(result, status, *names)
        axes.plot(x, y, "o", ms=4, color=colour, label=status)
    axes.set_xlabel(xlabel)


def drawings(result: OptimisationData) -> Drawings:
    """The figures that the result allows; none without an evaluation."""
    if not result.evaluations:
        return {}
    found = {
        PROGRESS: partial(progress, result),
        PARALLEL: partial(parallel_coordinates, result),
    }
    pairs = itertools.combinations(dict.fromkeys(o.name for o in result.section.objective), 2)
    for number, (x, y) in enumerate(pairs, start=1):
        found[f"{PARETO}_{number}"] = partial(pareto, result, x, y)
    if result.importance:
        found[IMPORTANCE] = partial(importance, result)
    return found


def _titled(result: OptimisationData, name: str) -> str:
    return with_unit(name, result.units.get(name, ""))


def progress(result: OptimisationData) -> Figure:
    """Every objective against the number of the evaluation, with the best value so far and that of
    the start design."""
    objectives, last = result.section.objective, max(result.evaluations)
    figure, axes = axes_grid(len(objectives), 6.0, columns=len(objectives))
    start = {} if result.start is None else result.evaluations[result.start].quantities
    for objective, panel in zip(objectives, axes):
        name = objective.name
        _draw(panel, result, [name], "evaluation")
        numbers, values = _values(result, "feasible", name)
        if len(values):
            best = objective.sign * np.minimum.accumulate(objective.sign * values)
            x, y = np.append(numbers, last), np.append(best, best[-1])
            panel.step(x, y, where="post", color=BEST, label="best so far")
        if len(values) < ENOUGH:
            values = np.append(values, _values(result, "infeasible", name)[1])
        if name in start:
            panel.plot(result.start, start[name], "k*", ms=9, label="start design")
            values = np.append(values, start[name])
        if len(values):
            low, high = np.percentile(values, SHOWN[objective.goal])
            low, high = min(low, start.get(name, low)), max(high, start.get(name, high))
            span = max(high - low, 1e-3 * abs(high))
            panel.set_ylim(low - 0.05 * span, high + 0.1 * span)
        panel.locator_params(axis="x", integer=True)
        panel.grid(alpha=0.3)
        panel.set_ylabel(_titled(result, name))
        panel.legend(fontsize=8)
    return figure


def pareto(result: OptimisationData, x: str, y: str) -> Figure:
    """Two objectives against each other, with the Pareto front and the start design."""
    figure, (panel,) = axes_grid(1, 6.0, 4.2)
    _draw(panel, result, [x, y], _titled(result, x))
    best = [result.evaluations[number].quantities for number in result.best]
    front = np.array(sorted((each[x], each[y]) for each in best)).reshape(-1, 2)
    style = line_through(len(front))
    panel.plot(*front.T, "s", ls=style, ms=5, color=BEST, label="Pareto front")
    start = {} if result.start is None else result.evaluations[result.start].quantities
    if x in start and y in start:
        panel.plot(start[x], start[y], "k*", ms=9, label="start design")
    panel.set_ylabel(_titled(result, y))
    panel.legend(fontsize=8)
    return figure


def importance(result: OptimisationData) -> Figure:
    """Importance of the variables for every objective."""
    rows = max(map(len, result.importance.values()))
    count = len(result.importance)
    figure, axes = axes_grid(count, 6.0, 0.8 + 0.35 * rows, columns=count)
    for (name, shares), panel in zip(result.importance.items(), axes):
        ordered = dict(sorted(shares.items(), key=lambda item: item[1]))
        panel.barh(list(ordered), list(ordered.values()), color=COLOURS["feasible"])
        panel.set_xlabel(f"importance for {name}")
    return figure
