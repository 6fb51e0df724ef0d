"""Tables of the page."""

from __future__ import annotations

from collections.abc import Sequence

from nicegui import ui


def table(headings: Sequence[str], rows: Sequence[Sequence[str]], name: str) -> ui.table:
    """A table whose first column is text, and the others right.

    headings : of the columns;  rows : texts;  name : for screen readers
    """
    columns = [
        {
            "name": str(k),
            "label": heading,
            "field": str(k),
            "align": "left" if k == 0 else "right",
        }
        for k, heading in enumerate(headings)
    ]
    entries = [{str(k): text for k, text in enumerate(row)} for row in rows]
    made = ui.table(rows=entries, columns=columns, row_key="0")
    made.props("dense flat wrap-cells hide-pagination :rows-per-page-options=[0]")
    made.props["aria-label"] = name
    return made.classes("w-full")
