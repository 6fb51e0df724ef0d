"""Parts that the reports of all systems have: the figures of the results folder, versions and times."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from swgpar.results import html_page
from swgpar.results.figure_set import FOLDER
from swgpar.results.html_page import image, table

STYLE = (
    html_page.STYLE
    + """
h1 { font-size: 1.5em; } h2 { margin-top: 1.6em; border-bottom: 1px solid #bbb; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 30em), 1fr)); gap: 0 1.5em; }
.wide { grid-column: 1 / -1; text-align: center; }
@media (max-width: 40em) {
  body { margin: 1em auto; }
  .cards th { display: none; } .cards tr { display: block; padding: .4em 0; border-bottom: 1px solid #ddd; }
  .cards td { display: inline-block; border: 0; padding: 0 .5em 0 0; text-align: left; }
  .cards td:empty { display: none; }
  .cards td:first-child { display: block; font-weight: bold; } .cards td:nth-child(n + 5) { display: block; }
}
"""
)


def figures(folder: Path | None, names: Iterable[str], wide: Collection[str] = ()) -> str:
    """The figures that the folder has, of those with these names. wide : those that take the width of the page"""
    paths = [folder / FOLDER / f"{name}.png" for name in names] if folder is not None else []
    images = [
        f"<div{' class=wide' if path.stem in wide else ''}>"
        f"{image(path.read_bytes(), path.stem.replace('_', ' '))}</div>"
        for path in paths
        if path.exists()
    ]
    return f'<div class="figures">{"".join(images)}</div>' if images else ""


def cards(header: Sequence[str], rows: Iterable[tuple[Sequence[Any], bool]]) -> str:
    """A table, as `html_page.table` makes it, whose rows are blocks under each other on a narrow page."""
    return f'<div class="cards">{table(header, rows)}</div>'


def versions(summary: Mapping[str, Any]) -> str:
    """Versions, ranks, time and memory of a run."""
    rows: list[tuple[list[Any], bool]] = [([name, str(value)], False) for name, value in summary["versions"].items()]
    for name, text, unit in (("ranks", "MPI ranks", ""), ("wall_s", "time", "s")):
        if summary.get(name) is not None:
            rows.append(([text, f"{summary[name]:.4g} {unit}".strip()], False))
    if memory := summary.get("peak_memory_MB_per_rank"):
        rows.append((["largest memory of a rank", f"{max(memory):.0f} MB"], False))
    return table(["", "version or amount"], rows)


def inputs(design: Mapping[str, Any]) -> str:
    """The whole design, defaults included, as the lines of a design file."""
    lines: list[str] = []

    def section(title: str, content: Mapping[str, Any]) -> None:
        plain = {key: value for key, value in content.items() if value is not None and not isinstance(value, Mapping)}
        lines.extend(["", f"[{title}]"] if plain else [])
        lines.extend(f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in plain.items())
        for key, value in content.items():
            if isinstance(value, Mapping):
                section(f"{title}.{key}", value)

    for title, content in design.items():
        if isinstance(content, Mapping):
            section(title, content)
    text = escape("\n".join(lines).strip())
    return f"<details><summary>The design, defaults included</summary><pre>{text}</pre></details>"
