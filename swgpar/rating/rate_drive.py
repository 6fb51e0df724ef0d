"""The rating of a drive: its runs one after another, and the sheet after each of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mpi4py import MPI

from swgpar import watch
from swgpar.analysis.accuracy import not_refinable
from swgpar.analysis.forecast import duration_text
from swgpar.analysis.shortcuts import MESHES
from swgpar.design.drive_design import DriveDesign
from swgpar.drive_results.summary import DriveSummary
from swgpar.errors import InputError
from swgpar.meshing import MeshRecipe, load_recipe
from swgpar.rating.forecast import rating_seconds
from swgpar.rating.page import rating_page
from swgpar.rating.planned_runs import LoadCase, PlannedRun, RatingPlan, plan_runs
from swgpar.rating.rows import RatingRow, rating_rows
from swgpar.rating.sheet import CSV, JSON, PAGE, RatedVerdict, RatingSheet, RunEntry
from swgpar.rating.texts import headline_text
from swgpar.results.atomic import on_all, to_json, write_from_root
from swgpar.results.lock import releasing
from swgpar.results.table import format_csv
from swgpar.run_options import RunOptions
from swgpar.studies.case import Outcome
from swgpar.studies.job import run_one
from swgpar.studies.many_runs import claim_folder, do_runs, note_ended, print_line
from swgpar.systems.drive import DRIVE

if TYPE_CHECKING:
    from swgpar.systems import System

RUNS = "runs"
"""Folder of the runs."""

WAITS = "the run waits"


class _Book:
    """What has become of the runs, and the sheet that follows.

    plan : the runs;  rows : of the sheet;  recipe : of the meshes;  options : of the rating
    folder : of the sheet, None in memory
    places : folders of the runs, by their names, empty in memory. A run that is changed has another
    one, so that those that are done are found again
    outcomes : of the runs that have ended, by their names
    """

    def __init__(
        self,
        design: DriveDesign,
        plan: RatingPlan,
        rows: list[RatingRow],
        recipe: MeshRecipe,
        options: RunOptions,
    ) -> None:
        self.design, self.plan, self.rows = design, plan, rows
        self.options = options
        self.places = {
            run.name: f"{RUNS}/{run.folder(_identity(run, recipe))}" if options.out else ""
            for run in plan.runs
        }
        self.outcomes: dict[str, Outcome] = {}
        self.summaries: dict[LoadCase, DriveSummary] = {}

    def compute(self, run: PlannedRun, system: System[Any, Any], comm: MPI.Comm) -> Outcome:
        """Do a run; collective."""
        folder = self.options.out
        accuracy, _ = accuracy_of(run, self.options.accuracy)
        given = replace(
            self.options,
            out=folder and folder / self.places[run.name],
            accuracy=accuracy,
            comm=comm,
            terminal=False,
        )
        outcome = run_one(system, run.design, given, run.refusal)
        self.outcomes[run.name] = outcome
        if isinstance(outcome.answers, DriveSummary):
            self.summaries |= dict.fromkeys(run.cases, outcome.answers)
        return outcome

    def _missing(self, case: LoadCase) -> str:
        """Why there is no answer for a case."""
        if case in self.plan.missing:
            return self.plan.missing[case]
        run = next(run for run in self.plan.runs if case in run.cases)
        if run.name not in self.outcomes:
            return WAITS
        outcome = self.outcomes[run.name]
        if outcome.status == "failed":
            return outcome.reason
        return f"left out: {run.left_out}" if run.left_out else ""

    def _entry(self, run: PlannedRun) -> RunEntry:
        outcome = self.outcomes.get(run.name)
        status = "waits" if outcome is None else outcome.status
        _, without_accuracy = accuracy_of(run, self.options.accuracy)
        return RunEntry(
            name=run.name,
            torque=run.torque,
            status="refused" if run.refusal else status,
            folder=self.places[run.name],
            reason=run.refusal or ("" if outcome is None else outcome.reason),
            left_out=", ".join(filter(None, (run.left_out, without_accuracy))),
            wall_s=None if outcome is None else outcome.wall_s,
        )

    def sheet(self) -> RatingSheet:
        """The sheet with what is known."""
        drive = self.design.drive
        return RatingSheet(
            f"Rating of a strain wave gear {drive.teeth_fs}/{drive.teeth_rg}",
            tuple(
                RatedVerdict(
                    row.verdict(self.summaries.get(row.case), self._missing(row.case)),
                    str(row.case),
                )
                for row in self.rows
            ),
            tuple(map(self._entry, self.plan.runs)),
            self.design.model_dump(),
            self.options.out and self.options.out.absolute(),
        )


@releasing
def rate_drive(design: DriveDesign, options: RunOptions) -> RatingSheet:
    """Rate a drive; collective. All ranks share every run. See `swgpar.api.rate`."""
    folder, comm = options.out, options.comm
    if folder is None:
        raise InputError("out is missing: a rating keeps its runs in a folder")
    book = _begin(design, options)
    plan, count = book.plan, len(book.plan.runs)
    claim_folder(folder, options, "a rating", [RUNS], (JSON, CSV, PAGE), RUNS)
    watch.saved("runs", 0, count)
    if comm.rank == 0 and options.terminal:
        print_line([forecast_text(plan, book.options)])

    def run(index: int, own: MPI.Comm, _: object) -> None:
        planned = plan.runs[index]
        watch.doing(f"run {index + 1} of {count}: {planned.name}")
        outcome = book.compute(planned, system, own)
        _write(book.sheet(), folder, own)
        if own.rank == 0:
            note_ended("runs", index + 1, count)
            if options.terminal:
                print_line(_words(index, count, planned, outcome))

    with DRIVE.shared() as system:
        do_runs(comm, "ranks", count, run, None)
    return book.sheet()


def rate_in_memory(
    design: DriveDesign, options: RunOptions, system: System[Any, Any]
) -> RatingSheet:
    """The rating sheet of a drive without files; collective. system : that its runs share"""
    book = _begin(design, options)
    for run in book.plan.runs:
        book.compute(run, system, options.comm)
    return book.sheet()


def _begin(design: DriveDesign, options: RunOptions) -> _Book:
    """The book before any run, with the recipe of the package where the options have none."""

    def planned() -> tuple[RatingPlan, list[RatingRow]]:
        return plan_runs(design), rating_rows(design, options.accuracy)

    recipe = options.recipe
    if recipe is None:
        name = MESHES[design.drive.model]
        recipe = load_recipe(name)
        options = replace(options, recipe=recipe, recipe_name=name)
    return _Book(design, *on_all(options.comm, planned), recipe, options)


def _identity(run: PlannedRun, recipe: MeshRecipe) -> str:
    return "" if run.design is None else str(DRIVE.identity(run.design, recipe)["identity"])


def accuracy_of(run: PlannedRun, accuracy: float | None) -> tuple[float | None, str]:
    """The accuracy of a run, None where its mesh is not chosen by one; and why a run whose stresses
    are resolved does not have the one that is asked for."""
    if accuracy is None or run.design is None or not run.windows:
        return None, ""
    if found := not_refinable(run.design):
        return None, f"--accuracy, which is not available with {found[0]}"
    return accuracy, ""


def forecast_text(plan: RatingPlan, options: RunOptions) -> str:
    """How many runs follow, and how long they will take."""
    recipe = options.recipe
    assert recipe is not None  # `_begin` has one
    count = sum(run.design is not None for run in plan.runs)
    try:
        seconds = rating_seconds(plan, recipe)
    except InputError:  # every run says why it has no mesh
        return f"{count} runs"
    finer = "; meshes for the accuracy may be finer" if options.accuracy else ""
    return f"{count} runs, about {duration_text(seconds)} on two free cores by the forecast{finer}"


def _words(index: int, count: int, run: PlannedRun, outcome: Outcome) -> list[str]:
    """Of a line on the terminal."""
    words = [f"{index + 1}/{count}", run.name]
    if outcome.status != "finished":
        return [*words, f"{outcome.status}: {outcome.reason}"]
    return [*words, f"{outcome.wall_s:.1f} s", "finished before" if outcome.kept else "finished"]


def _write(sheet: RatingSheet, folder: Path, comm: MPI.Comm) -> None:
    """Write the files of the sheet; collective."""
    page = rating_page(sheet) if comm.rank == 0 else b""
    content = sheet.content | {"sentence": headline_text(sheet)}
    write_from_root(comm, folder / JSON, to_json(content))
    write_from_root(comm, folder / CSV, format_csv(sheet.rows))
    write_from_root(comm, folder / PAGE, page)
