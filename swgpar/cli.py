"""The command `swgpar`."""

from __future__ import annotations

import argparse
import difflib
import sys
import traceback
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from swgpar.errors import InputError, OutOfMemoryError, StudyError, SwgparError, printable, shortened
from swgpar.version import __version__

if TYPE_CHECKING:
    from swgpar.systems import System

OPTIONS = tuple("--set --mesh --accuracy --plain --out --restart --overwrite --format --help --version".split())

EXAMPLES = """examples:
  swgpar check drivers/cup_45deg.toml
  mpirun -n 2 swgpar run drivers/cup_45deg.toml --mesh coarse --out results/coarse
  swgpar report results/coarse
  swgpar COMMAND --help      more examples

The same in Python: import swgpar; swgpar.run("drivers/cup_45deg.toml", mesh="coarse").plot.stress()
"""

RUN = """Simulate a drive, or compute a gear train, and write the results to a folder. Unknown options are passed to
PETSc."""

RUN_EXAMPLES = """examples:
  mpirun -n 2 swgpar run drivers/cup_45deg.toml --out results/cup
  mpirun -n 2 swgpar run drivers/cup_45deg.toml --plain --out results/plain
  mpirun -n 2 swgpar run drivers/cup_45deg.toml --mesh full --out results/full --set load.torque=10 steps.rotation=20
  mpirun -n 2 swgpar run drivers/cup_45deg.toml --mesh full --out results/full --restart
  mpirun -n 2 swgpar run drivers/cup_45deg.toml --accuracy 0.02 --out results/accurate
  swgpar run drivers/plane_half_turn.toml --mesh mesh/rim/inner_10.toml --out results/rim -snes_monitor
  mpirun -n 2 swgpar run drivers/cascade.toml --out results/cascade
"""

MESH_EXAMPLES = """examples:
  swgpar mesh drivers/cup_45deg.toml --mesh coarse --out results/mesh --format vtu inp
  swgpar mesh drivers/cup_45deg.toml --mesh my_recipe.toml --out results/mesh --set drive.model=plane
"""

CHECK_EXAMPLES = """examples:
  swgpar check drivers/cup_45deg.toml
  swgpar check drivers/cup_45deg.toml --set drive.layout=spline_fixed
  swgpar check drivers/cup_45deg.toml --mesh full
"""

STUDY = """Compute many designs and compare them: a grid or a sweep over any keys of the design file, on one mesh or
more, beside published values if there are some. Gear trains have no meshes. The study file is described in
docs/howto/studies.md. Unknown options are passed to PETSc."""

STUDY_EXAMPLES = """examples:
  mpirun -n 4 swgpar study drivers/studies/torque.toml --out results/torque
  mpirun -n 4 swgpar study drivers/studies/torque.toml --out results/torque --restart
  mpirun -n 4 swgpar study drivers/studies/planetary_rim.toml --out results/planetary_rim

a study file:
  [study]
  design = "../cup_45deg.toml"              # relative to the study file, as are paths of meshes
  meshes = ["coarse"]
  [study.vary]
  "load.torque" = [5.0, 10.0, 20.0]

--restart keeps finished cases, continues interrupted ones and tries failed ones again.
"""

NEW = """Write a design file to start from: valid, checked, every key with its meaning. All that is not given follows
from rules of proportion."""

NEW_EXAMPLES = """examples:
  swgpar new drive.toml --ratio 100 --diameter 50.8 --torque 52
  swgpar new drive.toml --ratio 80 --bore 60 --torque 120 --profile involute --cam parabolic
  swgpar new plane.toml --ratio 50 --diameter 42 --torque 2 --model plane
"""

OPTIMISE = """Search for the best design: any keys of the design file as variables within bounds, any quantities that
studies know as objectives and constraints. Designs that are refused or fail are infeasible. The file is described in
docs/howto/optimise.md. Unknown options are passed to PETSc."""

