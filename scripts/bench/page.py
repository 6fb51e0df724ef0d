"""Tables of a benchmark inside a page that is written by hand."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any


def markdown(rows: Iterable[Sequence[str]]) -> str:
    """A table from rows of cells; the first row is the head."""
    first, *others = rows
    return (
        "\n".join(
            "| " + " | ".join(cells) + " |" for cells in [first, ["---"] * len(first), *others]
        )
        + "\n"
    )


DATA = Path("docs/verification/data")


def read_results(name: str) -> list[dict[str, Any]]:
    """Rows of data/NAME.csv of docs/verification, numbers as such; none without the file."""
    if not (DATA / f"{name}.csv").exists():
        return []
    with (DATA / f"{name}.csv").open(newline="", encoding="utf-8") as file:
        return [{key: _value(text) for key, text in row.items()} for row in csv.DictReader(file)]


def _value(text: str) -> float | str | None:
    try:
        return float(text) if text else None
    except ValueError:
        return text


def write_results(
    name: str,
    columns: Sequence[str],
    rows: Sequence[Mapping[str, Any]],
    text: str,
    page: str | None = None,
) -> None:
    """Write these columns of the rows to data/NAME.csv, and `text` into PAGE.md or NAME.md, of
    docs/verification."""
    with (DATA / f"{name}.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n", extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)
    put(DATA.parent / f"{page or name}.md", name, text)


def put(page: Path, name: str, text: str) -> None:
    """Put `text` between the marks `<!-- name -->` and `<!-- end of name -->`, at the end where
    there are none."""
    begin, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
    old = page.read_text(encoding="utf-8") if page.exists() else ""
    if begin not in old:
        old += f"\n{begin}\n{end}\n"
    head, tail = old.partition(begin)[0], old.partition(end)[2]
    page.write_text(f"{head}{begin}\n{text}{end}{tail}", encoding="utf-8")
