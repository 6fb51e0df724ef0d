"""The parser of the command line, with its texts and examples."""

from __future__ import annotations

import argparse
from typing import NoReturn, TypeAlias

from swgpar.errors import InputError
from swgpar.version import __version__

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

RATE = """Rate a drive: one sheet with all answers beside requirements and limits, each with its error and a verdict.
The design file has a section [rating] with torques, speeds and what is required. Answers that one run cannot give
together come from several, which follow each other. Unknown options are passed to PETSc."""

RATE_EXAMPLES = """examples:
  mpirun -n 2 swgpar rate drive.toml --out results/rating
  mpirun -n 2 swgpar rate drive.toml --out results/rating --restart
  mpirun -n 2 swgpar rate drive.toml --accuracy 0.02 --out results/accurate
  swgpar rate drive.toml --set rating.momentary_torque=60 --out results/momentary

in the design file:
  [rating]
  rated_torque = 20.0           # N·m
  repeated_peak_torque = 30.0
  momentary_torque = 60.0
  life = 7000.0                 # h, of the bearing
  K1 = 8000.0                   # N·m/rad, at least
  efficiency = 0.7

--restart keeps finished runs, continues interrupted ones and tries failed ones again.
"""

MESH_EXAMPLES = """examples:
  swgpar mesh drivers/cup_45deg.toml --mesh coarse --out results/mesh --format vtu inp
  swgpar mesh drivers/plane_half_turn.toml --mesh my_recipe.toml --out results/mesh
"""

CHECK = "Check a design and print its derived geometry, and what a run will need."

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
  swgpar new drive.toml --ratio 40 --diameter 120 --torque 20 --lobes 3
  swgpar new plane.toml --ratio 50 --diameter 42 --torque 2 --model plane
  swgpar new flat.toml --ratio 60 --diameter 120 --torque 20 --model pancake
  swgpar new stage.toml --train planetary_stage --ratio 5.7 --diameter 1000 --torque 200000
"""

OPTIMISE = """Search for the best design: any keys of the design file as variables within bounds, any quantities that
studies know as objectives and constraints. Designs that are refused or fail are infeasible. The file is described in
docs/howto/optimise.md. Unknown options are passed to PETSc."""

OPTIMISE_EXAMPLES = """examples:
  mpirun -n 2 swgpar optimise drivers/optimise/parabolic_cam.toml --out results/cam
  mpirun -n 2 swgpar optimise drivers/optimise/parabolic_cam.toml --out results/cam --restart

--restart continues the search, with more evaluations if the file asks for them.
"""

VIEW = "Show the deformed drive of a finished run in a window."

VIEW_EXAMPLES = """example:
  swgpar view results/coarse
"""

EXPORT = """Write files of other programs: the geometry of a design (step, dxf, csv), a job up to its loaded state (inp),
or fields and tables of a finished run (vtkhdf, xdmf, parquet, lookup, fmu)."""

EXPORT_EXAMPLES = """examples:
  swgpar export drivers/cup_45deg.toml --format step dxf --out results/cad
  swgpar export drivers/plane_half_turn.toml --format inp --mesh plane_coarse --out results/calculix
  swgpar export results/cup --format vtkhdf parquet --out results/cup/export
  swgpar export results/stiffness --ripple results/period --format fmu --out results/fmu
"""

APP = """Open a design in the browser: change keys, see the teeth and their gaps, compute. The page is on this machine only,
behind the address that the command prints. It needs the extra swgpar[app]."""

APP_EXAMPLES = """examples:
  swgpar app drivers/cup_45deg.toml
  swgpar app my_workspace
  swgpar app my_workspace --port 8080 --no-browser
"""

REPORT = "Draw the figures of a finished run again, and write its report.html."

REPORT_EXAMPLES = """example:
  swgpar report results/coarse
