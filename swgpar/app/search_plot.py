"""Figures of Plotly of the designs that a search has tried."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

from swgpar.input.quantities import show
from swgpar.results.quantity import with_unit

if TYPE_CHECKING:
    from swgpar.optimisation.tried_designs import TriedDesigns

COLOURS = {"failed": "#c03030", "infeasible": "#9a9a9a", "feasible": "#2f7fb8", "best": "#d07a20"}
"""Of designs, those drawn last last."""

EVALUATION = "evaluation"
"""Name of the number of a design."""

FEW = 10
"""Whole numbers on an axis up to which each has a tick."""

LETTERS = 60
"""In a line of a reason."""

FORBIDDEN = "#c03030"


def words(tried: TriedDesigns, number: int) -> str:
    """What became of a design."""
    said = [tried.evaluations[number].status]
    said += ["best"] if number in tried.best else []
    said += ["start design"] if number == tried.start else []
    return ", ".join(said)


def pair_figure(tried: TriedDesigns, x: str, y: str) -> dict[str, Any]:
    """Every design at its values of two variables or quantities."""
    traces = []
    for kind, numbers in _groups(tried).items():
        places = [(n, _value(tried, n, x), _value(tried, n, y)) for n in numbers]
        shown = [place for place in places if None not in place]
        if not shown:
            continue
        traces.append(
            {
                "type": "scatter",
                "mode": "markers",
                "name": kind,
                "x": [place[1] for place in shown],
                "y": [place[2] for place in shown],
                "customdata": [place[0] for place in shown],
                "text": [_text(tried, place[0]) for place in shown],
                "hoverinfo": "text",
                "marker": {"color": COLOURS[kind], "size": 10},
            }
        )
    return _figure(traces, {"xaxis": _axis(tried, x), "yaxis": _axis(tried, y)})


def parallel_figure(tried: TriedDesigns) -> dict[str, Any]:
    """Every design as a line through its variables and quantities."""
    from swgpar.optimisation.parallel_coordinates import parallel_axes

    axes = parallel_axes(tried)
    traces = []
    for kind, numbers in _groups(tried).items():
        for k, number in enumerate(numbers):
            places = [axis.place(tried.evaluations[number]) for axis in axes]
            traces.append(
                {
                    "type": "scatter",
                    "mode": "lines+markers",
                    "name": kind,
                    "legendgroup": kind,
                    "showlegend": k == 0,
                    "x": list(range(len(axes))),
                    "y": [None if place != place else place for place in places],
                    "customdata": [number] * len(axes),
                    "text": [_text(tried, number)] * len(axes),
                    "hoverinfo": "text",
                    "line": {"color": COLOURS[kind], "width": 2.5 if kind == "best" else 1},
                    "opacity": 1.0 if kind == "best" else 0.6,
                }
            )
    shapes = [
        {"type": "line", "x0": k, "x1": k, "y0": low, "y1": high, "line": line, "layer": "below"}
        for k, axis in enumerate(axes)
        for low, high, line in [
            (0.0, 1.0, {"color": "#7a7a7a", "width": 1}),
            *((place, end, {"color": FORBIDDEN, "width": 5}) for place, end in axis.limits),
        ]
    ]
    ends = [
        {"x": k, "y": y, "text": text, "yanchor": anchor, "showarrow": False}
        for k, axis in enumerate(axes)
        for y, text, anchor in ((0.0, axis.low, "top"), (1.0, axis.high, "bottom"))
    ]
    titles = [axis.title.replace("\n", "<br>") for axis in axes]
    # in a narrow window titles are turned, and take the room that they need
    ticks = {"tickvals": list(range(len(axes))), "ticktext": titles, "automargin": True}
    bare = {"showgrid": False, "zeroline": False}
    layout = {
        "xaxis": {**bare, **ticks, "range": [-0.5, len(axes) - 0.5]},
        "yaxis": {**bare, "showticklabels": False, "range": [-0.08, 1.08]},
        "shapes": shapes,
        "annotations": ends,
    }
    return _figure(traces, layout)


def _figure(traces: list[dict[str, Any]], layout: dict[str, Any]) -> dict[str, Any]:
    common = {
        "margin": {"l": 60, "r": 10, "t": 30, "b": 90},
        "font": {"color": "#7a7a7a"},
        "legend": {"orientation": "h", "y": 1.15},
        "hovermode": "closest",
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
    }
    return {"data": traces, "layout": common | layout, "config": {"displaylogo": False}}


def _groups(tried: TriedDesigns) -> dict[str, list[int]]:
    """Numbers of designs by what became of them, without kinds that no design has."""
    groups: dict[str, list[int]] = {kind: [] for kind in COLOURS}
    for number, each in tried.evaluations.items():
        groups["best" if number in tried.best else each.status].append(number)
    return {kind: numbers for kind, numbers in groups.items() if numbers}


def _value(tried: TriedDesigns, number: int, name: str) -> Any:
    """Value of a design; None where it has none."""
    each = tried.evaluations[number]
    if name == EVALUATION:
        return number
    return each.values.get(name, each.quantities.get(name))


def _text(tried: TriedDesigns, number: int) -> str:
    """What the pointer shows."""
    each = tried.evaluations[number]
    found = [*each.values.items(), *((k, float(f"{v:.5g}")) for k, v in each.quantities.items())]
    lines = [f"{name} = {show(value)} {tried.units.get(name, '')}".strip() for name, value in found]
    reason = textwrap.wrap(each.reason, LETTERS)
    return "<br>".join([f"evaluation {number}: {words(tried, number)}", *lines, *reason])


def _axis(tried: TriedDesigns, name: str) -> dict[str, Any]:
    """Axis of a variable or a quantity; whole numbers have whole ticks."""
    axis: dict[str, Any] = {"title": {"text": with_unit(name, tried.units.get(name, ""))}}
    whole = [one.name for one in tried.section.variable if one.is_whole]
    if name in (EVALUATION, *whole):
        values = [_value(tried, n, name) for n in tried.evaluations]
        axis["tickformat"] = "d"
        if not values or max(values) - min(values) <= FEW:
            axis["dtick"] = 1
    return axis