OPTIMISE_EXAMPLES = """examples:
  mpirun -n 2 swgpar optimise drivers/optimise/parabolic_cam.toml --out results/cam
  mpirun -n 2 swgpar optimise drivers/optimise/parabolic_cam.toml --out results/cam --restart

--restart continues the search, with more evaluations if the file asks for them.
"""

VIEW_EXAMPLES = """example:
  swgpar view results/coarse
"""

EXPORT = """Write files of other programs: the geometry of a design (step, dxf), or fields and tables of a finished run
(vtkhdf, parquet, lookup)."""

EXPORT_EXAMPLES = """examples:
  swgpar export drivers/cup_45deg.toml --format step dxf --out results/cad
  swgpar export results/cup --format vtkhdf parquet --out results/cup/export
"""

REPORT_EXAMPLES = """example:
  swgpar report results/coarse
"""

MESH_HELP = "mesh recipe: coarse, forces, medium, full, plane_coarse, plane, plane_fine, or the path of a file (TOML)"


_Commands = "argparse._SubParsersAction[argparse.ArgumentParser]"


class _Parser(argparse.ArgumentParser):
    """Reports a bad command line like any other bad input: one sentence, from one rank."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message} (see {self.prog} --help)")


def parser() -> argparse.ArgumentParser:
    """Argument parser of all subcommands."""
    top = _Parser(
        prog="swgpar",
        description="Contact finite-element analysis of strain wave gears, and models of the gear trains around them.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action="version", version=f"swgpar {__version__}")
    commands = top.add_subparsers(
        dest="command",
        required=True,
        metavar="new | check | mesh | run | study | optimise | report | view | export",
    )

    _add_new(commands)
    _add_run(commands)
    _add_study(commands)
    _add_optimise(commands)
    mesh = _add_command(commands, "mesh", "Write the mesh of the whole drive.", MESH_EXAMPLES)
    _add_design(mesh)
    mesh.add_argument("--mesh", required=True, help=MESH_HELP)
    mesh.add_argument("--out", required=True, help="folder for the mesh files")
    mesh.add_argument(
        "--format",
        nargs="+",
        default=["vtu", "msh", "inp"],
        choices=["vtu", "msh", "inp"],
        help="vtu for ParaView, msh for Gmsh, inp for Abaqus and CalculiX (default: all)",
    )
    check = _add_command(
        commands, "check", "Check a design and print its derived geometry, and what a run will need.", CHECK_EXAMPLES
    )
    _add_design(check)
    check.add_argument("--mesh", help=f"{MESH_HELP}: prints elements, unknowns, memory and time to expect")
    report = _add_command(
        commands, "report", "Draw the figures of a finished run again, and write its report.html.", REPORT_EXAMPLES
    )
    report.add_argument("out", help="results folder")
    _add_export(commands)
    view = _add_command(commands, "view", "Show the deformed drive of a finished run in a window.", VIEW_EXAMPLES)
    view.add_argument("out", help="results folder")
    return top


def _add_command(commands: _Commands, name: str, text: str, examples: str) -> argparse.ArgumentParser:
    return commands.add_parser(
        name,
        help=text.partition(".")[0].lower(),
        description=text,
        epilog=examples,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )


def _add_design(command: argparse.ArgumentParser) -> None:
    command.add_argument("design", help="design file (TOML)")
    command.add_argument(
        "--set",
        action="append",
        default=[],
        nargs="+",
        metavar="section.key=value",
        help="set keys of the design file",
    )


def _add_new(commands: _Commands) -> None:
    new = _add_command(commands, "new", NEW, NEW_EXAMPLES)
    new.add_argument("design", help="design file to write (TOML)")
    new.add_argument("--ratio", type=float, required=True, help="speed of the wave generator over that of the output")
    size = new.add_mutually_exclusive_group(required=True)
    size.add_argument("--diameter", type=float, metavar="D", help="pitch diameter of the flexible spline, mm")
    size.add_argument("--bore", type=float, metavar="D", help="inner diameter of the flexible spline, mm")
    new.add_argument("--torque", type=float, required=True, metavar="T", help="on the output, N·m")
    for name, choices, text in (
        ("--profile", ("quadruple_arc", "double_arc", "involute"), "profile of the teeth"),
        ("--cam", ("elliptical", "parabolic", "simplified", "four_roller"), "cam of the wave generator"),
        ("--layout", ("ring_fixed", "spline_fixed"), "fixed member"),
        ("--model", ("cup", "plane"), "the cup drive, or the toothed section in plane stress"),
    ):
        new.add_argument(name, choices=choices, default=choices[0], help=f"{text} (default: {choices[0]})")
    new.add_argument("--overwrite", action="store_true", help="replace a file that exists")


def _add_export(commands: _Commands) -> None:
    export = _add_command(commands, "export", EXPORT, EXPORT_EXAMPLES)
    export.add_argument("source", help="design file (TOML), or results folder")
    export.add_argument("--out", required=True, help="folder for the files")
    export.add_argument(
        "--format",
        nargs="+",
        required=True,
        choices=["step", "dxf", "vtkhdf", "parquet", "lookup"],
        help="step: solids of gears and cam; dxf: their outlines; vtkhdf: fields for ParaView; parquet: tables; "
        "lookup: torsional spring and ripple for multibody programs",
    )


def _add_run(commands: _Commands) -> None:
    run = _add_command(commands, "run", RUN, RUN_EXAMPLES)
    _add_design(run)
    run.add_argument(
        "--mesh", help=f"{MESH_HELP} (default: forces, for a plane model plane_coarse); gear trains have none"
    )
    run.add_argument(
        "--accuracy",
        type=float,
        metavar="A",
        help="refine the mesh and the windows until the estimated error of the largest tensile stress at the teeth "
        "under load is at most A (0.02: 2 %%; 0.001 to 0.2). Without other values in the design, one period is "
        "computed in 4, 8 or 16 angles. The mesh has at most 1,500,000 elements in the plane, "
        "700,000 in space",
    )
    run.add_argument(
        "--plain",
        action="store_true",
        help="compute all that the design asks for: without this, a drive without friction leaves out the "
        "assembly step by step and further periods, where the design does not set their keys",
    )
    run.add_argument("--out", required=True, help="results folder")
    run.add_argument("--restart", action="store_true", help="continue from the checkpoint in --out")
    run.add_argument("--overwrite", action="store_true", help="replace results that --out already holds")


def _add_study(commands: _Commands) -> None:
    study = _add_command(commands, "study", STUDY, STUDY_EXAMPLES)
    study.add_argument("study", help="study file (TOML)")
    study.add_argument("--out", required=True, help="folder of the study")
    study.add_argument("--restart", action="store_true", help="continue the study in --out")
    study.add_argument("--overwrite", action="store_true", help="replace a study that --out already holds")


def _add_optimise(commands: _Commands) -> None:
    optimise = _add_command(commands, "optimise", OPTIMISE, OPTIMISE_EXAMPLES)
    optimise.add_argument("optimisation", help="optimisation file (TOML)")
    optimise.add_argument("--out", required=True, help="folder of the results")
    optimise.add_argument("--restart", action="store_true", help="continue the search in --out")
    optimise.add_argument("--overwrite", action="store_true", help="replace a search that --out already holds")


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
        accuracy=arguments.accuracy,
        plain=arguments.plain,
        restart=arguments.restart,
        overwrite=arguments.overwrite,
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
        arguments.study, arguments.out, restart=arguments.restart, overwrite=arguments.overwrite, progress=True
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
        raise StudyError(f"{len(found.failed)} of {len(found.results)} runs failed: the reasons are in {reasons}")


def _new(arguments: argparse.Namespace) -> None:
    from swgpar import api

    names = ("ratio", "torque", "diameter", "bore", "profile", "cam", "layout", "model", "overwrite")
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
        arguments.optimisation, arguments.out, restart=arguments.restart, overwrite=arguments.overwrite, progress=True
    )
    if MPI.COMM_WORLD.rank == 0:
        print_result(found)
        folder = Path(arguments.out)
        for path in sorted([*folder.glob("*.csv"), *folder.glob("*.html"), *folder.glob("best/*.toml")]):
            console.print(printable(f"written {path}"), markup=False)
    _warn()
    MPI.COMM_WORLD.Barrier()  # mpirun ends all ranks when one of them fails


def _export(arguments: argparse.Namespace) -> None:
    from swgpar import api

    _print(f"written {path}" for path in api.export(arguments.source, arguments.out, arguments.format))


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
    from swgpar.analysis.drive_result import DriveResult

    result = api.open_result(arguments.out)
    if not isinstance(result, DriveResult):
        raise InputError(f"{arguments.out} holds a gear train: view is available for drives")
    result.view()


def _warn() -> None:
    """Warn of options of PETSc that a study, or a system without PETSc, has not used; a drive says it earlier."""
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


def _check_rest(rest: Sequence[str], petsc: bool) -> None:
    """Refuse what is neither an option of swgpar nor one of PETSc (-name, -name value)."""
    after_option = False
    for word in rest:
        option = petsc and len(word) > 1 and word[0] == "-" and (word[1].isalpha())
        if not option and not after_option:
            near = difflib.get_close_matches(word, OPTIONS, n=1)
            hint = f": did you mean {near[0]}?" if near else "; options of PETSc begin with one dash" if petsc else ""
            raise InputError(f"unknown argument {shortened(word)}{hint}")
        after_option = option


def _begin(arguments: argparse.Namespace, system: System[Any, Any] | None = None, kind: str = "cases") -> None:
    """Say what is saved when a signal ends the command. system : of the design of a run;  kind : counted without it"""
    from mpi4py import MPI

    from swgpar import watch
    from swgpar.log import console

    if MPI.COMM_WORLD.rank == 0:
        kind = kind if system is None else "increments"
        restarts = system is None or "restart" in system.options
        watch.begin(kind, arguments.out, restarts=restarts, terminal=console.is_terminal)


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; returns the exit code: 0, that of the error, 130 or 143 after a signal."""
    from swgpar import watch

    with watch.armed():
        return _main(arguments)


