"""Tables on the terminal whose numbers stay whole: what does not fit beside each other is divided
into several tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from rich import box
from rich.table import Table

BETWEEN = 2
"""Blanks behind a column."""

EDGE = 1
"""Blanks before the first column."""

HEADING = 22
"""Letters of a heading, beyond which it is folded where the cells below are shorter."""

LABEL = 12
"""Letters to which the first column may be folded."""


@dataclass(frozen=True)
class Labels:
    """The first column of all tables. texts : are folded;  justify : "left" or "right" """

    heading: str
    texts: Sequence[str]
    justify: Literal["left", "right"] = "left"


def number_tables(
    labels: Labels, columns: Mapping[str, Sequence[str]], width: int, title: str = ""
) -> Iterator[Table]:
    """Tables that are at most as wide as the terminal; each begins with the labels.

    columns : cells below their headings, one for each label;  width : letters of a line
    title : of the first table
    """
    letters = {
        name: max([*map(len, cells), min(len(name), HEADING)]) for name, cells in columns.items()
    }
    longest = max(map(len, [labels.heading, *labels.texts]))
    free = width - EDGE - BETWEEN  # beside the labels
    room = free - max(letters.values(), default=0) - BETWEEN
    whole = free - sum(count + BETWEEN for count in letters.values())  # beside all columns
    first = min(longest, max(LABEL, min(room, width // 3), whole))
    for names in _blocks(letters, free - first):
        table = Table(title=title, box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
        table.add_column(labels.heading, width=first, justify=labels.justify, overflow="fold")
        for name in names:
            table.add_column(name, width=letters[name], justify="right", overflow="fold")
        for k, text in enumerate(labels.texts):
            table.add_row(text, *(columns[name][k] for name in names))
        yield table
        title = ""


def _blocks(letters: Mapping[str, int], room: int) -> list[list[str]]:
    """Names of columns (letters wide) divided so that those of a table fit into the room."""
    blocks: list[list[str]] = [[]]
    for name in letters:
        if blocks[-1] and sum(letters[one] + BETWEEN for one in [*blocks[-1], name]) > room:
            blocks.append([])
        blocks[-1].append(name)
    return blocks
