"""What the subcommands do. PETSc has started for those that need it."""

from __future__ import annotations

import argparse
import inspect
from collections.abc import Callable, Iterable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from mpi4py import MPI

from swgpar import api, log, petsc, watch
from swgpar.api.ratings import load_rated_design
from swgpar.errors import InputError, StudyError, printable
from swgpar.input.design import Design
from swgpar.log import console
from swgpar.results.atomic import on_all
from swgpar.systems import system_of_section


def _run(arguments: argparse.Namespace) -> None:
    design = _design(arguments)
    system = system_of_section(design.system)
    _begin(arguments, "increments", restarts="restart" in system.options)
    given = _given(api.run, arguments)
    result = api.run(design, arguments.mesh, arguments.out, progress=True, **given)
    if MPI.COMM_WORLD.rank == 0:
        system.print(result)
    _end()


def _rate(arguments: argparse.Namespace) -> None:
    from swgpar.rating.terminal import print_sheet

    path, overrides = arguments.design, arguments.overrides
    design = on_all(MPI.COMM_WORLD, lambda: load_rated_design(path, overrides))
    _begin(arguments, "runs")
    sheet = api.rate(design, arguments.out, progress=True, **_given(api.rate, arguments))
    _show(arguments.out, lambda: print_sheet(sheet))
    _end()


def _study(arguments: argparse.Namespace) -> None:
    from swgpar.studies.study import study
    from swgpar.studies.terminal import print_results

    _begin(arguments, "cases")
    result = study(arguments.study, arguments.out, progress=True, **_given(study, arguments))
    _show(arguments.out, lambda: print_results(result.results, result.comparisons))
    _end()
    if result.failed:
        raise StudyError(
            f"{len(result.failed)} of {len(result.results)} runs failed: the reasons are in "
            f"{Path(arguments.out) / 'study.csv'}"
        )


def _optimise(arguments: argparse.Namespace) -> None:
    from swgpar.optimisation.run_optimisation import optimise
    from swgpar.optimisation.terminal import print_result

    _begin(arguments, "evaluations")
    given = _given(optimise, arguments)
    result = optimise(arguments.optimisation, arguments.out, progress=True, **given)
    _show(arguments.out, lambda: print_result(result))
    _end()


def _new_train(arguments: argparse.Namespace) -> None:
    for name in ("layout", "model", "shape", "lobes", "bore", "profile", "cam"):
        if getattr(arguments, name) != arguments.parser.get_default(name):
            raise InputError(f"--{name} has no meaning for a gear train: leave it out")
    given = _given(api.new_train, arguments)
    api.new_train(arguments.design, **given)
    _print([f"written {arguments.design}", f"swgpar check {arguments.design} has derived values"])


def _new(arguments: argparse.Namespace) -> None:
    if arguments.train is not None:
        _new_train(arguments)
        return
    design = api.new(arguments.design, **_given(api.new, arguments))
    drive = design.drive
    _print(
        [
            f"written {arguments.design}",
            f"{drive.teeth_fs} and {drive.teeth_rg} teeth, module {drive.module:g} mm, bore "
            f"{2 * design.inner_radius:.4g} mm, clearance of undeformed flanks "
            f"{1000 * design.rigid_teeth().clearance():.3g} µm",
            f"swgpar check {arguments.design} has all derived sizes",
            f"swgpar rate {arguments.design} --out FOLDER says whether it carries the torque",
        ]
    )


def _export(arguments: argparse.Namespace) -> None:
    source = arguments.source
    if arguments.overrides:
        if Path(source).is_dir():
            raise InputError(
                f"--set is of no use with the results folder {source}: allowed with a design file"
            )
        source = _design(arguments)
    given = _given(api.export, arguments)
    paths = api.export(source, arguments.out, arguments.format, **given)
    _print(f"written {path}" for path in paths)


