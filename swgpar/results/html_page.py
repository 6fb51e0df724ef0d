"""Parts of a page of HTML that is one file and needs nothing else: tables, pictures, the frame around them."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

STYLE = """
body { font: 15px/1.45 sans-serif; margin: 2em auto; max-width: 84em; padding: 0 1em; color: #222; }
table { border-collapse: collapse; margin: 1em 0; }
th, td { padding: .25em .8em; border-bottom: 1px solid #ddd; text-align: right; vertical-align: top; }
th { border-bottom: 2px solid #888; }
.text { text-align: left; }
.bad td, .bad { color: #a40000; }
.scroll { overflow-x: auto; }
img { max-width: 100%; }
.long { min-width: 16em; }
.ranked th { cursor: pointer; text-decoration: underline dotted; }
pre { background: #f4f4f4; padding: .8em; overflow-x: auto; }
"""

RANK = """<script>
"use strict";
document.querySelectorAll(".ranked").forEach(table => table.querySelectorAll("th").forEach((head, column) => {
  let sign = -1;
  head.addEventListener("click", () => {
    sign = -sign;
    const value = row => row.cells[column].dataset.value ?? row.cells[column].textContent;
    const compare = (a, b) => (a === "") - (b === "") || sign * (a - b || (isNaN(a - b) ? a.localeCompare(b) : 0));
    const rows = [...table.rows].slice(1).sort((a, b) => compare(value(a), value(b)));
    rows.forEach(row => row.parentNode.append(row));
  });
}));
</script>"""
"""Puts the rows of ranked tables in the order of the column whose heading is clicked."""

RANKING = "<p>A click on a heading puts the rows in the order of its column, a second one reverses it.</p>"

LONG = 30
"""Letters from which a cell keeps a width at which it can be read."""


def page(title: str, parts: Iterable[str], style: str = STYLE) -> bytes:
    """The whole file. parts : pieces of HTML"""
    head = (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<meta name="viewport" content="width=device-width, initial-scale=1"><title>{escape(title)}</title>'
    )
    return f"{head}<style>{style}</style></head><body>\n{chr(10).join(parts)}\n</body></html>\n".encode()


def table(header: Sequence[str], rows: Iterable[tuple[Sequence[Any], bool]], *, ranked: bool = False) -> str:
    """An HTML table in a container that scrolls; texts stand on the left, numbers on the right.

    rows : cells and whether something is wrong;  ranked : whether headings order the rows, by `RANK` on the page
    """
    body, texts = [], [True] * len(header)
    for cells, bad in rows:
        line = "".join(map(_cell, cells))
        body.append(f"<tr{' class=bad' if bad else ''}>{line}</tr>")
        texts = [text and isinstance(cell, str) for text, cell in zip(texts, cells, strict=True)]
    heads = (
        f"<th{' class=text' if text else ''}>{escape(name)}</th>" for name, text in zip(header, texts, strict=True)
    )
    kind = " class=ranked" if ranked else ""
    return "\n".join([f"<div class=scroll><table{kind}><tr>" + "".join(heads) + "</tr>", *body, "</table></div>"])


def _cell(value: Any) -> str:
    text = escape(number(value))
    if isinstance(value, str):
        kind = '"text long"' if len(value) > LONG else "text"
        return f"<td class={kind}>{text}</td>"
    exact = f' data-value="{value!r}"' if isinstance(value, float) else ""
    return f"<td{exact}>{text}</td>"


def with_unit(name: str, unit: str) -> str:
    """A heading: the name and, where there is one, the unit."""
    return f"{name} ({unit})" if unit else name


def number(value: Any) -> str:
    """A value in a table: five digits, nothing for None."""
    if value is None:
        return ""
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def image(png: bytes, text: str) -> str:
    """A picture in the file itself. text : what it shows"""
    return f'<p><img alt="{escape(text)}" src="data:image/png;base64,{base64.b64encode(png).decode()}"></p>'
