"""The sheet on the terminal."""

from __future__ import annotations

from rich import box
from rich.table import Table

from swgpar.log import console
from swgpar.rating.sheet import RatingSheet
from swgpar.rating.texts import (
    amount_text,
    counts_text,
    error_of,
    further_text,
    headline_text,
    limit_text,
    run_text,
)


def print_sheet(sheet: RatingSheet) -> None:
    """Print a row for every verdict, what is to know of them, and the headline; call it on one
    rank."""
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))  # fits into 80 columns
    for heading in ("", "verdict"):
        table.add_column(heading, overflow="fold")
    for heading in ("value", "error", "limit"):
        table.add_column(heading, justify="right", no_wrap=True)
    for verdict in sheet.verdicts:
        numbers = amount_text(verdict), error_of(verdict), limit_text(verdict)
        table.add_row(verdict.name, str(verdict.judgement), *numbers)
    console.print(table)
    for verdict in sheet.verdicts:
        if further := further_text(verdict):
            console.print(f"{verdict.name}: {further}", markup=False)
    for run in sheet.runs:
        if text := run_text(run):
            console.print(f"run {run.name}: {text}", markup=False)
    console.print(f"\n{headline_text(sheet)} {counts_text(sheet)}", style="bold", markup=False)