"""

ACCURACY = """refine the mesh and the windows until the estimated error of the largest tensile stress at the teeth
under load is at most A (0.02: 2 %%; 0.001 to 0.2). Without other values in the design, one period is computed in 2
(from 0.04), 4, 8 or 16 angles. The mesh has at most 1,500,000 elements in the plane, 700,000 in space"""

RATE_ACCURACY = """refine the meshes of the runs whose stresses the sheet has, until the estimated error of the
largest tensile stress at the teeth is at most A (0.02: 2 %%; 0.001 to 0.2). With a bearing, and in load programs, the
mesh is that of the recipe"""

PLAIN = """compute all that the design asks for: without this, a drive without friction leaves out the assembly step by
step and further periods, where the design does not set their keys"""

FORMATS = """step: solids of gears and cam; dxf: their outlines; csv: points of the cam, and of a cup's wall and
end; inp: job of CalculiX; vtkhdf, xdmf: fields with all teeth; parquet: tables; lookup: torsional spring and ripple
for multibody programs; fmu: the same as an FMU (FMI 2.0)"""

MODELS = "cup drive, toothed section in plane stress, two ring gears"
SHAPES = "flexible spline: a cup, one of half the length, a silk hat"
MESH_HELP = (
    "mesh recipe: coarse, forces, medium, full, plane_coarse, plane, plane_fine, or the path of a "
    "file (TOML)"
)


class _Parser(argparse.ArgumentParser):
    """Reports a bad command line like any other bad input: one sentence, from one rank."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message} (see {self.prog} --help)")

    def options(self) -> list[str]:
        """Names of the options, with their dashes."""
        return list(self._option_string_actions)


_Commands: TypeAlias = "argparse._SubParsersAction[_Parser]"


