"""What a user sees on the terminal after the run of a drive."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from rich.console import Group
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from swgpar.answers.answer import AnswerGroup
from swgpar.drive_results.summary import DriveSummary
from swgpar.log import console, ranks_text
from swgpar.presentation.answer_text import error_text, remark_text, value_text
from swgpar.results.number_tables import Labels, number_tables

COLUMNS = {
    "step": ("step", "d"),
    "wg_angle_deg": ("input", ".1f"),
    "output_angle_deg": ("output", ".4f"),
    "fs_s1": ("fs s1", ".1f"),
    "fs_s3": ("fs |s3|", ".1f"),
    "fs_vm": ("fs vm", ".1f"),
    "rg_vm": ("rg vm", ".1f"),
    "wg_torque_Nmm": ("torque", ".2f"),
    "pairs_in_contact": ("pairs", "d"),
    "newton_iterations": ("Newton", "d"),
}
"""Columns of the history: title and format of their values."""


def print_drive(history: Mapping[str, np.ndarray], summary: DriveSummary) -> None:
    """Print history and answers of a run; call it on one rank."""
    _print_history({name: values[: summary.increments] for name, values in history.items()})
    if further := len(history["step"]) - summary.increments:
        end = history["wg_angle_deg"][-1]
        console.print(
            f"history.csv repeats this period: {further} further rows up to {end:.4g} degrees"
        )
    for answers in summary.groups():
        _print_answers(answers)
    console.print(
        f"\n{summary.wall_s:.0f} s on {ranks_text(summary.ranks)}; summary.json has all answers"
    )


def _print_history(history: Mapping[str, np.ndarray]) -> None:
    driven = {"wg_angle_deg": "input_angle_deg", "wg_torque_Nmm": "input_torque_Nmm"}
    names = [driven.get(name, name) if driven.get(name) in history else name for name in COLUMNS]
    title = "largest stresses over the bodies (MPa, nodal averages)"
    title += "; torque in N·mm, angles in degrees"
    columns = {}
    for name, (heading, form) in zip(names, COLUMNS.values()):
        columns[heading] = [format(value, form) for value in history[name]]
    (heading, cells), *others = columns.items()
    for table in number_tables(Labels(heading, cells, "right"), dict(others), console.width, title):
        console.print(table)


def _print_answers(answers: AnswerGroup) -> None:
    """The answers of a group without details, each with its place and remark below it, then its
    remarks."""
    shown = [answer for answer in answers.answers() if not answer.detail]
    if not shown:
        return
    table = Table(box=None, show_header=False, padding=(0, 1, 0, 0))
    table.add_column(overflow="fold")
    for justify in ("right", "left", "left"):
        table.add_column(justify=justify, no_wrap=True)
    for answer in shown:
        below = [Text(words) for words in (answer.place, remark_text(answer)) if words]
        indented = [Padding(text, (0, 0, 0, 2)) for text in below]
        what = Padding(Group(answer.text, *indented), (0, 0, 0, 2))
        table.add_row(what, value_text(answer.value, answer.error), error_text(answer), answer.unit)
    console.print(f"\n{answers.TITLE}", style="bold", markup=False)
    console.print(table)
    for remark in answers.remarks():
        console.print(f"  {remark}", markup=False)
