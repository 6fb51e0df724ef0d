"""report.html: what a run of a gear train gives, on one page that needs nothing else."""

from __future__ import annotations

import numpy as np

from swgpar.gear_trains.published import numbered
from swgpar.gear_trains.result import TrainResult
from swgpar.results.page import Row, Table
from swgpar.results.result_page import RunFacts, result_page


def train_report(result: TrainResult) -> bytes:
    """The whole page; reads the figures in the results folder. Call it on one rank."""
    summary, design = result.summary, result.design_table
    title = f"Gear train: {str(design['gear_train']['model']).replace('_', ' ')}"
    rows = [
        Row([name, float(value)])
        for key, found in result.quantities.items()
        for name, value in zip(numbered(key, np.size(found)), np.ravel(found), strict=True)
    ]
    compared = [Row(list(row.values())) for row in result.compared]
    return result_page(
        "gear_trains/train_report.html.j2",
        title,
        RunFacts(design, summary["versions"], summary.get("ranks"), summary.get("wall_s")),
        result.folder,
        result.plot.names,
        answers=Table(["quantity", "value"], rows),
        compared=Table(list(result.compared[0]), compared) if compared else None,
    )
