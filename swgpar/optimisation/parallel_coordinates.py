"""The figure of parallel coordinates: every design as a line through its variables and
quantities."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from swgpar.optimisation.bounds import position
from swgpar.optimisation.optimisation_data import SearchedDesigns
from swgpar.optimisation.problem import Evaluation
from swgpar.optimisation.spec import Variable
from swgpar.results.figure_set import new_figure
from swgpar.results.page import number
from swgpar.results.quantity import with_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, HEIGHT = 1.25, 4.6
"""Inches: between two axes, and of the figure."""

LETTERS = 16
"""Letters of a row of a name below an axis."""

LEFT_OUT = 5.0
"""Percent of the values of designs that keep no constraint, on either side, that the axis of a
quantity need not cover."""

STYLES: dict[str, dict[str, Any]] = {
    "infeasible": {"color": "#c9c9c9", "lw": 0.8, "alpha": 0.7},
    "feasible": {"color": "#2f7fd0", "lw": 1.0, "alpha": 0.6},
    "best": {"color": "#d07a20", "lw": 2.2, "marker": "o", "ms": 4},
    "start": {"color": "black", "lw": 1.8, "ls": "--", "marker": "s", "ms": 4},
}
"""Of lines, in the order in which they are drawn."""

FORBIDDEN = "#c03030"


@dataclass(frozen=True)
class ParallelAxis:
    """title : below it;  low, high : texts at its ends
    place : where a design is on it, 0 to 1; NaN where it has no value
    limits : place of each limit, and the end of the axis on the side that is not allowed
    """

    title: str
    low: str
    high: str
    place: Callable[[Evaluation], float]
    limits: tuple[tuple[float, float], ...] = ()


def parallel_coordinates(result: SearchedDesigns) -> Figure:
    """Every design with a run as a line; an axis for every variable, objective and limit."""
    axes = parallel_axes(result)
    figure = new_figure(figsize=(WIDTH * (len(axes) + 0.5), HEIGHT), layout="constrained")
    panel = figure.add_subplot()
    groups: dict[str, list[int]] = {name: [] for name in STYLES}
    for n, each in sorted(result.evaluations.items()):
        if each.status in STYLES:
            groups[each.status].append(n)
    groups["best"], groups["start"] = result.best, [] if result.start is None else [result.start]
    for kind, numbers in groups.items():
        for k, n in enumerate(numbers):
            places = [axis.place(result.evaluations[n]) for axis in axes]
            label = "start design" if kind == "start" else kind
            panel.plot(places, label="" if k else label, **STYLES[kind])
    for k, axis in enumerate(axes):
        _draw_axis(panel, k, axis)
    panel.set_xlim(-0.5, len(axes) - 0.5)
    panel.set_ylim(-0.04, 1.04)
    panel.set_yticks([])
    panel.set_xticks(range(len(axes)), [axis.title for axis in axes], fontsize=8)
    panel.tick_params(axis="x", length=0, pad=14)
    for spine in panel.spines.values():
        spine.set_visible(False)
    figure.legend(loc="outside upper center", ncols=4, fontsize=8)
    return figure


def parallel_axes(result: SearchedDesigns) -> list[ParallelAxis]:
    """An axis for every variable, objective and limit."""
    axes = [_of_variable(result, one) for one in result.section.variable]
    return axes + [_of_quantity(result, name) for name in result.section.quantities]


def _draw_axis(panel: Axes, k: int, axis: ParallelAxis) -> None:
    panel.axvline(k, color="#555555", lw=0.8, zorder=1)
    for place, end in axis.limits:
        panel.plot([k, k], [place, end], color=FORBIDDEN, lw=5.0, alpha=0.35, zorder=1)
        panel.plot([k - 0.08, k + 0.08], [place, place], color=FORBIDDEN, lw=2.0)
    for text, y, side in ((axis.low, -0.045, "top"), (axis.high, 1.045, "bottom")):
        panel.text(k, y, text, ha="center", va=side, fontsize=8, clip_on=False)


def _of_variable(result: SearchedDesigns, variable: Variable) -> ParallelAxis:
    ends = variable.choices or [variable.low, variable.high]
    return ParallelAxis(
        _wrapped(with_unit(variable.name, result.units.get(variable.name, ""))),
        number(ends[0]),
        number(ends[-1]),
        lambda each: position(variable, each.values[variable.name]),
    )


def _of_quantity(result: SearchedDesigns, name: str) -> ParallelAxis:
    section = result.section
    limits = [
        (limit, sign)
        for constraint in section.constraint
        if constraint.name == name
        for limit, sign in constraint.limits.values()
    ]
    goals = [objective.goal for objective in section.objective if objective.name == name]
    low, high = _range(result, name, [limit for limit, _ in limits])
    ends = tuple((_place(low, high, limit), 1.0 if sign > 0 else 0.0) for limit, sign in limits)
    title = "\n".join([_wrapped(with_unit(name, result.units.get(name, ""))), *goals])
    return ParallelAxis(title, number(low), number(high), partial(_of, name, low, high), ends)


def _of(name: str, low: float, high: float, each: Evaluation) -> float:
    return _place(low, high, each.quantities.get(name, np.nan))


def _place(low: float, high: float, value: float) -> float:
    return (value - low) / (high - low)


def _range(result: SearchedDesigns, name: str, limits: list[float]) -> tuple[float, float]:
    """Ends of the axis of a quantity: it shows all feasible designs, the start design, limits, and
    most of the other designs."""
    shown = list(limits)
    others: list[float] = []
    for n, each in result.evaluations.items():
        value = each.quantities.get(name, np.nan)
        if np.isfinite(value) and each.status != "failed":
            kept = each.status == "feasible" or n == result.start
            (shown if kept else others).append(value)
    if others:
        shown += np.percentile(others, (LEFT_OUT, 100.0 - LEFT_OUT)).tolist()
    if not shown:
        return 0.0, 1.0
    low, high = float(min(shown)), float(max(shown))
    least = 1e-3 * (abs(high) or 1.0)
    return (low, high) if high - low > least else (low - least, high + least)


def _wrapped(name: str) -> str:
    """A name in rows; it is divided behind points, colons, underscores and blanks."""
    rows = [""]
    for part in re.findall(r"[^.:_ ]*[.:_ ]?", name):
        if rows[-1] and len(rows[-1] + part) > LETTERS:
            rows.append("")
        rows[-1] += part
    return "\n".join(row.strip() for row in rows)
