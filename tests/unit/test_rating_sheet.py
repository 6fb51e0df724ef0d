"""Views of a rating sheet: terminal, page and files say the same."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from support.html_text import Page
from support.paths import DRIVERS
from swgpar.analysis.forecast import duration_text, forecast
from swgpar.answers.answer import Answer
from swgpar.answers.verdict import Limit, Sense, Verdict
from swgpar.api.ratings import load_rated_design
from swgpar.meshing import load_recipe
from swgpar.rating import terminal
from swgpar.rating.page import rating_page
from swgpar.rating.planned_runs import plan_runs
from swgpar.rating.rate_drive import forecast_text
from swgpar.rating.sheet import RatedVerdict, RatingSheet, RunEntry
from swgpar.rating.texts import counts_text, headline_text
from swgpar.results.atomic import to_json
from swgpar.run_options import RunOptions

STRESS = Answer("largest.fs_vm", 514.8512, "MPa", "stress", error=4.1, place="tooth root")
HYSTERESIS = Answer("stiffness.hysteresis", 4.06684, "arc minutes", "width", error=0.0076)
LIMIT = Limit(1050.0, Sense.AT_MOST, "the maker <b>of</b> it")


@pytest.fixture
def sheet(tmp_path: Path) -> RatingSheet:
    verdicts = (
        Verdict("yield of teeth and rim", STRESS, LIMIT, of_strength=True),
        Verdict("hysteresis", HYSTERESIS, None),
        Verdict("life of the bearing", None, LIMIT, "the run <i>failed</i>"),
    )
    rated = tuple(RatedVerdict(one, "rated torque") for one in verdicts)
    run = RunEntry("rated torque", 0.8, "failed", "runs/rated_torque", reason="it failed")
    return RatingSheet("Rating", rated, (run,), {"drive": {"module": 0.5}}, tmp_path)


@pytest.mark.parametrize("width", [60, 80])
def test_the_terminal_shows_numbers_whole(
    sheet: RatingSheet, width: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = io.StringIO()
    monkeypatch.setattr(terminal, "console", Console(file=text, width=width, soft_wrap=False))
    terminal.print_sheet(sheet)
    shown = text.getvalue()
    assert all(len(line) <= width for line in shown.splitlines())
    for whole in ("514.9 MPa", "±\u00a04.1", "at most 1050", "4.0668 arc minutes"):
        assert whole in shown
    assert "The drive is not judged. No verdict on life of the bearing." in " ".join(shown.split())


def test_the_headline_names_the_rows_that_it_comes_from(sheet: RatingSheet) -> None:
    limit = Limit(500.0, Sense.AT_MOST, "here")
    below = Verdict("below", STRESS, LIMIT)
    rows = {
        "The drive passes.": (below,),
        "The drive is not judged. No verdict on any row.": (Verdict("free", STRESS, None),),
        "The drive is within its errors of a limit: near.": (
            below,
            Verdict("near", STRESS, Limit(517.0, Sense.AT_MOST, "here")),
        ),
        "The drive fails: bad, too.": (
            below,
            Verdict("bad", STRESS, limit),
            Verdict("free", STRESS, None),
            Verdict("too", STRESS, limit),
        ),
        "The computation fails: mesh.": (
            below,
            Verdict("mesh", STRESS, limit, of_computation=True),
        ),
        "The drive fails: bad, mesh.": (
            Verdict("bad", STRESS, limit),
            Verdict("mesh", STRESS, limit, of_computation=True),
        ),
    }
    for words, verdicts in rows.items():
        rated = tuple(RatedVerdict(one, "rated torque") for one in verdicts)
        assert headline_text(replace(sheet, rated=rated)) == words


def test_runs_that_wait_are_counted(sheet: RatingSheet) -> None:
    assert "wait" not in counts_text(sheet)
    waits = RunEntry("stiffness", None, "waits", "runs/stiffness")
    assert counts_text(replace(sheet, runs=(*sheet.runs, waits))).endswith("runs that wait: 1")


def test_the_page_says_what_the_table_says(sheet: RatingSheet) -> None:
    page = rating_page(sheet).decode()
    tags = Page(page)
    assert not tags.open and not tags.links
    assert "<b>of</b>" not in page and "<i>failed</i>" not in page
    assert "the maker &lt;b&gt;of&lt;/b&gt; it" in page
    for words in ("514.9 MPa", "at most 1050", "passes", "not judged", "no requirement"):
        assert words in page


def test_rows_and_runs_are_in_the_file(sheet: RatingSheet) -> None:
    content = json.loads(to_json(sheet.content))
    assert content["headline"] == "not judged"
    first, second, third = content["rows"]
    assert (first["verdict"], first["value"], first["limit"]) == ("passes", 514.8512, 1050.0)
    assert (second["verdict"], second["reason"]) == ("not judged", "no requirement")
    assert (third["value"], third["reason"]) == (None, "the run <i>failed</i>")
    assert content["runs"][0]["status"] == "failed"


def test_a_rating_says_how_long_it_takes() -> None:
    """Longer with a finer mesh."""
    plane = plan_runs(load_rated_design(DRIVERS / "rating.toml"))

    def seconds(mesh: str, accuracy: float | None = None) -> float:
        options = RunOptions(recipe=load_recipe(mesh), accuracy=accuracy)
        text = forecast_text(plane, options)
        assert text.startswith("5 runs, about ") and ("finer" in text) == bool(accuracy)
        number, unit = text.split()[3:5]
        return float(number) * {"s": 1.0, "min": 60.0}[unit]

    assert 1.5 * seconds("plane_coarse") < seconds("plane_fine", 0.02)
    designs = [run.design for run in plane.runs if run.design is not None]
    total = sum(forecast(design, load_recipe("plane_coarse")).seconds for design in designs)
    assert duration_text(total) in forecast_text(
        plane, RunOptions(recipe=load_recipe("plane_coarse"))
    )
