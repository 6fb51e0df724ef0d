"""What a person sees of the run of a gear train: report.html, answers on the terminal."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
from rich import box
from rich import table as terminal

from swgpar.gear_trains.published import Comparison
from swgpar.gear_trains.result import TrainResult, TrainSummary
from swgpar.log import console
from swgpar.presentation.answer_text import answer_table, detail_table, value_text
from swgpar.results.number_tables import Labels, number_tables
from swgpar.results.page import Table
from swgpar.results.result_page import RunFacts, result_page


def train_report(result: TrainResult) -> bytes:
    """The whole page; reads the figures in the results folder. Call it on one rank."""
    summary = result.summary
    compared = [asdict(row) for row in result.compared]
    rows = [list(row.values()) for row in compared]
    return result_page(
        "gear_trains/train_report.html.j2",
        f"Gear train: {result.design_table['gear_train']['model'].replace('_', ' ')}",
        RunFacts(result.design_table, summary.versions, summary.ranks, summary.wall_s),
        result.folder,
        result.plot.names,
        answers=answer_table(answer for answer in summary.values() if not answer.detail),
        details=detail_table(summary),
        compared=Table(list(compared[0]), rows) if compared else None,
    )


def print_train(result: TrainResult) -> None:
    """Print the answers and the published values beside them; call it on one rank."""
    _print_answers(result.summary)
    if result.compared:
        _print_compared(result.compared)


def _print_answers(summary: TrainSummary) -> None:
    """A row for each quantity, its numbers beside each other."""
    table = terminal.Table(title="answers", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for name in ("", "value", "unit"):
        table.add_column(name, overflow="fold")
    for name, found in summary.quantities.items():
        if not (kind := summary.known[name]).detail:
            numbers = [value_text(v if np.isfinite(v) else None) for v in np.atleast_1d(found)]
            table.add_row(kind.meaning, ", ".join(numbers), kind.unit)
    console.print(table)


def _print_compared(rows: list[Comparison]) -> None:
    percent = [row.difference_percent for row in rows]
    columns = {
        "value": [f"{row.published:.6g}" for row in rows],
        "computed": [f"{row.computed:.6g}" for row in rows],
        "difference": ["" if one is None else f"{one:+.2f} %" for one in percent],
    }
    labels = Labels("quantity, source", [f"{row.quantity}, {row.source}" for row in rows])
    title = "published and measured against computed"
    for table in number_tables(labels, columns, console.width, title):
        console.print(table)
