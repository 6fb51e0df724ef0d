"""Numbers on narrow terminals are whole: tables of numbers, studies, gear trains."""

from __future__ import annotations

import io
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from rich.console import Console

import swgpar
from support.paths import DRIVERS
from swgpar.gear_trains import report
from swgpar.presentation.answer_text import value_text
from swgpar.results.number_tables import Labels, number_tables
from swgpar.results.page import number
from swgpar.results.quantity import Quantity
from swgpar.studies import terminal

WIDTHS = pytest.mark.parametrize("width", [60, 80])
LONG = "load.torque = 34.5, flexible_spline.rim = 0.75, plane_fine"


class Shown:
    """What is printed. text, words : of all lines"""

    def __init__(self, width: int) -> None:
        self.file = io.StringIO()
        self.console = Console(file=self.file, width=width, soft_wrap=False)
        self.width = width

    @property
    def words(self) -> list[str]:
        lines = self.file.getvalue().splitlines()
        assert all(len(line) <= self.width for line in lines)
        return " ".join(lines).split()


@WIDTHS
def test_tables_are_divided(width: int) -> None:
    columns = {f"a heading of the column {k}": [f"{k}.123456789", "-1.23457e-05"] for k in range(9)}
    shown = Shown(width)
    for table in number_tables(Labels("case", ["short", LONG]), columns, width, "all of them"):
        shown.console.print(table)
    for cells in columns.values():
        assert set(cells) <= set(shown.words)
    assert shown.words.count("-1.23457e-05") == 9
    assert shown.words.count("short") == shown.words.count("case") > 1
    assert " ".join(shown.words).count("all of them") == 1
    assert "heading" in shown.words and "column" in shown.words


@pytest.mark.parametrize("width", range(50, 90))
def test_a_heading_of_one_word_is_whole(width: int) -> None:
    columns = {name: ["12345.6"] for name in ("published", "computed", "difference", "estimate")}
    shown = Shown(width)
    for table in number_tables(Labels("case", [LONG]), columns, width):
        shown.console.print(table)
    assert {*columns, "12345.6"} <= set(shown.words)


@WIDTHS
def test_the_tables_of_a_study(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    shown = Shown(width)
    monkeypatch.setattr(terminal, "console", shown.console)
    names = "mean.fs_s1", "contact.pressure", "stiffness.K1", "rotation.transmission_error"
    quantities = {name: Quantity("MPa", "what it is") for name in names}
    monkeypatch.setattr(terminal, "shown_quantities", lambda results: quantities)
    values = {name: -123456.0 * (k + 1) / 7 for k, name in enumerate(names)}
    outcome = SimpleNamespace(status="finished", values=values, wall_s=1234.5)
    compared = SimpleNamespace(
        case=LONG,
        quantity=names[-1],
        published=1234.56,
        computed=-0.000123456,
        difference_percent=-12.345,
        error_estimate=0.0012345,
        verdict="within the error",
    )
    results = cast(Any, [(SimpleNamespace(title=LONG), outcome)])
    terminal.print_results(results, cast(Any, [compared]))
    numbers = [*values.values(), 1234.5, 1234.56, -0.000123456, -12.345, 0.0012345]
    assert {number(value) for value in numbers} <= set(shown.words)


@WIDTHS
def test_the_answers_of_a_gear_train(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    shown = Shown(width)
    monkeypatch.setattr(report, "console", shown.console)
    result = swgpar.run(DRIVERS / "ring_supported.toml")
    report.print_train(result)
    words = [word.strip(",") for word in shown.words]
    for found in result.summary.quantities.values():
        assert {value_text(value) for value in np.atleast_1d(found)} <= set(words)
    for row in result.compared:
        assert f"{row.published:.6g}" in words and f"{row.computed:.6g}" in words
