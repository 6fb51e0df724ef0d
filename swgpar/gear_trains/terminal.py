"""What a user sees on the terminal after the run of a gear train."""

from __future__ import annotations

from typing import Any

from rich import box
from rich.table import Table

from swgpar.log import console


def print_compared(rows: list[dict[str, Any]]) -> None:
    """The table of published against computed values; call it on one rank."""
    if not rows:
        return
    table = Table(title="published against computed", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for title in ("quantity", "published", "computed", "difference"):
        table.add_column(title, justify="left" if title == "quantity" else "right", no_wrap=True)
    for row in rows:
        percent = row["difference_percent"]
        difference = "" if percent is None else f"{percent:+.2f} %"
        table.add_row(
            row["quantity"], f"{row['published']:.6g}", f"{row['computed']:.6g}", difference
        )
    console.print(table)
