"""The command `swgpar`."""

from __future__ import annotations

import argparse
import difflib
import sys
import traceback
from collections.abc import Sequence
from typing import TYPE_CHECKING, NoReturn

from swgpar.errors import InputError, StudyError, SwgparError
from swgpar.version import __version__

if TYPE_CHECKING:
    from mpi4py import MPI

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
docs/studies.md."""

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

    from swgpar.analysis.run_drive import run_drive
    from swgpar.design.design_file import load_design
    from swgpar.gear_trains.train import is_gear_train
    from swgpar.meshing import load_recipe
    from swgpar.results.atomic import on_all

    comm = MPI.COMM_WORLD
    if on_all(comm, lambda: is_gear_train(arguments.design)):
        _run_train(arguments, comm)
        return
    if arguments.mesh is None:
        raise InputError("the following arguments are required: --mesh (see swgpar run --help)")
    design = on_all(comm, lambda: load_design(arguments.design, arguments.overrides))
    recipe = on_all(comm, lambda: load_recipe(arguments.mesh))
    result = run_drive(
        design,
        recipe,
        arguments.out,
        restart=arguments.restart,
        overwrite=arguments.overwrite,
        comm=comm,
        recipe_name=arguments.mesh,
        accuracy=arguments.accuracy,
    )
    if comm.rank == 0:
        _print_result(result)
        if design.output.figures:
            _figures(arguments.out)
    comm.Barrier()


def _run_train(arguments: argparse.Namespace, comm: MPI.Comm) -> None:
    from swgpar.gear_trains.terminal import print_compared
    from swgpar.gear_trains.train import load_train, run_train
    from swgpar.results.atomic import on_all

    for option in ("mesh", "accuracy", "restart"):
        if getattr(arguments, option):
            raise InputError(f"--{option} has no meaning for a gear train: leave it out")
    design = on_all(comm, lambda: load_train(arguments.design, arguments.overrides))
    compared = run_train(design, arguments.out, overwrite=arguments.overwrite, comm=comm)
    if comm.rank == 0:
        print_compared(compared)
        if design.output.figures:
            _figures(arguments.out)
    comm.Barrier()


def _print_result(result) -> None:
    from rich import box
    from rich.table import Table

    from swgpar.log import console

    title = "largest stresses over the bodies (MPa, nodal averages); torque in N·mm, angles in degrees"
    table = Table(title=title, box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))  # fits into 80 columns
    columns = {
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
    table.add_column("step", justify="right", no_wrap=True)
    for title, _ in columns.values():
        table.add_column(title, justify="right", no_wrap=True)
    for row in result.rows:
        table.add_row(str(row["step"]), *(format(row[k], spec) for k, (_, spec) in columns.items()))
    console.print(table)
    if result.means:
        m = result.means
        console.print(
            f"means over the rotation: flexible spline s1 {m['fs_s1']:.1f}, |s3| {m['fs_s3']:.1f}, von Mises "
            f"{m['fs_vm']:.1f} MPa; ring gear von Mises {m['rg_vm']:.1f} MPa; input torque "
            f"{m['wg_torque_Nmm']:.2f} N·mm (energy balance {result.summary['wg_torque_expected_Nmm']:.2f})"
        )
    asked = result.summary["accuracy"]
    if error := result.summary["mesh_error"]:
        others = "others on the way" if asked else "the one of the start"
        console.print(
            f"estimated error by the mesh, under load: s1 {error['fs_s1']:.1f}, |s3| {error['fs_s3']:.1f}, "
            f"von Mises {error['fs_vm']:.1f} MPa (from this mesh and {others})"
        )
    if asked:
        console.print(
            f"accuracy of the largest tensile stress: {asked['asked']:g} asked for, {asked['estimated']:.2g} "
            f"estimated{'' if asked['reached'] else ', NOT reached: no finer mesh that helps is taken'}"
        )
    if left_out := result.summary["condensed_MPa"]:
        console.print(f"condensed sectors leave out {left_out:.2g} MPa of bending stress")
    if error := result.summary["sampling_error"]:
        console.print(
            f"half as many angles change the means by: s1 {error['fs_s1']:.2f}, |s3| {error['fs_s3']:.2f}, "
            f"von Mises {error['fs_vm']:.2f} MPa"
        )
    console.print(
        f"torque balance error {result.summary['balance_error_Nmm']:.1e} N·mm; "
        f"{result.summary['wall_s']:.0f} s on {result.summary['ranks']} ranks"
    )


def _figures(out: str) -> None:
    from pathlib import Path

    from swgpar.analysis.figures import make_figures
    from swgpar.log import console

    try:
        for path in make_figures(Path(out)):
            console.print(f"figure {path}")
    except Exception as error:  # a picture that fails must not cost the run
        console.print(f"figures could not be drawn: {error}")


def _study(arguments: argparse.Namespace) -> None:
    from pathlib import Path

    from mpi4py import MPI

    from swgpar.log import console
    from swgpar.studies import run_study
    from swgpar.studies.table import compare
    from swgpar.studies.terminal import print_results

    out = Path(arguments.out)
    results = run_study(arguments.study, out, restart=arguments.restart, overwrite=arguments.overwrite)
    if MPI.COMM_WORLD.rank == 0:
        print_results(results, compare(results))
        for path in sorted([*out.glob("*.csv"), *out.glob("*.html")]):
            console.print(f"written {path}")
    MPI.COMM_WORLD.Barrier()  # mpirun ends all ranks when one of them fails
    failed = sum(outcome.status == "failed" for _, outcome in results)
    if failed:
        raise StudyError(f"{failed} of {len(results)} runs failed: the reasons are in {out / 'study.csv'}")


def _mesh(arguments: argparse.Namespace) -> None:
    from pathlib import Path

    from swgpar.design.design_file import load_design
    from swgpar.meshing import build_sector_meshes, load_recipe
    from swgpar.meshing.export import mesh_report, write_mesh

    design = load_design(arguments.design, arguments.overrides)
    meshes = build_sector_meshes(design, load_recipe(arguments.mesh))
    write_mesh(design, meshes, Path(arguments.out), tuple(arguments.format))
    for body, values in mesh_report(meshes).items():
        print(body)
        for name, value in values.items():
            print(f"  {name:30s} {value:.6g}")


def _check(arguments: argparse.Namespace) -> None:
    from swgpar.design.derived_geometry import derived_geometry
    from swgpar.design.design_file import load_design
    from swgpar.gear_trains.train import is_gear_train, load_train, model_of

    if is_gear_train(arguments.design):
        train = load_train(arguments.design, arguments.overrides)
        values = model_of(train).derived(train)
    else:
        values = derived_geometry(load_design(arguments.design, arguments.overrides))
    for name, value in values.items():
        print(f"{name:40s} {value:.6g}")


def _report(arguments: argparse.Namespace) -> None:
    from pathlib import Path

    from swgpar.analysis.figures import make_figures
    from swgpar.log import console

    for path in make_figures(Path(arguments.out)):
        console.print(f"figure {path}")


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
