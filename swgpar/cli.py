"""The command `swgpar`."""

from __future__ import annotations

import argparse
import difflib
import sys
import traceback
from collections.abc import Sequence
from typing import NoReturn

from swgpar.errors import InputError, StudyError, SwgparError
from swgpar.version import __version__

OPTIONS = ("--set", "--mesh", "--accuracy", "--out", "--restart", "--overwrite", "--format", "--help", "--version")

EXAMPLES = """examples:
  swgpar check drivers/cup_45deg.toml
  mpirun -n 2 swgpar run drivers/cup_45deg.toml --mesh coarse --out results/coarse
  mpirun -n 2 swgpar run drivers/plane_half_turn.toml --mesh plane_coarse --accuracy 0.05 --out results/plane
  mpirun -n 2 swgpar run drivers/cup_45deg.toml --mesh full --out results/full --set load.torque=10
  mpirun -n 2 swgpar run drivers/cup_45deg.toml --mesh full --out results/full --restart
  swgpar mesh drivers/cup_45deg.toml --mesh coarse --out results/mesh --format vtu inp
  swgpar report results/full
  mpirun -n 2 swgpar run drivers/cascade.toml --out results/cascade
"""

STUDY = """A study computes many designs and compares them: a grid or a sweep over any keys of the design file, on one
mesh or more, beside published values where there are some. Gear trains have no meshes. The file is described in
docs/howto/studies.md."""

