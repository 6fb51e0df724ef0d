"""Headings, tables and live texts of the page."""

from __future__ import annotations

from collections.abc import Sequence

from nicegui import ui


def heading(text: str) -> ui.label:
    """A heading of a part of the page."""
    return ui.label(text).classes("text-bold").props("role=heading aria-level=2")


def live_label() -> ui.label:
    """A label whose changes screen readers say; it has to stay on the page."""
    return ui.label().props("role=status")


def say(label: ui.label, text: str) -> None:
    """Show a text in a live label; one that has none takes no place."""
    if label.text != text:
        label.text = text
    label.set_visibility(bool(text))


NOTED = """
<q-td :props="props">{{ props.value }}
  <div class="text-caption text-grey">{{ props.row.note }}</div>
</q-td>
"""
"""A first cell with a note below its text, as Quasar draws it."""


def table(
    headings: Sequence[str], rows: Sequence[Sequence[str]], name: str, notes: Sequence[str] = ()
) -> ui.table:
    """A table whose first column is text, and the others right.

    headings : of the columns;  rows : texts;  name : for screen readers
    notes : below the texts of the first column, none or one for each row
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
    for entry, note in zip(entries, notes, strict=False):
        entry["note"] = note
    made = ui.table(rows=entries, columns=columns, row_key="0")
    made.props("dense flat wrap-cells hide-pagination :rows-per-page-options=[0]")
    made.props["aria-label"] = name
    if notes:
        made.add_slot("body-cell-0", NOTED)
    return made.classes("w-full")
