"""study.html: tables, figures and failures of a study in one file that needs nothing else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swgpar.results.figure_set import import_matplotlib
from swgpar.results.page import RANK, Picture, Row, Table, page
from swgpar.results.quantity import with_unit
from swgpar.studies import figures
from swgpar.studies.spec import Study
from swgpar.studies.table import (
    Comparison,
    Result,
    by_case,
    complete,
    estimate_of,
    published_rows,
    shown_quantities,
    study_rows,
    units_of_keys,
)
from swgpar.version import __version__

HEADINGS = {
    "newton_mean": "Newton iterations, mean",
    "wall_s": "time (s)",
    "difference_percent": "difference (%)",
    "tolerance_percent": "tolerance (%)",
    "error_estimate": "error estimate",
}
"""Of columns of study.csv and published.csv whose names are not those of keys or quantities."""

LOG_LINES = 12
"""Of a failed run, in the report."""


@dataclass(frozen=True)
class Failure:
    """A failed run. log : end of its log"""

    title: str
    reason: str
    log: str


@dataclass(frozen=True)
class FigureSection:
    """Figures below a heading."""

    title: str
    pictures: Sequence[Picture]


def make_report(
    study: Study,
    results: Sequence[Result],
    comparisons: Sequence[Comparison],
    out: Path,
    missing: int = 0,
) -> bytes:
    """The whole page; reads the logs of failed cases below `out`. Call it on one rank.

    missing : number of runs that have not ended; their report has no figures
    """
    sections: list[FigureSection] = []
    failed_figures = ""
    try:
        if not missing:
            import_matplotlib()
            sections = _figures(study, results)
    except Exception as error:  # a picture that fails must not cost the report
        failed_figures = str(error)
    return page(
        "studies/study.html.j2",
        study.title,
        scripts=(RANK,),
        version=__version__,
        runs=len(results),
        failed=sum(outcome.status == "failed" for _, outcome in results),
        seconds=sum(outcome.wall_s or 0.0 for _, outcome in results),
        section=study.section,
        missing=missing,
        published=_comparisons(comparisons) if comparisons else None,
        cases=_cases(results),
        meanings=_meanings(results),
        extremes=_extremes(results),
        estimates=_estimates(complete(results)),
        estimated=any(comparison.estimate for comparison in comparisons),
        failures=_failures(results, out),
        sections=sections,
        failed_figures=failed_figures,
        text=study.text,
    )


def _cases(results: Sequence[Result]) -> Table:
    rows: Sequence[Mapping[str, Any]] = study_rows(results)
    header = [name for name in rows[0] if name != "reason"]
    notes = {job.case.name: job.case.section.note for job, _ in results}
    if any(notes.values()):
        header.append("note")
        rows = [{**row, "note": notes[row["case"]]} for row in rows]
    units = units_of_keys(results) | {
        name: quantity.unit for name, quantity in shown_quantities(results).items()
    }
    heads = [HEADINGS.get(name) or with_unit(name, units.get(name, "")) for name in header]
    shown = [Row([row[name] for name in header], row["status"] == "failed") for row in rows]
    return Table(heads, shown, ranked=True)


def _extremes(results: Sequence[Result]) -> Table:
    """Which case has the smallest and the largest value of every quantity, each case on its finest
    mesh."""
    found = [(case.name, outcomes[-1].values) for case, outcomes in by_case(results)]
    rows = []
    for name, quantity in shown_quantities(results).items():
        values = sorted((values[name], case) for case, values in found if name in values)
        if len(values) > 1:
            (low, of_low), (high, of_high) = values[0], values[-1]
            rows.append(Row([with_unit(name, quantity.unit), low, of_low, high, of_high]))
    return Table(["quantity", "smallest", "of case", "largest", "of case"], rows)


def _comparisons(comparisons: Sequence[Comparison]) -> Table:
    rows = published_rows(comparisons)
    heads = [HEADINGS.get(name, name) for name in rows[0]]
    return Table(heads, [Row(list(row.values()), row["verdict"] == "MISS") for row in rows])


def _meanings(results: Sequence[Result]) -> Table:
    rows = [Row([name, q.meaning, q.unit]) for name, q in shown_quantities(results).items()]
    return Table(["quantity", "meaning", "unit"], rows)


def _estimates(results: Sequence[Result]) -> Table:
    rows = []
    for case, outcomes in by_case(results):
        for name in case.shown:
            found = estimate_of(case, outcomes, name)
            if found:
                values = [outcome.values[name] for outcome in outcomes[-2:]]
                percent = 100.0 * found.error / abs(values[1]) if values[1] else None
                unit = case.known[name].unit if name in case.known else ""
                rows.append(
                    Row(
                        [
                            case.name,
                            with_unit(name, unit),
                            *values,
                            found.converged,
                            found.error,
                            percent,
                        ]
                    )
                )
    header = [
        "case",
        "quantity",
        "coarser mesh",
        "finest mesh",
        "converged",
        "error estimate",
        "error estimate (%)",
    ]
    return Table(header, rows)


def _failures(results: Sequence[Result], out: Path) -> list[Failure]:
    failures = []
    for job, outcome in results:
        if outcome.status == "failed":
            log, end = job.folder(out) / "run.log", ""
            if log.exists():
                lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
                end = "\n".join(lines[-LOG_LINES:])
            failures.append(Failure(job.title, outcome.reason, end))
    return failures


def _figures(study: Study, results: Sequence[Result]) -> list[FigureSection]:
    over_angle = [Picture(png, "stresses against angle") for png in figures.over_angle(results)]
    sections = [FigureSection("Stresses against the angle of the wave generator", over_angle)]
    for key in dict.fromkeys(key for job, _ in results for key in job.case.varied):
        drawn = figures.over_key(results, key, in_step=study.section.mode == "sweep")
        sections.append(
            FigureSection(
                f"Against {key}", [Picture(png, f"quantities against {key}") for png in drawn]
            )
        )
    return sections
