"""A whole optimisation: an optional search on a cheaper model, the search proper, tables, report
and best designs."""

from __future__ import annotations

import time
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

from mpi4py import MPI

from swgpar import watch
from swgpar.errors import OutputError
from swgpar.input.arguments import given_path
from swgpar.input.toml_file import to_toml
from swgpar.optimisation.bounds import at_bounds
from swgpar.optimisation.files import BEST, DESIGNS, REPORT, TABLE
from swgpar.optimisation.optimisation_data import SearchedDesigns, number_of
from swgpar.optimisation.problem import Evaluation, Problem, make_problem
from swgpar.optimisation.report import make_report
from swgpar.optimisation.result import OptimisationResult
from swgpar.optimisation.search import JOURNAL, Search, open_storage
from swgpar.optimisation.spec import Specification, load_specification
from swgpar.optimisation.terminal import OptimiseProgress
from swgpar.results import made_files
from swgpar.results.atomic import agreed, on_all, write_file, write_from_root
from swgpar.results.lock import releasing
from swgpar.results.table import format_csv
from swgpar.run_options import RunOptions
from swgpar.studies.many_runs import claim_folder

SCREEN = " screen"
"""End of the name of the search on the cheaper model."""


@releasing
def optimise(
    optimisation: str | Path,
    out: str | Path,
    *,
    restart: bool = False,
    overwrite: bool = False,
    progress: bool | None = None,
    comm: MPI.Comm = MPI.COMM_WORLD,
) -> OptimisationResult:
    """Search for the best design; collective.

    Parameters
    ----------
    optimisation : path
        An optimisation file (TOML): variables with bounds, objectives and constraints.
    out : path
        Folder: optimise.csv, optimise.html, the storage, and the design files of the best designs
        in best/.
    restart : bool
        Continue the search in `out`.
    overwrite : bool
        Replace a search that `out` already holds. A search in a database is never removed.
    progress : bool
        Report every evaluation on the terminal. Default: only on a terminal.
    comm : communicator
        Each rank tries designs of its own.

    Returns
    -------
    OptimisationResult
        A design that is refused or fails is infeasible and does not stop the search.

    Raises
    ------
    InputError
        An optimisation file that cannot be used.
    OutputError
        The folder or the database cannot be used, or holds another search.

    Examples
    --------
    >>> found = swgpar.optimise("drivers/optimise/parabolic_cam.toml", "results/cam")
    >>> found.evaluations[found.best[0]].values
    """
    begin, folder = time.perf_counter(), given_path("out", out)
    options = RunOptions.given(folder, progress, restart=restart, overwrite=overwrite, comm=comm)
    spec = on_all(comm, lambda: load_specification(optimisation))
    problem = on_all(comm, lambda: make_problem(spec))
    section, screen = spec.section, spec.section.screen
    cheaper = on_all(comm, lambda: make_problem(spec, screen=True)) if screen else None
    written = (JOURNAL, TABLE, REPORT, f"{BEST}/{DESIGNS}")
    claim_folder(folder, options, "an optimisation", [JOURNAL, TABLE], written)
    with agreed(comm, folder / JOURNAL):
        if comm.rank == 0:
            made_files.note(folder / JOURNAL)  # Optuna makes it
    storage = open_storage(section.storage, folder, comm)

    def searched(problem: Problem, end: str, first: list[dict[str, Any]], wanted: int) -> Search:
        name = f"{Path(spec.name).stem}{end}"
        # one that is interrupted is tried again after these: of more another one would be left out
        begin_with = first[:wanted]
        search = Search(problem, storage, name, comm, begin_with, own=not section.storage)
        receive = None
        if comm.rank == 0:
            known = search.evaluations()
            said = OptimiseProgress(name, section, known, wanted, options.terminal)
            receive = said.receive if end else partial(_receive, said, search, folder)
        search.run(wanted, receive)
        comm.Barrier()
        if comm.rank == 0:
            watch.saved("evaluations", len(search.evaluations()), wanted)
        return search

    first = [*filter(None, [problem.start.values]), *section.first]
    if screen:
        search = searched(cheaper, SCREEN, first, screen.evaluations)
        evaluations = search.evaluations()
        first = first + [evaluations[n].values for n in search.ranked()[: screen.best]]
    search = searched(problem, "", first, section.evaluations)
    content = None
    if comm.rank == 0:
        best, evaluations = search.best(), search.evaluations()
        content = OptimisationResult(
            evaluations=evaluations,
            best=best,
            start=number_of(evaluations, problem.start.values),
            without_start=problem.start.reason,
            at_bounds={n: at_bounds(section.variable, evaluations[n].values) for n in best},
            importance=search.importance(),
            designs={n: problem.applied(problem.table, evaluations[n].values) for n in best},
            section=section,
            units=problem.units,
            folder=folder.absolute(),
            wall_s=time.perf_counter() - begin,
        )
    result = comm.bcast(content)
    _write(spec, problem, result, comm)
    return result


def _receive(
    progress: OptimiseProgress, search: Search, folder: Path, message: tuple[int, Evaluation]
) -> None:
    """An evaluation has ended: write the table of all that are known. Not collective."""
    progress.receive(message)
    problem, evaluations = search.problem, search.evaluations()
    tried = SearchedDesigns(
        section=problem.section,
        units=problem.units,
        evaluations=evaluations,
        best=search.best(),
        start=number_of(evaluations, problem.start.values),
    )
    with suppress(OutputError):  # the end of the search says on all ranks what cannot be written
        write_file(folder / TABLE, format_csv(tried.rows))


def _write(
    spec: Specification, problem: Problem, result: OptimisationResult, comm: MPI.Comm
) -> None:
    """Write table, report and the winning design files; collective."""
    with agreed(comm, result.folder):
        if comm.rank == 0:
            (result.folder / BEST).mkdir(exist_ok=True)
            made_files.remove(result.folder, [f"{BEST}/{DESIGNS}"])
    texts = {number: to_toml(table) for number, table in result.designs.items()}
    for number, text in texts.items():
        write_from_root(comm, result.folder / BEST / f"evaluation_{number}.toml", text.encode())
    write_from_root(comm, result.folder / TABLE, format_csv(result.rows))
    page = make_report(spec, problem, result, texts) if comm.rank == 0 else b""
    write_from_root(comm, result.folder / REPORT, page)
