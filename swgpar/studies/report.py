"""study.html: tables, figures and failures of a study in one file that needs nothing else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from swgpar.results.figure_set import import_matplotlib
from swgpar.results.html_page import RANK, RANKING, image, page, table, with_unit
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

ESTIMATE = (
    "The error estimate is Richardson's extrapolation from the last two meshes of a case: with element sizes "
    "h1 &gt; h2 that follow from the numbers of elements (n<sup>-1/3</sup>, in plane models n<sup>-1/2</sup>) and an "
    "error that falls with h, converged = f2 + (f2 - f1) / (h1/h2 - 1), and the estimate is |converged - f2|. It "
    "holds when both meshes resolve the stress and all directions were refined alike. Under edge contact (no "
    "micro-geometry) and for |s3| below the tooth contact it means nothing: the stress then grows with the mesh."
)
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


def make_report(
    study: Study, results: Sequence[Result], comparisons: Sequence[Comparison], out: Path, missing: int = 0
) -> bytes:
    """The whole page; reads the logs of failed cases below `out`. Call it on one rank.

    missing : number of runs that have not ended; their report has no figures
    """
    title = study.title
    parts = [f"<h1>{escape(title)}</h1>", _introduction(study, results)]
    if missing:
        parts.append(
            f"<p class=bad>{missing} more runs have not ended. Figures are drawn when all have: swgpar study with "
            "--restart continues.</p>"
        )
    if comparisons:
        parts += ["<h2>Published values</h2>", _comparisons(comparisons)]
    parts += [
        "<h2>Cases</h2>",
        RANKING,
        _cases(results),
        "<h2>Quantities</h2>",
        _meanings(results),
    ]
    if ranked := _extremes(results):
        parts += ["<h2>Smallest and largest</h2>", ranked]
    estimates = _estimates(complete(results))
    if estimates or any(c.estimate for c in comparisons):
        parts += ["<h2>Error estimates from meshes</h2>", f"<p>{ESTIMATE}</p>", estimates]
    parts += _failures(results, out)
    try:
        if not missing:
            import_matplotlib()
            parts += _figures(study, results)
    except Exception as error:  # a picture that fails must not cost the report
        parts.append(f"<p class=bad>Figures could not be drawn: {escape(str(error))}</p>")
    if study.section.remarks:
        parts.append("<h2>Remarks</h2>")
        parts += [f"<p>{escape(text)}</p>" for text in study.section.remarks.strip().split("\n\n")]
    parts += ["<h2>Study file</h2>", f"<pre>{escape(study.text)}</pre>", RANK]
    return page(title, parts)


def _introduction(study: Study, results: Sequence[Result]) -> str:
    failed = sum(outcome.status == "failed" for _, outcome in results)
    seconds = sum(outcome.wall_s or 0.0 for _, outcome in results)
    text = f"swgpar {__version__}: {len(results)} runs, {failed} failed, {seconds:.0f} s of computing."
    return f"<p>{text} Design: {escape(study.section.design)}.</p>"


def _cases(results: Sequence[Result]) -> str:
    rows: list[Mapping[str, Any]] = study_rows(results)
    header = [name for name in rows[0] if name != "reason"]
    notes = {job.case.name: job.case.section.note for job, _ in results}
    if any(notes.values()):
        header.append("note")
        rows = [{**row, "note": notes[row["case"]]} for row in rows]
    units = units_of_keys(results) | {name: quantity.unit for name, quantity in shown_quantities(results).items()}
    heads = [HEADINGS.get(name) or with_unit(name, units.get(name, "")) for name in header]
    return table(heads, (([row[name] for name in header], row["status"] == "failed") for row in rows), ranked=True)


def _extremes(results: Sequence[Result]) -> str:
    """Which case has the smallest and the largest value of every quantity, each case on its finest mesh."""
    found = [(case.name, outcomes[-1].values) for case, outcomes in by_case(results)]
    rows: list[tuple[list[Any], bool]] = []
    for name, quantity in shown_quantities(results).items():
        values = sorted((values[name], case) for case, values in found if name in values)
        if len(values) > 1:
            (low, of_low), (high, of_high) = values[0], values[-1]
            rows.append(([with_unit(name, quantity.unit), low, of_low, high, of_high], False))
    return table(["quantity", "smallest", "of case", "largest", "of case"], rows) if rows else ""


def _comparisons(comparisons: Sequence[Comparison]) -> str:
    rows = published_rows(comparisons)
    heads = [HEADINGS.get(name, name) for name in rows[0]]
    return table(heads, ((list(row.values()), row["verdict"] == "MISS") for row in rows))


def _meanings(results: Sequence[Result]) -> str:
    rows = [([name, q.meaning, q.unit], False) for name, q in shown_quantities(results).items()]
    return table(["quantity", "meaning", "unit"], rows)


def _estimates(results: Sequence[Result]) -> str:
    rows = []
    for case, outcomes in by_case(results):
        for name in case.shown:
            found = estimate_of(case, outcomes, name)
            if found:
                values = [outcome.values[name] for outcome in outcomes[-2:]]
                percent = 100.0 * found.error / abs(values[1]) if values[1] else None
                unit = case.known[name].unit if name in case.known else ""
                rows.append(([case.name, with_unit(name, unit), *values, found.converged, found.error, percent], False))
    header = ["case", "quantity", "coarser mesh", "finest mesh", "converged", "error estimate", "error estimate (%)"]
    return table(header, rows) if rows else ""


def _failures(results: Sequence[Result], out: Path) -> list[str]:
    parts = []
    for job, outcome in results:
        if outcome.status == "failed":
            parts.append(f"<h3>{escape(job.title)}</h3><p class=bad>{escape(outcome.reason)}</p>")
            log = job.folder(out) / "run.log"
            if log.exists():
                lines = log.read_text(encoding="utf-8", errors="replace").splitlines()[-LOG_LINES:]
                parts.append(f"<pre>{escape(chr(10).join(lines))}</pre>")
    return ["<h2>Failures</h2>", *parts] if parts else []


def _figures(study: Study, results: Sequence[Result]) -> list[str]:
    parts = [image(png, "stresses against angle") for png in figures.over_angle(results)]
    if parts:
        parts.insert(0, "<h2>Stresses against the angle of the wave generator</h2>")
    for key in dict.fromkeys(key for job, _ in results for key in job.case.varied):
        drawn = figures.over_key(results, key, in_step=study.section.mode == "sweep")
        images = [image(png, f"quantities against {key}") for png in drawn]
        if images:
            parts += [f"<h2>Against {escape(key)}</h2>", *images]
    return parts