def _main(arguments: Sequence[str] | None) -> int:
    command = None
    try:
        known, rest = parser().parse_known_args(arguments)
        command = known.command
        solves = command in ("run", "study", "optimise")
        _check_rest(rest, petsc=solves)
        known.overrides = [item for group in getattr(known, "set", []) for item in group]
        from swgpar import petsc, watch

        petsc.start(rest)
        watch.rearm()
        command_of = {
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
        command_of[command](known)
    except SwgparError as error:
        from mpi4py import MPI

        alone = getattr(error, "alone", False) and MPI.COMM_WORLD.size > 1
        if MPI.COMM_WORLD.rank == 0 or alone:
            print(f"swgpar: error: {error}", file=sys.stderr, flush=True)
        if alone:  # the other ranks wait for this one
            MPI.COMM_WORLD.Abort(error.exit_code)
        return error.exit_code
    except BrokenPipeError:  # the reader of our output has gone
        sys.stderr.close()
        return 1
    except MemoryError:
        print("swgpar: error: not enough memory: take a coarser mesh, or more memory", file=sys.stderr, flush=True)
        if command in ("run", "study", "optimise"):
            from mpi4py import MPI

            MPI.COMM_WORLD.Abort(OutOfMemoryError.exit_code)
        return OutOfMemoryError.exit_code
    except Exception:
        if command not in ("run", "study", "optimise"):
            raise
        traceback.print_exc()
        from mpi4py import MPI

        MPI.COMM_WORLD.Abort(1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
