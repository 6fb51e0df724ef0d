"""Designs and recipes from files or their content, runs, results and their export."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mpi4py import MPI

from swgpar import log
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError, OutputError, SwgparError
from swgpar.input.arguments import given_path, given_texts
from swgpar.input.design import Design
from swgpar.input.toml_file import Overrides, read_toml, require_source
from swgpar.meshing import MeshRecipe, load_recipe
from swgpar.meshing.recipe import make_recipe
from swgpar.petsc import release_unused
from swgpar.results.atomic import agreed, on_all, raise_first, reason_of, write_file
from swgpar.results.figure_set import save_figures
from swgpar.results.folder import REPORT, read_summary
from swgpar.run_options import RunOptions
from swgpar.systems import Result, system_of_section, system_of_table

if TYPE_CHECKING:
    from swgpar.presentation.drive_result import DriveResult
    from swgpar.systems.drive import Drives

DesignLike = Design | str | Path | Mapping[str, Any]
"""A design, the path of its file, or the content of one."""

MeshLike = MeshRecipe | str | Path | Mapping[str, Any]
"""A mesh recipe, its name in the package, the path of its file, or the content of one."""


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
    return system_of_table(table).load(table, overrides)


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
    return make_recipe(dict(mesh)) if isinstance(mesh, Mapping) else load_recipe(mesh)


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
    given = RunOptions.given(
        out,
        progress,
        accuracy=accuracy,
        plain=plain,
        restart=restart,
        overwrite=overwrite,
        comm=comm,
    )
    return run_with(given, design, mesh)


def run_with(
    given: RunOptions, design: DesignLike, mesh: MeshLike | None, drives: Drives | None = None
) -> Result:
    """Run a design, a drive by an adapter whose runs share models; collective.

    given : options without a mesh;  drives : None where each run builds its own models
    """
    folder, comm = given.out, given.comm
    checked, options = on_all(comm, lambda: _checked(design, mesh, given))
    with log.session(comm, terminal=given.terminal):
        system = system_of_section(checked.system)
        if drives is not None and isinstance(checked, DriveDesign):
            system = drives
        result = system.run(checked, options)
        release_unused(comm)  # runs in a loop would fill the memory
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
            failure = OutputError(f"cannot write {path}: {reason_of(error)}")
    raise_first(comm, failure)


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
    folder = given_path("folder", folder)
    with agreed(comm, folder, "read"):
        system = system_of_table(read_summary(folder).design)
    return system.open(folder, comm)


def _checked(
    design: DesignLike, mesh: MeshLike | None, options: RunOptions
) -> tuple[Design, RunOptions]:
    """The design of a run, and its options with the mesh; refuses options that the design's system
    does not have."""
    checked = load_design(design)
    system = system_of_section(checked.system)
    options.require_available(system.options, system.noun, mesh=mesh is not None)
    return checked, with_mesh(options, mesh)


def with_mesh(options: RunOptions, mesh: MeshLike | None) -> RunOptions:
    """The options with a mesh recipe, if one is given, and its name as the user gave it."""
    if mesh is None:
        return options
    name = str(mesh) if isinstance(mesh, (str, Path)) else ""
    return replace(options, recipe=load_mesh(mesh), recipe_name=name)


def export(
    source: DesignLike | DriveResult,
    out: str | Path,
    formats: Sequence[str],
    *,
    mesh: MeshLike | None = None,
    ripple: str | Path | DriveResult | None = None,
    idle: str | Path | DriveResult | None = None,
    overwrite: bool = False,
) -> list[Path]:
    """Write files of other programs and return them; collective, rank 0 writes.

    Parameters
    ----------
    source : design, or result
        A design or its file, a result of a drive, or the folder of one.
    out : path
        Folder, which is made.
    formats : sequence of str
        Of a design "step" (solids), "dxf" (outlines), "csv" (points of the cam, and of a cup's wall
        and end), "teeth" (points of the flanks, CSV and DXF) and "inp" (job of CalculiX up to the
        loaded state), of a result "vtkhdf" and "xdmf" (fields with all teeth), "parquet" (all
        tables), "lookup" (torsional spring and ripple for multibody programs) and "fmu" (the same
        as an FMU).
    mesh : str, path or MeshRecipe
        Mesh of the format "inp".
    ripple : result of a drive, or the folder of one
        For "fmu": run with steps.samples or [deviations] of the same drive. Without it there is no
        kinematic error.
    idle : result of a drive, or the folder of one
        For "fmu" and "lookup": run of the same drive with [losses] and load.torque = 0. With it the
        loss torque grows with the load; without it that of the run holds under any load.
    overwrite : bool
        Replace files of the same names in `out`.

    Raises
    ------
    InputError
        A format that the source does not have, a source that is no drive, a package that is
        missing, or what a format does not carry.
    OutputError
        The folder cannot be written, a file is there already, or a C compiler fails with the FMU.

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
    folder, names = given_path("out", out), given_texts("formats", formats)
    with agreed(MPI.COMM_WORLD, folder):
        if MPI.COMM_WORLD.rank == 0:
            paths = export_files(
                drive,
                folder,
                names,
                recipe=recipe,
                ripple=periodic,
                idle=without_load,
                overwrite=overwrite,
            )
    return MPI.COMM_WORLD.bcast(paths)
