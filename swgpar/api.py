"""The Python interface: what the command line, drivers and notebooks call. The names are those of
`import swgpar`.

Under mpirun every rank calls the same functions with the same arguments; results are the same on
all ranks. An error of swgpar is raised on all ranks. Any other error of one rank leaves the others
waiting: `mpirun -n 2 python -m mpi4py script.py` ends all ranks then.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from mpi4py import MPI

from swgpar import log
from swgpar.analysis.shortcuts import MESHES
from swgpar.checks.starter import CamType, Model, Profile, Request, Shape, as_toml, starter_design
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError, OutputError, SwgparError
from swgpar.input.design import Design
from swgpar.input.toml_file import Overrides, apply_overrides, read_toml, require_source
from swgpar.meshing import MeshRecipe, build_sector_meshes
from swgpar.meshing import load_recipe as _load_recipe
from swgpar.meshing.recipe import make_recipe
from swgpar.results.atomic import agreed, on_all, raise_first, sentence, write_file, write_from_root
from swgpar.results.figure_set import save_figures
from swgpar.results.folder import REPORT, given_folder, read_design
from swgpar.run_options import RunOptions
from swgpar.systems import Result, system_of_section, system_of_table

if TYPE_CHECKING:
    from swgpar.meshing.drive_mesh import DriveMesh
    from swgpar.presentation.drive_result import DriveResult

DesignLike = Design | str | Path | Mapping[str, Any]
"""A design, the path of its file, or the content of one."""

MeshLike = MeshRecipe | str | Path | Mapping[str, Any]
"""A mesh recipe, its name in the package, the path of its file, or the content of one."""


def new(
    out: str | Path | None = None,
    *,
    ratio: float,
    torque: float,
    diameter: float | None = None,
    bore: float | None = None,
    profile: Profile = "quadruple_arc",
    cam: CamType | None = None,
    layout: Literal["ring_fixed", "spline_fixed"] = "ring_fixed",
    model: Model = "cup",
    shape: Shape = "cup",
    lobes: Literal[2, 3] = 2,
    overwrite: bool = False,
) -> DriveDesign:
    """A checked design to start from; collective when it is written.

    Parameters
    ----------
    out : path
        Design file to write, with the meaning of every key.
    ratio : float
        Speed of the wave generator over that of the output, without its sign; a multiple of 0.5,
        with three lobes a whole number.
    torque : float, N·m
        On the output.
    diameter, bore : float, mm
        Pitch diameter or inner diameter of the flexible spline; one of both.
    profile : "quadruple_arc", "double_arc" or "involute"
    cam : "elliptical", "parabolic", "simplified", "four_roller" or "harmonic"
        Without it the ellipse, and with three lobes the harmonic cam.
    layout : "ring_fixed" or "spline_fixed"
    model : "cup", "plane" or "pancake", as in the section [drive]
    shape : "cup", "short" (a cup of half the length) or "hat" (silk hat, with a flange outwards)
    lobes : 2 or 3, of the cam
    overwrite : bool
        Replace a file that exists.

    Raises
    ------
    InputError
        A number that is out of range.
    OutputError
        The file exists, or cannot be written.

    Examples
    --------
    >>> design = swgpar.new(ratio=100, diameter=50.8, torque=52.0)
    >>> design.drive.teeth_fs, design.drive.module
    (200, 0.254)
    """
    cam = cam or ("elliptical" if lobes == 2 else "harmonic")
    request = Request(ratio, torque, diameter, bore, profile, cam, layout, model, shape, lobes)
    design, table = starter_design(request)
    build_sector_meshes(design.geometry, _load_recipe(MESHES[model]))
    if out is not None:
        path, comm = Path(out), MPI.COMM_WORLD
        with agreed(comm, path):
            if comm.rank == 0 and path.exists() and not overwrite:
                raise OutputError(
                    f"{path} exists: replace it with overwrite = true (--overwrite), or give "
                    "another name"
                )
        write_from_root(comm, path, as_toml(request, design, table, path.name).encode())
    return design


def load_design(design: DesignLike, overrides: Overrides = ()) -> Design:
    """Read and check a design.

    Parameters
    ----------
    design : path, mapping or design
        A design file (TOML), or its content as a dict of sections: of a drive, or of a gear train.
        A design that is loaded already is changed by the overrides only.
    overrides : mapping or sequence of str
        Values for keys, ``{"load.torque": 10.0}`` or ``["load.torque=10.0"]``, in the units of the
        design file.

    Returns
    -------
    Design
        A `DriveDesign` or the design of a gear train; attributes are the sections.

    Raises
    ------
    InputError
        The file cannot be read, or a key or value is refused.

    Examples
    --------
    >>> design = swgpar.load_design("drivers/cup_45deg.toml", {"load.torque": 10.0})
    >>> design.drive.teeth_fs
    120
    """
    if isinstance(design, Design):
        return design.with_values(overrides) if overrides else design
    require_source("design", design)
    table = dict(design) if isinstance(design, Mapping) else read_toml(design)
    return system_of_table(table).load(apply_overrides(table, overrides))


def load_mesh(mesh: MeshLike) -> MeshRecipe:
    """Read and check a mesh recipe: how many elements go where.

    Parameters
    ----------
    mesh : str, path, mapping or recipe
        A name (coarse, forces, medium, full; plane_coarse, plane, plane_fine), the path of a recipe
        (TOML), or its content. A recipe that is loaded already is returned.

    Raises
    ------
    InputError
        There is no such recipe, or a key or value is refused.

    Examples
    --------
    >>> swgpar.load_mesh("coarse").cup.cylinder
    10
    """
    if isinstance(mesh, MeshRecipe):
        return mesh
    require_source("mesh", mesh)
    return make_recipe(dict(mesh)) if isinstance(mesh, Mapping) else _load_recipe(mesh)


def run(
    design: DesignLike,
    mesh: MeshLike | None = None,
    out: str | Path | None = None,
    *,
    accuracy: float | None = None,
    plain: bool = False,
    restart: bool = False,
    overwrite: bool = False,
    progress: bool | None = None,
    comm: MPI.Comm = MPI.COMM_WORLD,
) -> Result:
    """Run a design; collective.

    Parameters
    ----------
    design : design, path or mapping
        As `load_design` takes it.
    mesh : recipe, name, path or mapping
        As `load_mesh` takes it. Without one a drive takes the recipe forces, a plane model
        plane_coarse; the stress at the teeth comes from windows on finer meshes. Gear trains have
        none.
    out : path
        Results folder. Without it the run is in memory and leaves no files.
    accuracy : float
        Refine the mesh and the windows until the estimated relative error of the largest tensile
        stress at the teeth under load is at most this (0.001 to 0.2); drives only.
    plain : bool
        Compute all that the design asks for. Otherwise a drive without friction leaves out the
        assembly step by step and on a fine mesh, and the angles beyond one period, where the design
        does not set the keys ``steps.bent_start``, ``steps.start_levels``, ``steps.samples`` and
        ``solver.rtol``.
    restart : bool
        Continue from the checkpoint in `out`.
    overwrite : bool
        Replace results that `out` already holds.
    progress : bool
        Report every increment on the terminal. Default: only on a terminal.

    Returns
    -------
    DriveResult or TrainResult
        The same on every rank.

    Raises
    ------
    InputError
        Design, mesh and options do not fit.
    ConvergenceError
        An increment did not converge. With `out`, the increments before it are kept and `restart`
        continues them.
    TimeLimitError
        The time of ``solver.time_limit`` has passed. The increments before are kept as with a
        ConvergenceError.
    OutOfMemoryError
        An allocation has failed, perhaps on this rank alone.
    OutputError
        The folder cannot be written, or holds other results.

    Examples
    --------
    >>> result = swgpar.run("drivers/plane_half_turn.toml")
    >>> result.summary["root.s1"].value, result.history["fs_s1"].max()
    """
    folder = None if out is None else given_folder(out)
    terminal = log.console.is_terminal if progress is None else progress
    given = RunOptions(
        folder,
        accuracy=accuracy,
        plain=plain,
        restart=restart,
        overwrite=overwrite,
        comm=comm,
        terminal=terminal,
    )
    checked, options = on_all(comm, lambda: _checked(design, mesh, given))
    with log.session(comm, terminal=terminal):
        system = system_of_section(checked.system)
        result = system.run(checked, options)
        if folder is not None:
            if system.draws_figures(checked):
                save_figures(result.plot, folder)
            try:
                save_report(result, folder, comm)
            except SwgparError as error:  # a page that fails must not cost the run
                log.logger.warning("%s", error)
    return result


def save_report(result: Result, folder: str | Path, comm: MPI.Comm = MPI.COMM_WORLD) -> None:
    """Write report.html of a result into its folder: what the run gives, on one page; collective.

    Raises
    ------
    OutputError
        The page cannot be made or written.
    """
    path = Path(folder) / REPORT
    failure: SwgparError | None = None
    if comm.rank == 0:
        try:
            write_file(path, system_of_table(result.design_table).report(result))
        except Exception as error:  # whatever a drawing raises
            failure = OutputError(f"cannot write {path}: {sentence(error)}")
    raise_first(comm, failure)


def export(
    source: DesignLike | DriveResult,
    out: str | Path,
    formats: Sequence[str],
    *,
    mesh: MeshLike | None = None,
    ripple: str | Path | DriveResult | None = None,
    idle: str | Path | DriveResult | None = None,
) -> list[Path]:
    """Write files of other programs and return them; collective, rank 0 writes.

    Parameters
    ----------
    source : design, or result
        A design or its file, a result of a drive, or the folder of one.
    out : path
        Folder, which is made.
    formats : sequence of str
        Of a design "step" (solids), "dxf" (outlines), "csv" (points of the cam), "teeth" (points of
        the flanks, CSV and DXF) and "inp" (job of CalculiX up to the loaded state), of a result
        "vtkhdf" and "xdmf" (fields with all teeth), "parquet" (all tables), "lookup" (torsional
        spring and ripple for multibody programs) and "fmu" (the same as an FMU).
    mesh : str, path or MeshRecipe
        Mesh of the format "inp".
    ripple : result of a drive, or the folder of one
        For "fmu": run with steps.samples or [deviations] of the same drive. Without it there is no
        kinematic error.
    idle : result of a drive, or the folder of one
        For "fmu" and "lookup": run of the same drive with [losses] and load.torque = 0. With it the
        loss torque grows with the load; without it that of the run holds under any load.

    Raises
    ------
    InputError
        A format that the source does not have, a source that is no drive, a package that is
        missing, or what a format does not carry.
    OutputError
        The folder cannot be written, or a C compiler fails with the FMU.

    Examples
    --------
    >>> swgpar.export("drivers/cup_45deg.toml", "results/cad", ["step"])
    >>> swgpar.export(
    ...     "drivers/plane_half_turn.toml", "results/calculix", ["inp"], mesh="plane_coarse"
    ... )
    >>> swgpar.export("results/cup", "results/cup/export", ["vtkhdf", "parquet"])
    >>> swgpar.export("results/stiffness", "results/fmu", ["fmu"], ripple="results/period")
    """
    from swgpar.exchange.export import export_files  # CAD kernels and tables are for this alone
    from swgpar.presentation.drive_result import DriveResult

    drive: Design | Result
    if isinstance(source, (str, Path)) and Path(source).is_dir():
        drive = open_result(source)
    else:
        drive = source if isinstance(source, DriveResult) else load_design(source)
    periodic, without_load = (
        open_result(one) if isinstance(one, (str, Path)) else one for one in (ripple, idle)
    )
    if (
        not isinstance(drive, DriveDesign | DriveResult)
        or not isinstance(periodic, DriveResult | None)
        or not isinstance(without_load, DriveResult | None)
    ):
        raise InputError(
            "export is available for drives: a gear train has no geometry and no fields"
        )
    recipe = None if mesh is None else load_mesh(mesh)
    paths: list[Path] = []
    with agreed(MPI.COMM_WORLD, Path(out)):
        if MPI.COMM_WORLD.rank == 0:
            paths = export_files(
                drive, Path(out), formats, recipe=recipe, ripple=periodic, idle=without_load
            )
    return MPI.COMM_WORLD.bcast(paths)


def open_result(folder: str | Path, comm: MPI.Comm = MPI.COMM_WORLD) -> Result:
    """Read the result of a finished run from its folder; collective.

    Parameters
    ----------
    folder : path
    comm : communicator
        MPI.COMM_SELF where one rank reads alone.

    Returns
    -------
    DriveResult or TrainResult
        The same on every rank.

    Raises
    ------
    OutputError
        The folder is not that of a finished run.

    Examples
    --------
    >>> swgpar.open_result("results/plane").summary["mean.fs_s1"].value
    """
    folder = Path(folder)
    with agreed(comm, folder, "read"):
        system = system_of_table(read_design(folder))
    return system.open(folder, comm)


def check(
    design: DesignLike, overrides: Overrides = (), mesh: MeshLike | None = None
) -> dict[str, float]:
    """Derived geometry of a design, without a run; with a mesh also what a run on it will need.

    Returns
    -------
    dict of float
        Values by name; the names have units. With a mesh: elements, unknowns, memory and time.

    Raises
    ------
    InputError
        As `load_design` and `load_mesh`, or the mesh does not fit into the memory of this machine.

    Examples
    --------
    >>> swgpar.check("drivers/cup_45deg.toml")["ratio (wave generator / output)"]
    -60.0
    """
    checked = load_design(design, overrides)
    values = system_of_section(checked.system).check(checked)
    return values if mesh is None else values | _needs(_drive(checked), load_mesh(mesh))


def _drive(design: Design) -> DriveDesign:
    if not isinstance(design, DriveDesign):
        raise InputError(f"{system_of_section(design.system).noun} has no mesh: allowed are drives")
    return design


def _needs(design: DriveDesign, recipe: MeshRecipe) -> dict[str, float]:
    from swgpar.analysis.forecast import forecast, require_memory

    needs = forecast(design, recipe)
    require_memory(needs, design.solver.memory_limit)
    build_sector_meshes(design.geometry, recipe)  # or the reason why the recipe gives no mesh
    return {
        "elements of the drive": needs.elements,
        "unknowns modelled": needs.unknowns,
        "memory of all ranks, about (GB)": needs.memory,
        "time of a run on 2 cores, about (s)": needs.seconds,
    }


def mesh(
    design: DesignLike,
    mesh: MeshLike,
    out: str | Path | None = None,
    formats: Sequence[str] = ("vtu",),
    comm: MPI.Comm = MPI.COMM_WORLD,
) -> DriveMesh:
    """The mesh of a whole drive; collective when it is written.

    Parameters
    ----------
    design : design, path or mapping
    mesh : recipe, name, path or mapping
    out : path
        Folder into which rank 0 writes the mesh.
    formats : sequence of str
        Files to write: "vtu" (ParaView), "msh" (Gmsh), "inp" (Abaqus, CalculiX).

    Raises
    ------
    InputError
        The design is not that of a drive, or the recipe turns an element inside out.
    OutputError
        The folder cannot be written.

    Examples
    --------
    >>> swgpar.mesh("drivers/cup_45deg.toml", "coarse").quality["ring_gear"]["min_scaled_jacobian"]
    """

    from swgpar.meshing.drive_mesh import DriveMesh  # with what writes files of meshes

    def make() -> DriveMesh:
        drive = _drive(load_design(design))
        sectors = build_sector_meshes(drive.geometry, load_mesh(mesh))
        return DriveMesh(sectors, drive.materials, drive.drive.face_width)

    if out is None:
        return make()
    folder = given_folder(out)
    whole = on_all(comm, make)
    on_all(comm, lambda: whole.write(folder, formats) if comm.rank == 0 else None)
    return whole


def _checked(
    design: DesignLike, mesh: MeshLike | None, options: RunOptions
) -> tuple[Design, RunOptions]:
    """The design of a run, and its options with the mesh; refuses options that the design's system
    does not have."""
    checked = load_design(design)
    system = system_of_section(checked.system)
    options.require_available(system.options, system.noun, mesh=mesh is not None)
    if mesh is None:
        return checked, options
    name = str(mesh) if isinstance(mesh, (str, Path)) else ""
    return checked, replace(options, recipe=load_mesh(mesh), recipe_name=name)
