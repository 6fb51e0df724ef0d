"""A whole optimisation: an optional search on a cheaper model, the search proper, tables, report
and best designs."""

from __future__ import annotations

import time
from pathlib import Path

from mpi4py import MPI

from swgpar import log, watch
from swgpar.errors import OutputError
from swgpar.input.toml_file import to_toml
from swgpar.optimisation.problem import Problem, make_problem
from swgpar.optimisation.report import make_report
from swgpar.optimisation.result import OptimisationResult
from swgpar.optimisation.search import JOURNAL, Search, open_storage
from swgpar.optimisation.spec import Specification, load_specification
from swgpar.optimisation.terminal import OptimiseProgress
from swgpar.results.atomic import agreed, on_all, write_from_root
from swgpar.results.folder import given_folder
from swgpar.results.lock import acquire, releasing
from swgpar.results.table import format_csv

TABLE, REPORT, BEST = "optimise.csv", "optimise.html", "best"
"""Names in the folder: all evaluations, the report, and the folder of the winning design files."""

SCREEN = "screen"
"""End of the name of the search on the cheaper model."""


@releasing
def run_optimisation(
    source: str | Path,
    out: str | Path,
    *,
    restart: bool = False,
    overwrite: bool = False,
    terminal: bool = False,
    comm: MPI.Comm = MPI.COMM_WORLD,
) -> OptimisationResult:
    """Search for the best design; collective.

    Parameters
    ----------
    source : an optimisation file (TOML)
    out : folder of the results
    restart : continue the search in the folder, with more evaluations if the file asks for them
    overwrite : replace a search that the folder already holds; one in a database is never removed
    terminal : whether rank 0 reports on the terminal

    Raises
    ------
    InputError
        A file that cannot be used.
    OutputError
        A folder or a database that cannot be used. A design that fails is an outcome.
    """
    begin, folder = time.perf_counter(), given_folder(out)
    spec = on_all(comm, lambda: load_specification(source))
    problem = on_all(comm, lambda: make_problem(spec))
    screen = on_all(comm, lambda: make_problem(spec, screen=True)) if spec.section.screen else None
    _prepare(folder, comm, restart, overwrite)
    url, name = spec.section.storage, Path(spec.name).stem
    storage = open_storage(url, folder, comm)
    first = spec.section.first
    with log.session(
        comm if spec.section.parallel == "ranks" else MPI.COMM_SELF, terminal=False, shown=False
    ):
        if screen is not None:
            search = Search(screen, storage, f"{name} {SCREEN}", comm, first, not url)
            _search(search, screen, spec.section.screen.evaluations, comm, terminal)
            found = search.evaluations()
            first = [
                *first,
                *(found[n].values for n in search.ranked()[: spec.section.screen.best]),
            ]
        search = Search(problem, storage, name, comm, first, not url)
        _search(search, problem, spec.section.evaluations, comm, terminal)
    content = None
    if comm.rank == 0:
        best, every = search.best(), search.evaluations()
        designs = {n: problem.applied(problem.table, every[n].values) for n in best}
        content = (
            every,
            best,
            search.importance(),
            designs,
            folder.absolute(),
            time.perf_counter() - begin,
        )
    result = OptimisationResult(*comm.bcast(content))
    _write(spec, problem, result, comm)
    return result


def _search(search: Search, problem: Problem, wanted: int, comm: MPI.Comm, terminal: bool) -> None:
    """Run a search with its lines on the terminal of rank 0."""
    if comm.rank == 0:
        known = search.evaluations()
        progress = OptimiseProgress(search.name, problem.section, known, wanted, terminal)
    search.run(wanted, progress.receive if comm.rank == 0 else lambda _: None)
    comm.Barrier()
    if comm.rank == 0:
        watch.saved("evaluations", len(search.evaluations()), wanted)


def _prepare(out: Path, comm: MPI.Comm, restart: bool, overwrite: bool) -> None:
    with agreed(comm, out):
        if comm.rank == 0:
            out.mkdir(parents=True, exist_ok=True)
            acquire(out)
            present = [path for path in (out / JOURNAL, out / TABLE) if path.exists()]
            if present and not restart and not overwrite:
                raise OutputError(
                    f"{out} already holds an optimisation: continue it with restart = true "
                    f"(--restart), replace it "
                    "with overwrite = true (--overwrite), or choose another folder"
                )
            if overwrite and not restart:
                for path in (*present, out / REPORT, *(out / BEST).glob("evaluation_*.toml")):
                    path.unlink(missing_ok=True)


def _write(
    spec: Specification, problem: Problem, result: OptimisationResult, comm: MPI.Comm
) -> None:
    """Write table, report and the winning design files; collective."""
    with agreed(comm, result.folder):
        if comm.rank == 0:
            (result.folder / BEST).mkdir(exist_ok=True)
            for old in (result.folder / BEST).glob("evaluation_*.toml"):
                old.unlink()
    texts = {number: to_toml(table) for number, table in result.designs.items()}
    for number, text in texts.items():
        write_from_root(comm, result.folder / BEST / f"evaluation_{number}.toml", text.encode())
    write_from_root(comm, result.folder / TABLE, format_csv(result.rows))
    page = make_report(spec, problem, result, texts) if comm.rank == 0 else b""
    write_from_root(comm, result.folder / REPORT, page)