def parser() -> _Parser:
    """Argument parser of all subcommands; `parser` of its namespace is that of the subcommand."""
    top = _Parser(
        prog="swgpar",
        description="Contact finite-element analysis of strain wave gears, and models of the gear "
        "trains around them.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action="version", version=f"swgpar {__version__}")
    commands = top.add_subparsers(
        dest="command",
        required=True,
        metavar="new | check | mesh | run | rate | study | optimise | report | view | export | app",
    )
    _add_new(commands)
    _add_run(commands)
    rate = _add_command(commands, "rate", RATE, RATE_EXAMPLES)
    _add_design(rate)
    text = "(default: forces, for a plane model plane_coarse)"
    rate.add_argument("--mesh", help=f"{MESH_HELP} {text}")
    rate.add_argument("--accuracy", type=float, metavar="A", help=RATE_ACCURACY)
    _add_out(rate, "folder of the sheet and its runs", "continue the rating in --out", "a rating")
    study = _add_command(commands, "study", STUDY, STUDY_EXAMPLES)
    study.add_argument("study", help="study file (TOML)")
    _add_out(study, "folder of the study", "continue the study in --out", "a study")
    optimise = _add_command(commands, "optimise", OPTIMISE, OPTIMISE_EXAMPLES)
    optimise.add_argument("optimisation", help="optimisation file (TOML)")
    _add_out(optimise, "folder of the results", "continue the search in --out", "a search")
    mesh = _add_command(commands, "mesh", "Write the mesh of the whole drive.", MESH_EXAMPLES)
    _add_design(mesh)
    mesh.add_argument("--mesh", required=True, help=MESH_HELP)
    mesh.add_argument("--out", required=True, help="folder for the mesh files")
    formats = ["vtu", "msh", "inp"]
    text = "vtu for ParaView, msh for Gmsh, inp for Abaqus and CalculiX (default: all)"
    mesh.add_argument("--format", nargs="+", default=formats, choices=formats, help=text)
    _add_overwrite(mesh, "files of the same names in --out")
    check = _add_command(commands, "check", CHECK, CHECK_EXAMPLES)
    _add_design(check)
    text = "prints elements, unknowns, memory and time to expect"
    check.add_argument("--mesh", help=f"{MESH_HELP}: {text}")
    report = _add_command(commands, "report", REPORT, REPORT_EXAMPLES)
    report.add_argument("out", help="results folder")
    _add_export(commands)
    view = _add_command(commands, "view", VIEW, VIEW_EXAMPLES)
    view.add_argument("out", help="results folder")
    app = _add_command(commands, "app", APP, APP_EXAMPLES)
    text = "workspace folder, or a design file in it (default: this folder)"
    app.add_argument("source", nargs="?", default=".", help=text)
    app.add_argument("--port", type=int, metavar="N", help="of the page (default: a free one)")
    text = "print the address without opening a browser"
    app.add_argument("--no-browser", action="store_true", help=text)
    return top


def _add_command(commands: _Commands, name: str, text: str, examples: str) -> _Parser:
    command = commands.add_parser(
        name,
        help=text.partition(".")[0].lower(),
        description=text,
        epilog=examples,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(parser=command)
    return command


def _add_design(command: _Parser, name: str = "design", text: str = "design file (TOML)") -> None:
    command.add_argument(name, help=text)
    command.add_argument(
        "--set",
        action="append",
        default=[],
        nargs="+",
        metavar="section.key=value",
        help="set keys of the design file",
    )


def _add_out(command: _Parser, folder: str, restart: str, present: str) -> None:
    """The folder of results, and what happens to what it already holds."""
    command.add_argument("--out", required=True, help=folder)
    command.add_argument("--restart", action="store_true", help=restart)
    _add_overwrite(command, f"{present} that --out already holds")


def _add_overwrite(command: _Parser, what: str) -> None:
    command.add_argument("--overwrite", action="store_true", help=f"replace {what}")


def _add_new(commands: _Commands) -> None:
    new = _add_command(commands, "new", NEW, NEW_EXAMPLES)
    new.add_argument("design", help="design file to write (TOML)")
    text = (
        "a gear train instead of a drive: ratio of sun over carrier, pitch diameter of the ring, "
    )
    text += "torque on the carrier"
    new.add_argument("--train", choices=("planetary_stage",), help=text)
    text = "speed of the wave generator over that of the output"
    new.add_argument("--ratio", type=float, required=True, help=text)
    size = new.add_mutually_exclusive_group(required=True)
    for name, text in (("--diameter", "pitch diameter"), ("--bore", "inner diameter")):
        size.add_argument(name, type=float, metavar="D", help=f"{text} of the flexible spline, mm")
    new.add_argument("--torque", type=float, required=True, metavar="T", help="on the output, N·m")
    for name, choices, text in (
        ("--layout", ("ring_fixed", "spline_fixed"), "fixed member"),
        ("--model", ("cup", "plane", "pancake"), MODELS),
        ("--shape", ("cup", "short", "hat"), SHAPES),
    ):
        text = f"{text} (default: {choices[0]})"
        new.add_argument(name, choices=choices, default=choices[0], help=text)
    profiles = ("s_shaped", "quadruple_arc", "double_arc", "involute")
    text = "profile of the teeth (default: s_shaped with a conjugate ring gear; quadruple_arc in a "
    text += "pancake drive, and with cams other than the ellipse)"
    new.add_argument("--profile", choices=profiles, help=text)
    cams = ("elliptical", "parabolic", "simplified", "four_roller", "harmonic")
    text = "cam of the wave generator (default: elliptical, with three lobes harmonic)"
    new.add_argument("--cam", choices=cams, help=text)
    text = "lobes of the cam (default: 2)"
    new.add_argument("--lobes", type=int, choices=(2, 3), default=2, help=text)
    _add_overwrite(new, "a file that exists")


def _add_export(commands: _Commands) -> None:
    export = _add_command(commands, "export", EXPORT, EXPORT_EXAMPLES)
    _add_design(export, "source", "design file (TOML), or results folder")
    export.add_argument("--out", required=True, help="folder for the files")
    formats = ["step", "dxf", "csv", "teeth", "inp", "vtkhdf", "xdmf", "parquet", "lookup", "fmu"]
    export.add_argument("--format", nargs="+", required=True, choices=formats, help=FORMATS)
    text = "for fmu: results of the same drive with steps.samples or [deviations]"
    export.add_argument("--ripple", metavar="FOLDER", help=text)
    text = "for fmu and lookup: results of the same drive with [losses] and load.torque = 0"
    export.add_argument("--idle", metavar="FOLDER", help=text)
    export.add_argument("--mesh", help=f"of the format inp; {MESH_HELP}")
    _add_overwrite(export, "files of the same names in --out")


def _add_run(commands: _Commands) -> None:
    run = _add_command(commands, "run", RUN, RUN_EXAMPLES)
    _add_design(run)
    text = "(default: forces, for a plane model plane_coarse); gear trains have none"
    run.add_argument("--mesh", help=f"{MESH_HELP} {text}")
    run.add_argument("--accuracy", type=float, metavar="A", help=ACCURACY)
    run.add_argument("--plain", action="store_true", help=PLAIN)
    _add_out(run, "results folder", "continue from the checkpoint in --out", "results")
