"""What a person sees of the run of a gear train: report.html, the comparison on the terminal."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich import box
from rich import table as terminal

from swgpar.gear_trains.published import numbered
from swgpar.gear_trains.result import TrainResult
from swgpar.log import console
from swgpar.results.page import Row, Table
from swgpar.results.result_page import RunFacts, result_page


def train_report(result: TrainResult) -> bytes:
    """The whole page; reads the figures in the results folder. Call it on one rank."""
    summary, design = result.summary, result.design_table
    rows = [
        Row([name, float(value)])
        for key, numbers in result.quantities.items()
        for name, value in zip(numbered(key, np.size(numbers)), np.ravel(numbers), strict=True)
    ]
    compared = [Row(list(row.values())) for row in result.compared]
    return result_page(
        "gear_trains/train_report.html.j2",
        f"Gear train: {str(design['gear_train']['model']).replace('_', ' ')}",
        RunFacts(design, summary["versions"], summary.get("ranks"), summary.get("wall_s")),
        result.folder,
        result.plot.names,
        answers=Table(["quantity", "value"], rows),
        compared=Table(list(result.compared[0]), compared) if compared else None,
    )


def print_compared(rows: list[dict[str, Any]]) -> None:
    """The table of published against computed values; call it on one rank."""
    if not rows:
        return
    title = "published against computed"
    table = terminal.Table(title=title, box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for name in ("quantity", "published", "computed", "difference"):
        table.add_column(name, justify="left" if name == "quantity" else "right", no_wrap=True)
    for row in rows:
        percent = row["difference_percent"]
        numbers = f"{row['published']:.6g}", f"{row['computed']:.6g}"
        table.add_row(row["quantity"], *numbers, "" if percent is None else f"{percent:+.2f} %")
    console.print(table)
