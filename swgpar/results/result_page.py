"""Parts that the reports of all systems have: figures, the design, versions and times."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swgpar.input.toml_file import to_toml
from swgpar.results.figure_set import FOLDER
from swgpar.results.page import Picture, Table, page


@dataclass(frozen=True)
class RunFacts:
    """What a report says of the program and the inputs.

    design : the whole design, defaults included;  versions : by program
    ranks : MPI ranks;  wall_s : time, s;  memory_MB : largest of every rank. None or empty if not
        known
    """

    design: Mapping[str, Any]
    versions: Mapping[str, str]
    ranks: int | None = None
    wall_s: float | None = None
    memory_MB: Sequence[float] = ()


def result_page(
    template: str,
    title: str,
    facts: RunFacts,
    folder: Path | None,
    figures: Iterable[str],
    *,
    wide: Collection[str] = (),
    scripts: Sequence[str] = (),
    **values: Any,
) -> bytes:
    """The whole page from a template that extends `results/result_page.html.j2`.

    figures : names of those that are shown where the results folder has them;  wide : those of them
    that take the width of the page;  scripts, values : as of `page`
    """
    paths = [folder / FOLDER / f"{name}.png" for name in figures] if folder is not None else []
    pictures = [
        Picture(path.read_bytes(), path.stem.replace("_", " "), path.stem in wide)
        for path in paths
        if path.exists()
    ]
    common = {"figures": pictures, "inputs": to_toml(facts.design), "versions": _versions(facts)}
    return page(template, title, scripts=scripts, **common, **values)


def _versions(facts: RunFacts) -> Table:
    """Versions, ranks, time and memory of a run."""
    rows = [[name, str(value)] for name, value in facts.versions.items()]
    if facts.ranks is not None:
        rows.append(["MPI ranks", f"{facts.ranks}"])
    if facts.wall_s is not None:
        rows.append(["time", f"{facts.wall_s:.4g} s"])
    if facts.memory_MB:
        rows.append(["largest memory of a rank", f"{max(facts.memory_MB):.0f} MB"])
    return Table(["", "version or amount"], rows)
