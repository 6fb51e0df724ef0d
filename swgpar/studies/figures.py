"""Figures of a study as PNG, for its report."""

from __future__ import annotations

import io
import textwrap
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from swgpar.results.figure_set import line_through, new_figure
from swgpar.results.history import COLUMNS, loaded_increments
from swgpar.results.quantity import with_unit
from swgpar.studies.case import Case, Outcome
from swgpar.studies.table import by_case, shown, shown_quantities, units_of_keys

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from swgpar.studies.table import JobResult

OVER_ANGLE = ("fs_s1", "fs_s3", "fs_vm")
LINES = 12
"""Lines in one figure: more of them cannot be told apart."""

PANELS = 12
"""In one figure."""

LETTERS = 160
"""Letters of a legend's row."""

DECADES = 30.0
"""Largest over smallest value of a key from which its axis is logarithmic."""

TITLE_LETTERS = 48
"""Letters of a row of a panel's title."""

MARKERS = "os^vDP"


def over_angle(results: Sequence[JobResult]) -> Iterator[bytes]:
    """Stresses against the angle of the wave generator, every case on its finest finished mesh."""
    lines = []
    for case, outcomes in by_case(results):
        finished = [outcome for outcome in outcomes if outcome.status == "finished"]
        columns = finished[-1].history if finished else {}
        if columns and len(loaded_increments(columns)) > 1:
            lines.append((case.name, columns))
    for part in _parts(lines):
        figure, axes = axes_grid(len(OVER_ANGLE))
        for name, panel in zip(OVER_ANGLE, axes):
            for k, (label, columns) in enumerate(part):
                loaded = loaded_increments(columns)
                if name in columns:
                    angle, values = columns["wg_angle_deg"][loaded], columns[name][loaded]
                    panel.plot(angle, values, label=label, **_style(k, len(values)))
            stress = f"stress ({COLUMNS[name].unit})"
            _name(panel, COLUMNS[name].label, stress, "angle of the wave generator (degrees)")
        _add_legend(figure, axes)
        yield as_png(figure)


def over_key(results: Sequence[JobResult], key: str, *, in_step: bool) -> Iterator[bytes]:
    """Quantities against a varied key; a line for each combination of all else. None without
    numbers.

    in_step : whether the other varied keys change with this one, so that they make no lines of
    their own
    """
    lines: dict[str, list[tuple[float, Outcome]]] = {}
    for case, outcomes in by_case(results):
        value = single(case.varied.get(key))
        if value is None:
            return
        if outcomes[-1].values:
            lines.setdefault(_rest(case, key, in_step), []).append((value, outcomes[-1]))
    drawn = [(label, sorted(points, key=lambda point: point[0])) for label, points in lines.items()]
    if not any(len(points) > 1 for _, points in drawn):
        return
    values = [x for _, points in drawn for x, _ in points]
    title = with_unit(key, units_of_keys(results).get(key, ""))
    scale = "log" if min(values) > 0.0 and max(values) >= DECADES * min(values) else "linear"
    for panels in _parts(list(shown_quantities(results).items()), PANELS):
        for part in _parts(drawn):
            figure, axes = axes_grid(len(panels))
            for (name, quantity), panel in zip(panels, axes):
                for k, (label, points) in enumerate(part):
                    known = [(x, o.values[name]) for x, o in points if name in o.values]
                    style = _style(k, len(known))
                    panel.plot(*np.reshape(known, (-1, 2)).T, label=label, **style)
                _name(panel, quantity.meaning, with_unit(name, quantity.unit), title)
                panel.set_xscale(scale)
            _add_legend(figure, axes)
            yield as_png(figure)


def single(value: Any) -> float | None:
    """The number that a varied value is, or that a list of one number holds."""
    if isinstance(value, list) and len(value) == 1:
        value = value[0]
    return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else None


def _rest(case: Case, key: str, in_step: bool) -> str:
    """What tells a line of a figure over `key` from the others."""
    others = [f"{k} = {shown(v)}" for k, v in case.varied.items() if k != key and not in_step]
    return ", ".join(text for text in [case.section.name, *others] if text)


def _parts(items: Sequence[Any], size: int = LINES) -> Iterator[Sequence[Any]]:
    for first in range(0, len(items), size):
        yield items[first : first + size]


def _style(k: int, points: int) -> dict[str, Any]:
    marker, line = MARKERS[k % len(MARKERS)], line_through(points, "-" if k < 10 else "--")
    return {"color": f"C{k % 10}", "marker": marker, "ms": 3, "ls": line}


def axes_grid(
    count: int, width: float = 4.2, height: float = 3.6, columns: int = 3
) -> tuple[Figure, list[Axes]]:
    """A figure with panels of a width and height (inches), so many side by side."""
    columns = min(columns, count)
    rows = -(-count // columns)
    figure = new_figure(figsize=(width * columns, height * rows), layout="constrained")
    return figure, [figure.add_subplot(rows, columns, k + 1) for k in range(count)]


def _name(axes: Axes, title: str, ylabel: str, xlabel: str) -> None:
    axes.set(xlabel=xlabel, ylabel=ylabel)
    axes.set_title(textwrap.fill(title, TITLE_LETTERS), fontsize=9)
    axes.grid(alpha=0.3)
    axes.ticklabel_format(axis="y", useOffset=False)


def _add_legend(figure: Figure, axes: Sequence[Axes]) -> None:
    """That of the first panel, below all."""
    handles, labels = axes[0].get_legend_handles_labels()
    if any(labels):
        columns = max(1, min(4, len(labels), LETTERS // max(map(len, labels))))
        figure.set_figheight(figure.get_figheight() + 0.2 * -(-len(labels) // columns))
        figure.legend(handles, labels, loc="outside lower center", ncols=columns, fontsize=8)


def as_png(figure: Figure) -> bytes:
    """The picture of a figure in a page."""
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=110)
    return file.getvalue()