def _mesh(arguments: argparse.Namespace) -> None:
    given = _given(api.mesh, arguments)
    where = arguments.out, arguments.format
    mesh = api.mesh(_design(arguments), arguments.mesh, *where, **given)
    lines = []
    for body, values in mesh.quality.items():
        lines += [body, *(f"  {name:30s} {value:.6g}" for name, value in values.items())]
    _print(lines)


def _check(arguments: argparse.Namespace) -> None:
    design = _design(arguments)
    values = on_all(MPI.COMM_WORLD, lambda: api.check(design, mesh=arguments.mesh))
    _print(f"{name:40s} {value:.6g}" for name, value in values.items())
    _print(f"warning: {text}" for text in system_of_section(design.system).remarks(design))


def _report(arguments: argparse.Namespace) -> None:
    result = api.open_result(arguments.out)
    files = result.plot.save(arguments.out)
    api.save_report(result, arguments.out)
    _print([*(f"figure {path}" for path in files), f"report {Path(arguments.out) / 'report.html'}"])


def _view(arguments: argparse.Namespace) -> None:
    from swgpar.presentation.drive_result import DriveResult

    result = api.open_result(arguments.out)
    if not isinstance(result, DriveResult):
        raise InputError(f"{arguments.out} holds a gear train: view is available for drives")
    result.view()


def _app(arguments: argparse.Namespace) -> None:
    if find_spec("nicegui") is None:
        raise InputError("app needs NiceGUI, which is not installed: pip install swgpar[app]")
    if MPI.COMM_WORLD.size > 1:
        raise InputError(
            f"app runs on one rank, not on {MPI.COMM_WORLD.size}: it starts mpirun for its jobs"
        )
    from swgpar.app.server import serve

    serve(Path(arguments.source), arguments.port, show=not arguments.no_browser)


def _design(arguments: argparse.Namespace) -> Design:
    """The design, or source, of the command with the values of --set; collective."""
    path = arguments.source if arguments.command == "export" else arguments.design
    return on_all(MPI.COMM_WORLD, lambda: api.load_design(path, arguments.overrides))


def _given(function: Callable[..., Any], arguments: argparse.Namespace) -> dict[str, Any]:
    """The options of the command that are keywords of a function of the Python interface."""
    parameters = inspect.signature(function).parameters.values()
    keywords = [each.name for each in parameters if each.kind is each.KEYWORD_ONLY]
    return {name: value for name, value in vars(arguments).items() if name in keywords}


def _begin(arguments: argparse.Namespace, kind: str, *, restarts: bool = True) -> None:
    """Say what is saved when a signal ends the command. kind : what is counted"""
    if MPI.COMM_WORLD.rank == 0:
        watch.begin(kind, arguments.out, restarts=restarts, terminal=console.is_terminal)


def _end() -> None:
    """Warn of options of PETSc that a study, or a system without PETSc, has not used; a drive says
    it earlier."""
    with log.session(MPI.COMM_WORLD):
        petsc.warn_of_unused_options()
    MPI.COMM_WORLD.Barrier()  # mpirun ends all ranks when one of them fails


def _show(out: str, show: Callable[[], None]) -> None:
    """Show the results of many runs, and the files that are written; on rank 0 only."""
    if MPI.COMM_WORLD.rank == 0:
        show()
        patterns = ("*.csv", "*.html", "best/*.toml")
        for path in sorted(path for pattern in patterns for path in Path(out).glob(pattern)):
            console.print(printable(f"written {path}"), markup=False)


def _print(lines: Iterable[str]) -> None:
    """Print lines, on rank 0 only."""
    if MPI.COMM_WORLD.rank == 0:
        for line in lines:
            print(printable(line))


COMMANDS: dict[str, Callable[[argparse.Namespace], None]] = {
    command.__name__.removeprefix("_"): command
    for command in (
        _new,
        _run,
        _rate,
        _study,
        _optimise,
        _mesh,
        _check,
        _report,
        _view,
        _export,
        _app,
    )
}
"""By name."""
