"""report.html: what a run of a drive gives, on one page that needs nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from swgpar.answers.answer import Answer
from swgpar.drive_results.report_checks import checks
from swgpar.drive_results.summary import DriveSummary
from swgpar.presentation.answer_text import answer_table
from swgpar.presentation.drive_drawing import draw_drive
from swgpar.presentation.drive_result import DriveResult
from swgpar.presentation.scene import SCRIPTS, scene
from swgpar.results.page import Table
from swgpar.results.result_page import RunFacts, result_page

WIDE = ("contact_pattern", "deformed_drive", "loaded_teeth", "cup_section", "safety")
"""Figures that take the width of the page."""

FIXED = {
    "ring_fixed": "ring gear fixed",
    "spline_fixed": "flexible spline fixed",
    "wave_generator_fixed": "wave generator fixed, ring gear driven",
}


@dataclass(frozen=True)
class Group:
    """Answers of an evaluation, as a table, and its remarks."""

    title: str
    table: Table
    remarks: list[str]


def drive_report(result: DriveResult) -> bytes:
    """The whole page; reads the figures in the results folder. Call it on one rank."""
    summary, view = result.summary, scene(result)
    design, drive = summary.design, summary.design.drive
    judged = checks(summary, result.history)
    memory = summary.peak_memory_MB_per_rank
    return result_page(
        "presentation/drive_report.html.j2",
        f"Strain wave gear {drive.teeth_fs}/{drive.teeth_rg}, {design.load.torque:g} N·m",
        RunFacts(result.design_table, summary.versions, summary.ranks, summary.wall_s, memory),
        result.folder,
        result.plot.names,
        wide=WIDE,
        scripts=SCRIPTS if view else (),
        description=_description(summary),
        look=[check.name for check in judged if check.good is False],
        strong=all(check.good for check in judged if check.of_strength),
        drawings=draw_drive(design),
        groups=list(_groups(summary, details=False)),
        details=list(_groups(summary, details=True)),
        not_asked=[f"{kind.TITLE} ({kind.ASKED_BY})" for kind in summary.not_asked_for()],
        checks=judged,
        scene=view,
        plane=result.is_plane,
    )


def _description(summary: DriveSummary) -> str:
    drive = summary.design.drive
    model = {"plane": "plane model", "cup": "cup drive", "pancake": "pancake drive"}[drive.model]
    mesh = f"mesh {Path(summary.recipe).stem}, " if summary.recipe else ""
    return (
        f"{model}, ratio {summary.ratio:g}, {FIXED[drive.layout]}; {mesh}{summary.elements} "
        f"elements, {summary.increments} increments."
    )


def _groups(summary: DriveSummary, *, details: bool) -> Iterator[Group]:
    """The answers without details by evaluation, with its remarks; or the details alone, those of a
    region of a body by region."""
    for evaluation in summary.groups():
        parts: dict[str, list[Answer]] = {}
        for answer in evaluation.answers():
            if answer.detail == details:
                _, inside, region = answer.name.partition(" in ")
                title = f"{evaluation.TITLE}: {region}" if inside else evaluation.TITLE
                parts.setdefault(title, []).append(answer)
        remarks = [] if details else list(evaluation.remarks())
        for title, answers in parts.items():
            yield Group(title, answer_table(answers), remarks)
