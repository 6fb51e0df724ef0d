"""The page of many runs: study.html and optimise.html, each one file that needs nothing else."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from swgpar.results.figure_set import drawn_for_files, import_matplotlib
from swgpar.results.page import RANK, Picture, Table, page
from swgpar.results.quantity import with_unit
from swgpar.studies.run_file import RunFile
from swgpar.version import __version__

HEADINGS = {
    "newton_mean": "Newton iterations, mean",
    "wall_s": "time (s)",
    "difference_percent": "difference (%)",
    "tolerance_percent": "tolerance (%)",
    "error_estimate": "error estimate",
}
"""Of columns of study.csv and published.csv whose names are not those of keys or quantities."""


@dataclass(frozen=True)
class FigureSection:
    """Figures below a heading, and what to know about them."""

    title: str
    pictures: Sequence[Picture]
    text: str = ""


def runs_page(
    template: str,
    kind: str,
    file: RunFile[Any],
    draw: Callable[[], list[FigureSection]],
    seconds: Iterable[float | None],
    **values: Any,
) -> bytes:
    """The page of a study or an optimisation, from a template that extends `studies/runs.html.j2`.

    kind : of the file;  draw : its figures;  seconds : of every run
    values : further ones that the template shows
    """
    sections: list[FigureSection] = []
    failed_figures = ""
    try:
        import_matplotlib()
        with drawn_for_files():
            sections = draw()
    except Exception as error:  # a picture that fails must not cost the report
        failed_figures = str(error)
    common = {"kind": kind, "section": file.section, "text": file.text, "version": __version__}
    return page(
        template,
        file.title,
        scripts=(RANK,),
        seconds=sum(filter(None, seconds)),
        sections=sections,
        failed_figures=failed_figures,
        **common,
        **values,
    )


def table_of_runs(rows: Sequence[Mapping[str, Any]], units: Mapping[str, str]) -> Table:
    """Rows of runs with a status, to be ordered. units : of columns that are keys or quantities"""
    heads = [HEADINGS.get(name) or with_unit(name, units.get(name, "")) for name in rows[0]]
    failed = [k for k, row in enumerate(rows) if row["status"] == "failed"]
    return Table(heads, [list(row.values()) for row in rows], ranked=True, bad=failed)
