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
pre { background: #f4f4f4; padding: .8em; overflow-x: auto; }
"""


def page(title: str, parts: Iterable[str], style: str = STYLE) -> bytes:
    """The whole file. parts : pieces of HTML"""
    head = (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<meta name="viewport" content="width=device-width, initial-scale=1"><title>{escape(title)}</title>'
    )
    return f"{head}<style>{style}</style></head><body>\n{chr(10).join(parts)}\n</body></html>\n".encode()


def table(header: Sequence[str], rows: Iterable[tuple[Sequence[Any], bool]]) -> str:
    """An HTML table. rows : cells and whether something is wrong; texts stand on the left, numbers on the right."""
    body, texts = [], [True] * len(header)
    for cells, bad in rows:
        line = "".join(
            f"<td{' class=text' if isinstance(cell, str) else ''}>{escape(number(cell))}</td>" for cell in cells
        )
        body.append(f"<tr{' class=bad' if bad else ''}>{line}</tr>")
        texts = [text and isinstance(cell, str) for text, cell in zip(texts, cells, strict=True)]
    heads = (
        f"<th{' class=text' if text else ''}>{escape(name)}</th>" for name, text in zip(header, texts, strict=True)
    )
    return "\n".join(["<div class=scroll><table><tr>" + "".join(heads) + "</tr>", *body, "</table></div>"])


def number(value: Any) -> str:
    """A value in a table: five digits, nothing for None."""
    if value is None:
        return ""
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def image(png: bytes, text: str) -> str:
    """A picture in the file itself. text : what it shows"""
    return f'<p><img alt="{escape(text)}" src="data:image/png;base64,{base64.b64encode(png).decode()}"></p>'
