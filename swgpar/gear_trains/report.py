"""report.html: what a run of a gear train gives, on one page that needs nothing else."""

from __future__ import annotations

from html import escape

import numpy as np

from swgpar.gear_trains.published import numbered
from swgpar.gear_trains.result import TrainResult
from swgpar.results.html_page import page, table
from swgpar.results.result_page import STYLE, figures, inputs, versions


def train_report(result: TrainResult) -> bytes:
    """The whole page; reads the figures in the results folder. Call it on one rank."""
    title = f"Gear train: {str(result.summary['design']['gear_train']['model']).replace('_', ' ')}"
    rows = [
        ([name, float(value)], False)
        for key, found in result.quantities.items()
        for name, value in zip(numbered(key, np.size(found)), np.ravel(found), strict=True)
    ]
    parts = [f"<h1>{escape(title)}</h1>", "<h2>Answers</h2>", table(["quantity", "value"], rows)]
    if result.compared:
        header = list(result.compared[0])
        compared = [([row[name] for name in header], row.get("verdict") == "MISS") for row in result.compared]
        parts += ["<h2>Published values</h2>", table(header, compared)]
    if drawn := figures(result.folder, result.plot.names):
        parts += ["<h2>Figures</h2>", drawn]
    parts += ["<h2>Inputs</h2>", inputs(result.summary["design"]), "<h2>Program</h2>", versions(result.summary)]
    return page(title, parts, STYLE)