STUDY_EXAMPLES = """examples:
  mpirun -n 4 swgpar study drivers/studies/torque.toml --out results/torque
  mpirun -n 4 swgpar study drivers/studies/torque.toml --out results/torque --restart
  mpirun -n 4 swgpar study drivers/studies/planetary_rim.toml --out results/planetary_rim

a study file:
  [study]
  design = "../cup_45deg.toml"              # relative to the study file, like the meshes
  meshes = ["coarse"]
  [study.vary]
  "load.torque" = [5.0, 10.0, 20.0]

--restart keeps what is finished, continues what was interrupted and tries again what failed.
"""


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
    commands = top.add_subparsers(dest="command", required=True, metavar="run | study | mesh | check | report")

    def design_command(name: str, text: str) -> argparse.ArgumentParser:
        command = commands.add_parser(
            name, help=text, description=text, epilog=EXAMPLES, formatter_class=argparse.RawDescriptionHelpFormatter
        )
        command.add_argument("design", help="design file (TOML)")
        command.add_argument(
            "--set",
            action="append",
            default=[],
            nargs="+",
            metavar="section.key=value",
            help="override a key of the design file",
        )
        return command

    run = design_command("run", "simulate a drive; what is not known here is handed to PETSc")
    run.add_argument("--mesh", help="mesh recipe (TOML); gear trains have none")
    run.add_argument(
        "--accuracy",
        type=float,
        metavar="A",
        help="refine the mesh until the estimated error of the largest tensile stress under load is at most A (0.02: "
        "2 %%; 0.001 to 0.2, without friction); takes one period in 4, 8 or 16 angles and solver.rtol = 1e-7 unless "
        "the design says otherwise, and ends at 1,500,000 elements in the plane, 700,000 in space",
    )
    run.add_argument("--out", required=True, help="results folder")
    run.add_argument("--restart", action="store_true", help="continue from the checkpoint in --out")
    run.add_argument("--overwrite", action="store_true", help="replace results that --out already holds")
    study = commands.add_parser(
        "study",
        help="compute and compare many designs; what is not known here is handed to PETSc",
        description=STUDY,
        epilog=STUDY_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    study.add_argument("study", help="study file (TOML)")
    study.add_argument("--out", required=True, help="folder of the study")
    study.add_argument("--restart", action="store_true", help="continue the study in --out")
    study.add_argument("--overwrite", action="store_true", help="replace a study that --out already holds")
    mesh = design_command("mesh", "write the mesh of the whole drive")
    mesh.add_argument("--mesh", required=True, help="mesh recipe (TOML)")
    mesh.add_argument("--out", required=True, help="folder for the mesh files")
    mesh.add_argument(
        "--format",
        nargs="+",
        default=["vtu", "msh", "inp"],
        choices=["vtu", "msh", "inp"],
        help="vtu for ParaView, msh for Gmsh, inp for Abaqus and CalculiX (all)",
    )
    design_command("check", "validate a design and print its geometry")
    report = commands.add_parser("report", help="draw the figures of a finished run again")
    report.add_argument("out", help="results folder")
    return top


def _run(arguments: argparse.Namespace) -> None:
    from mpi4py import MPI

    from swgpar import api
    from swgpar.results.atomic import on_all
    from swgpar.systems import system_of

    comm = MPI.COMM_WORLD
    design = on_all(comm, lambda: api.load_design(arguments.design, arguments.overrides))
    result = api.run(
        design,
        arguments.mesh,
        arguments.out,
        accuracy=arguments.accuracy,
        restart=arguments.restart,
        overwrite=arguments.overwrite,
        progress=True,
        comm=comm,
    )
    if comm.rank == 0:
        system_of(design).print(result)
    comm.Barrier()  # mpirun ends all ranks when one of them fails


def _study(arguments: argparse.Namespace) -> None:
    from mpi4py import MPI

    from swgpar import api
    from swgpar.log import console
    from swgpar.studies.terminal import print_results

    found = api.study(
        arguments.study, arguments.out, restart=arguments.restart, overwrite=arguments.overwrite, progress=True
    )
    if MPI.COMM_WORLD.rank == 0:
        print_results(found.results, found.comparisons)
        for path in sorted([*found.folder.glob("*.csv"), *found.folder.glob("*.html")]):
            console.print(f"written {path}")
    MPI.COMM_WORLD.Barrier()  # mpirun ends all ranks when one of them fails
    if found.failed:
        reasons = found.folder / "study.csv"
        raise StudyError(f"{len(found.failed)} of {len(found.results)} runs failed: the reasons are in {reasons}")


def _mesh(arguments: argparse.Namespace) -> None:
    from swgpar import api

    design = api.load_design(arguments.design, arguments.overrides)
    mesh = api.mesh(design, arguments.mesh, arguments.out, arguments.format)
    for body, values in mesh.quality.items():
        print(body)
        for name, value in values.items():
            print(f"  {name:30s} {value:.6g}")


def _check(arguments: argparse.Namespace) -> None:
    from swgpar import api

    for name, value in api.check(arguments.design, arguments.overrides).items():
        print(f"{name:40s} {value:.6g}")


def _report(arguments: argparse.Namespace) -> None:
    from swgpar import api

    result = api.open_result(arguments.out)
    for path in result.plot.save(result.folder):
        print(f"figure {path}")


def _check_rest(rest: Sequence[str], petsc: bool) -> None:
    """Refuse what is neither an option of swgpar nor one of PETSc (-name, -name value)."""
    after_option = False
    for word in rest:
        option = petsc and len(word) > 1 and word[0] == "-" and (word[1].isalpha())
        if not option and not after_option:
            near = difflib.get_close_matches(word, OPTIONS, n=1)
            hint = f": did you mean {near[0]}?" if near else "; options of PETSc begin with one dash" if petsc else ""
            raise InputError(f"unknown argument {word}{hint}")
        after_option = option


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; returns the exit code (0, or that of the error)."""
    command = None
    try:
        known, rest = parser().parse_known_args(arguments)
        command = known.command
        solves = command in ("run", "study")
        _check_rest(rest, petsc=solves)
        known.overrides = [item for group in getattr(known, "set", []) for item in group]
        if solves:
            import petsc4py

            petsc4py.init(["swgpar", *rest])
        {"run": _run, "study": _study, "mesh": _mesh, "check": _check, "report": _report}[command](known)
    except SwgparError as error:
        from mpi4py import MPI

        if MPI.COMM_WORLD.rank == 0:
            print(f"swgpar: error: {error}", file=sys.stderr, flush=True)
        return error.exit_code
    except BrokenPipeError:  # the reader of our output has gone
        sys.stderr.close()
        return 1
    except Exception:
        if command not in ("run", "study"):
            raise
        traceback.print_exc()
        from mpi4py import MPI

        MPI.COMM_WORLD.Abort(1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
