"""rating.html: the sheet on one page that needs nothing else."""

from __future__ import annotations

from swgpar.answers.verdict import Judgement
from swgpar.input.toml_file import to_toml
from swgpar.rating.sheet import RatingSheet, RunEntry
from swgpar.rating.texts import (
    amount_text,
    counts_text,
    error_of,
    further_text,
    headline_text,
    limit_text,
    run_text,
)
from swgpar.results.page import Table, page
from swgpar.version import __version__

STYLES = {
    Judgement.PASSES: "ok",
    Judgement.NOT_JUDGED: "none",
    Judgement.WITHIN_ERROR: "near",
    Judgement.FAILS: "look",
}
"""Classes of the template for judgements."""


def rating_page(sheet: RatingSheet) -> bytes:
    """The whole page."""
    rows = [
        {
            "name": one.verdict.name,
            "judgement": str(one.verdict.judgement),
            "style": STYLES[one.verdict.judgement],
            "amount": amount_text(one.verdict),
            "error": error_of(one.verdict),
            "limit": limit_text(one.verdict),
            "case": one.case,
            "further": further_text(one.verdict),
        }
        for one in sheet.rated
    ]
    runs = Table(
        ["run", "torque", "status", "time", "remark", "folder"],
        [_run_cells(run) for run in sheet.runs],
        bad=[k for k, run in enumerate(sheet.runs) if run.status in ("failed", "refused")],
    )
    return page(
        "rating/rating.html.j2",
        sheet.title,
        headline=headline_text(sheet),
        style=STYLES[sheet.headline],
        counts=counts_text(sheet),
        rows=rows,
        runs=runs,
        inputs=to_toml(sheet.design),
        version=__version__,
    )


def _run_cells(run: RunEntry) -> list[str]:
    torque = "" if run.torque is None else f"{run.torque:g} N·m"
    time = "" if run.wall_s is None else f"{run.wall_s:.3g} s"
    return [run.name, torque, run.status, time, run_text(run), run.folder]
