"""The views of the table of answers: terminal, report, quantities and summary.json have the same
numbers."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from rich.console import Console

import swgpar
from support.paths import DATA
from swgpar.drive_results.summary_file import summary_from, summary_to_json
from swgpar.presentation import terminal
from swgpar.presentation.answer_text import error_text, value_text
from swgpar.presentation.drive_report import drive_report
from swgpar.results import history
from swgpar.systems.drive import DRIVE

FOLDERS = sorted((DATA / "first_format").iterdir())


@pytest.fixture(params=FOLDERS, ids=lambda folder: folder.name)
def result(request: pytest.FixtureRequest) -> swgpar.DriveResult:
    return swgpar.open_result(request.param)


def test_numbers_and_remarks_are_whole_on_a_terminal_of_80_columns(
    result: swgpar.DriveResult, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    with open(tmp_path / "out.txt", "w+", encoding="utf-8") as file:
        monkeypatch.setattr(
            terminal, "console", Console(file=file, width=80, highlight=False, soft_wrap=True)
        )
        terminal.print_drive(result.history, result.summary)
        file.seek(0)
        text = file.read()
    rows = text.splitlines()
    for answer in result.summary.values():
        if answer.detail:
            continue
        ending = " ".join(
            filter(None, (value_text(answer.value), error_text(answer.error), answer.unit))
        )
        assert any(" ".join(row.split()).endswith(ending.replace("\u00a0", " ")) for row in rows), (
            answer.name
        )
    assert all(remark in text for group in result.summary.groups() for remark in group.remarks())


def test_the_report_has_every_answer_by_its_name(result: swgpar.DriveResult) -> None:
    page = drive_report(result).decode()
    for name, answer in result.summary.items():
        assert f">{name}<" in page and f"{answer.value:.5g}" in page


def test_the_file_has_the_table_and_gives_the_same_summary_again(
    result: swgpar.DriveResult,
) -> None:
    content = json.loads(summary_to_json(result.summary))
    assert [answer["name"] for answer in content["answers"]] == list(result.summary)
    assert [answer["value"] for answer in content["answers"]] == list(
        DRIVE.measure(result).values.values()
    )
    rows = history.read_history(result.folder / history.NAME)
    assert summary_from(content, rows, result.pairs) == result.summary


def test_an_answer_says_what_it_is() -> None:
    summary = swgpar.open_result(DATA / "first_format" / "plane").summary
    root = summary["root.s1"]
    assert (
        root.unit == "MPa"
        and root.error == summary.root_stress.total_error
        and "tooth root of tooth" in root.place
    )
    assert summary["largest.rg_vm"].remark.startswith("below the contact of teeth")
    assert summary["residue.torque"].value < summary["residue.torque"].limit
    assert summary["fatigue.goodman"].value == summary.fatigue.least["goodman"].safety
    assert "bearing.largest_load" not in summary and summary.get("bearing.largest_load") is None
