"""Parts that the reports of all systems have: the figures of the results folder, the design, versions and times."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from swgpar.input.toml_file import to_toml
from swgpar.results.figure_set import FOLDER
from swgpar.results.page import Picture, Row, Table, page


def result_page(
    template: str,
    title: str,
    summary: Mapping[str, Any],
    folder: Path | None,
    figures: Iterable[str],
    *,
    wide: Collection[str] = (),
    scripts: Sequence[str] = (),
    **values: Any,
) -> bytes:
    """The whole page from a template that extends `results/result_page.html.j2`.

    figures : names of those that are shown where the results folder has them;  wide : those of them that take the
    width of the page;  scripts, values : as of `page`
    """
    paths = [folder / FOLDER / f"{name}.png" for name in figures] if folder is not None else []
    pictures = [
        Picture(path.read_bytes(), path.stem.replace("_", " "), path.stem in wide) for path in paths if path.exists()
    ]
    common = {"figures": pictures, "inputs": to_toml(summary["design"]), "versions": _versions(summary)}
    return page(template, title, scripts=scripts, **common, **values)


def _versions(summary: Mapping[str, Any]) -> Table:
    """Versions, ranks, time and memory of a run."""
    rows = [Row([name, str(value)]) for name, value in summary["versions"].items()]
    for name, text, unit in (("ranks", "MPI ranks", ""), ("wall_s", "time", "s")):
        if summary.get(name) is not None:
            rows.append(Row([text, f"{summary[name]:.4g} {unit}".strip()]))
    if memory := summary.get("peak_memory_MB_per_rank"):
        rows.append(Row(["largest memory of a rank", f"{max(memory):.0f} MB"]))
    return Table(["", "version or amount"], rows)
