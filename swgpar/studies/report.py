"""study.html: tables, figures and failures of a study in one file that needs nothing else."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from swgpar.results.page import Picture, Table
from swgpar.results.quantity import with_unit
from swgpar.studies import figures
from swgpar.studies.runs_page import HEADINGS, FigureSection, runs_page, table_of_runs
from swgpar.studies.spec import Study
from swgpar.studies.table import (
    CaseComparison,
    JobResult,
    by_case,
    complete,
    estimate_of,
    published_rows,
    shown_quantities,
    study_rows,
    units_of_keys,
)

LOG_LINES = 12
"""Of a failed run, in the report."""


@dataclass(frozen=True)
class Failure:
    """A failed run. log : end of its log"""

    title: str
    reason: str
    log: str


def make_report(
    study: Study,
    results: Sequence[JobResult],
    comparisons: Sequence[CaseComparison],
    out: Path,
    missing: int = 0,
) -> bytes:
    """The whole page; reads the logs of failed cases below `out`. Call it on one rank.

    missing : number of runs that have not ended; their report has no figures
    """
    return runs_page(
        "studies/study.html.j2",
        "Study",
        study,
        lambda: [] if missing else _figures(study, results),
        [outcome.wall_s for _, outcome in results],
        runs=len(results),
        failed=sum(outcome.status == "failed" for _, outcome in results),
        missing=missing,
        published=_comparisons(comparisons) if comparisons else None,
        cases=_cases(results),
        meanings=_meanings(results),
        extremes=_extremes(results),
        estimates=_estimates(complete(results)),
        estimated=any(comparison.converged is not None for comparison in comparisons),
        failures=_failures(results, out),
    )


def _cases(results: Sequence[JobResult]) -> Table:
    notes = {job.case.name: job.case.section.note for job, _ in results}
    rows = []
    for row in study_rows(results):
        del row["reason"]  # below the table
        rows.append(row | {"note": notes[row["case"]]} if any(notes.values()) else row)
    quantities = shown_quantities(results).items()
    units = units_of_keys(results) | {name: quantity.unit for name, quantity in quantities}
    return table_of_runs(rows, units)


def _extremes(results: Sequence[JobResult]) -> Table:
    """Which case has the smallest and the largest value of every quantity, each case on its finest
    mesh."""
    finest = [(case.name, outcomes[-1].values) for case, outcomes in by_case(results)]
    rows = []
    for name, quantity in shown_quantities(results).items():
        ordered = sorted((values[name], case) for case, values in finest if name in values)
        if len(ordered) > 1:
            (low, of_low), (high, of_high) = ordered[0], ordered[-1]
            rows.append([with_unit(name, quantity.unit), low, of_low, high, of_high])
    return Table(["quantity", "smallest", "of case", "largest", "of case"], rows)


def _comparisons(comparisons: Sequence[CaseComparison]) -> Table:
    rows = published_rows(comparisons)
    heads = [HEADINGS.get(name, name) for name in rows[0]]
    missed = [k for k, row in enumerate(rows) if row["verdict"] == "MISS"]
    return Table(heads, [list(row.values()) for row in rows], bad=missed)


def _meanings(results: Sequence[JobResult]) -> Table:
    rows = [[name, q.meaning, q.unit] for name, q in shown_quantities(results).items()]
    return Table(["quantity", "meaning", "unit"], rows)


def _estimates(results: Sequence[JobResult]) -> Table:
    rows = []
    for case, outcomes in by_case(results):
        for name in case.shown:
            estimate = estimate_of(case, outcomes, name)
            if estimate:
                coarse, fine = (outcome.values[name] for outcome in outcomes[-2:])
                percent = 100.0 * estimate.error / abs(fine) if fine else None
                title = with_unit(name, case.known[name].unit if name in case.known else "")
                numbers = [coarse, fine, estimate.converged, estimate.error, percent]
                rows.append([case.name, title, *numbers])
    header = ["case", "quantity", "coarser mesh", "finest mesh", "converged"]
    return Table([*header, "error estimate", "error estimate (%)"], rows)


def _failures(results: Sequence[JobResult], out: Path) -> list[Failure]:
    failures = []
    for job, outcome in results:
        if outcome.status == "failed":
            log, end = job.folder(out) / "run.log", ""
            if log.exists():
                lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
                end = "\n".join(lines[-LOG_LINES:])
            failures.append(Failure(job.title, outcome.reason, end))
    return failures


def _figures(study: Study, results: Sequence[JobResult]) -> list[FigureSection]:
    over_angle = [Picture(png, "stresses against angle") for png in figures.over_angle(results)]
    sections = [FigureSection("Stresses against the angle of the wave generator", over_angle)]
    for key in dict.fromkeys(key for job, _ in results for key in job.case.varied):
        drawn = figures.over_key(results, key, in_step=study.section.mode == "sweep")
        pictures = [Picture(png, f"quantities against {key}") for png in drawn]
        sections.append(FigureSection(f"Against {key}", pictures))
    return sections
