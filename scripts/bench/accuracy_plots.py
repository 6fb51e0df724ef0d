"""Log-log plots of error against wall seconds and against peak memory: a panel for every problem
and quantity."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

AXES = {"seconds": "wall seconds", "memory_MB": "peak memory (MB)"}
FLOOR = 1e-9
"""Errors below are drawn here."""


def plot(rows: list[dict[str, Any]], folder: Path, family: str) -> list[Path]:
    """A figure against seconds and one against memory; returns their paths."""
    panels = list(dict.fromkeys((r["problem"], r["quantity"]) for r in rows))
    choices = list(dict.fromkeys(r["choice"] for r in rows))
    columns = min(3, len(panels))
    lines = -(-len(panels) // columns)
    paths = []
    for key, text in AXES.items():
        figure = Figure(
            figsize=(4.2 * columns, 2.9 * lines + 0.2 * (2 + len(choices) // 4)),
            layout="constrained",
        )
        handles: dict[str, Line2D] = {}
        for place, (problem, quantity) in enumerate(panels, start=1):
            axes = figure.add_subplot(lines, columns, place)
            here = [r for r in rows if (r["problem"], r["quantity"]) == (problem, quantity)]
            for choice in dict.fromkeys(r["choice"] for r in here):
                mine = [r for r in here if r["choice"] == choice]
                number = choices.index(choice)
                style = {
                    "color": f"C{number % 10}",
                    "marker": "os^vDPX*"[number % 8],
                    "ms": 4,
                    "lw": 1.2,
                }
                errors = np.maximum([r["error"] for r in mine], FLOOR)
                (handles[choice],) = axes.loglog(
                    [r[key] for r in mine], errors, label=choice, **style
                )
                for row, error in zip(mine, errors):
                    if isinstance(row["level"], str):
                        axes.annotate(
                            row["level"],
                            (row[key], error),
                            (3, 3),
                            textcoords="offset points",
                            fontsize=6,
                        )
            axes.set_title(f"{problem}: {quantity}", fontsize=9)
            axes.set_xlabel(text, fontsize=8)
            axes.set_ylabel("relative error", fontsize=8)
            axes.tick_params(labelsize=7, which="both")
            for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
                if high < 100.0 * low:  # decades alone would leave too few labels
                    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
                    axis.set_major_formatter(FormatStrFormatter("%g"))
                axis.set_minor_formatter(NullFormatter())
            axes.grid(alpha=0.3)
        figure.legend(handles.values(), handles, loc="outside lower center", ncols=4, fontsize=8)
        path = folder / f"accuracy_{family}_{key.split('_')[0]}.png"
        figure.savefig(path, dpi=110)
        paths.append(path)
    return paths
