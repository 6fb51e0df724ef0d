"""What the subcommands do. Their imports are their own: a command that needs no solver does not
load it."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from swgpar.errors import InputError, StudyError, printable

if TYPE_CHECKING:
    from swgpar.systems import System


def _run(arguments: argparse.Namespace) -> None:
    from mpi4py import MPI

    from swgpar import api
    from swgpar.results.atomic import on_all
    from swgpar.systems import system_of

    comm = MPI.COMM_WORLD
    design = on_all(comm, lambda: api.load_design(arguments.design, arguments.overrides))
    _begin(arguments, system_of(design))
    result = api.run(
        design,
        arguments.mesh,
        arguments.out,
        **{
            name: getattr(arguments, name) for name in ("accuracy", "plain", "restart", "overwrite")
        },
        progress=True,
        comm=comm,
    )
    if comm.rank == 0:
        system_of(design).print(result)
    _warn()
    comm.Barrier()  # mpirun ends all ranks when one of them fails


def _study(arguments: argparse.Namespace) -> None:
    from mpi4py import MPI

    from swgpar import api
    from swgpar.log import console
    from swgpar.studies.terminal import print_results

    _begin(arguments)
    found = api.study(
        arguments.study,
        arguments.out,
        restart=arguments.restart,
        overwrite=arguments.overwrite,
        progress=True,
    )
    folder = Path(arguments.out)
    if MPI.COMM_WORLD.rank == 0:
        print_results(found.results, found.comparisons)
        for path in sorted([*folder.glob("*.csv"), *folder.glob("*.html")]):
            console.print(printable(f"written {path}"), markup=False)
    _warn()
    MPI.COMM_WORLD.Barrier()  # mpirun ends all ranks when one of them fails
    if found.failed:
        reasons = folder / "study.csv"
        raise StudyError(
            f"{len(found.failed)} of {len(found.results)} runs failed: the reasons are in {reasons}"
        )


def _new(arguments: argparse.Namespace) -> None:
    from swgpar import api

    names = (
        "ratio",
        "torque",
        "diameter",
        "bore",
        "profile",
        "cam",
        "layout",
        "model",
        "shape",
        "lobes",
        "overwrite",
    )
    design = api.new(arguments.design, **{name: getattr(arguments, name) for name in names})
    drive = design.drive
    _print(
        [
            f"written {arguments.design}",
            f"{drive.teeth_fs} and {drive.teeth_rg} teeth, module {drive.module:g} mm, bore "
            f"{2 * design.inner_radius:.4g} mm, backlash {1000 * design.backlash:.3g} µm",
            f"swgpar check {arguments.design} has all derived sizes",
        ]
    )


def _optimise(arguments: argparse.Namespace) -> None:
    from mpi4py import MPI

    from swgpar import api
    from swgpar.log import console
    from swgpar.optimisation.terminal import print_result

    _begin(arguments, kind="evaluations")
    found = api.optimise(
        arguments.optimisation,
        arguments.out,
        restart=arguments.restart,
        overwrite=arguments.overwrite,
        progress=True,
    )
    if MPI.COMM_WORLD.rank == 0:
        print_result(found)
        folder = Path(arguments.out)
        for path in sorted(
            [*folder.glob("*.csv"), *folder.glob("*.html"), *folder.glob("best/*.toml")]
        ):
            console.print(printable(f"written {path}"), markup=False)
    _warn()
    MPI.COMM_WORLD.Barrier()  # mpirun ends all ranks when one of them fails


def _export(arguments: argparse.Namespace) -> None:
    from mpi4py import MPI

    from swgpar import api
    from swgpar.results.atomic import on_all

    source = arguments.source
    if arguments.overrides:
        if Path(source).is_dir():
            raise InputError(
                f"--set is of no use with the results folder {source}: allowed with a design file"
            )
        source = on_all(MPI.COMM_WORLD, lambda: api.load_design(source, arguments.overrides))
    paths = api.export(
        source, arguments.out, arguments.format, mesh=arguments.mesh, ripple=arguments.ripple
    )
    _print(f"written {path}" for path in paths)


def _mesh(arguments: argparse.Namespace) -> None:
    from mpi4py import MPI

    from swgpar import api
    from swgpar.results.atomic import on_all

    design = on_all(MPI.COMM_WORLD, lambda: api.load_design(arguments.design, arguments.overrides))
    mesh = api.mesh(design, arguments.mesh, arguments.out, arguments.format, MPI.COMM_WORLD)
    lines = []
    for body, values in mesh.quality.items():
        lines += [body, *(f"  {name:30s} {value:.6g}" for name, value in values.items())]
    _print(lines)


def _check(arguments: argparse.Namespace) -> None:
    from mpi4py import MPI

    from swgpar import api
    from swgpar.results.atomic import on_all
    from swgpar.systems import system_of

    design = on_all(MPI.COMM_WORLD, lambda: api.load_design(arguments.design, arguments.overrides))
    values = on_all(MPI.COMM_WORLD, lambda: api.check(design, mesh=arguments.mesh))
    _print(f"{name:40s} {value:.6g}" for name, value in values.items())
    _print(f"warning: {text}" for text in system_of(design).remarks(design, values))


def _report(arguments: argparse.Namespace) -> None:
    from swgpar import api

    result = api.open_result(arguments.out)
    files = result.plot.save(arguments.out)
    api.save_report(result, arguments.out)
    _print([*(f"figure {path}" for path in files), f"report {Path(arguments.out) / 'report.html'}"])


def _view(arguments: argparse.Namespace) -> None:
    from swgpar import api
    from swgpar.presentation.drive_result import DriveResult

    result = api.open_result(arguments.out)
    if not isinstance(result, DriveResult):
        raise InputError(f"{arguments.out} holds a gear train: view is available for drives")
    result.view()


def _warn() -> None:
    """Warn of options of PETSc that a study, or a system without PETSc, has not used; a drive says
    it earlier."""
    from mpi4py import MPI

    from swgpar import log, petsc

    with log.session(MPI.COMM_WORLD):
        petsc.warn_of_unused_options()


def _print(lines: Iterable[str]) -> None:
    """Print lines, on rank 0 only."""
    from mpi4py import MPI

    if MPI.COMM_WORLD.rank == 0:
        for line in lines:
            print(printable(line))


def _begin(
    arguments: argparse.Namespace, system: System[Any, Any] | None = None, kind: str = "cases"
) -> None:
    """Say what is saved when a signal ends the command. system : of the design of a run;  kind :
    counted without it"""
    from mpi4py import MPI

    from swgpar import watch
    from swgpar.log import console

    if MPI.COMM_WORLD.rank == 0:
        kind = kind if system is None else "increments"
        restarts = system is None or "restart" in system.options
        watch.begin(kind, arguments.out, restarts=restarts, terminal=console.is_terminal)


COMMANDS: dict[str, Callable[[argparse.Namespace], None]] = {
    "new": _new,
    "run": _run,
    "study": _study,
    "optimise": _optimise,
    "mesh": _mesh,
    "check": _check,
    "report": _report,
    "view": _view,
    "export": _export,
}
"""By name."""
