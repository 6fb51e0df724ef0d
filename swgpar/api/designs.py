"""What there is of a design without a run: a new one, derived sizes, its mesh."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from mpi4py import MPI

from swgpar import log
from swgpar.analysis.shortcuts import MESHES
from swgpar.api.runs import DesignLike, MeshLike, load_design, load_mesh
from swgpar.checks.starter import (
    Layout,
    Lobes,
    Model,
    Request,
    Shape,
    starter_design,
    usual_profile,
)
from swgpar.checks.starter_cam import CamType
from swgpar.checks.starter_file import as_toml
from swgpar.checks.starter_teeth import Profile
from swgpar.checks.starter_torques import overload
from swgpar.design.drive_design import DriveDesign
from swgpar.errors import InputError, OutputError
from swgpar.input.arguments import given_path, given_texts
from swgpar.input.design import Design
from swgpar.input.toml_file import Overrides
from swgpar.meshing import MeshRecipe, build_sector_meshes
from swgpar.results.atomic import agreed, on_all, write_from_root
from swgpar.systems import system_of_section

if TYPE_CHECKING:
    from swgpar.meshing.drive_mesh import DriveMesh


def new(
    out: str | Path | None = None,
    *,
    ratio: float,
    torque: float,
    diameter: float | None = None,
    bore: float | None = None,
    profile: Profile | None = None,
    cam: CamType | None = None,
    layout: Layout = "ring_fixed",
    model: Model = "cup",
    shape: Shape = "cup",
    lobes: Lobes = 2,
    overwrite: bool = False,
    warn: Callable[[str], None] | None = None,
) -> DriveDesign:
    """A checked design to start from; collective when it is written. A torque that is more than
    its rating allows is a warning, which names the torque that it carries.

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
    profile : "s_shaped", "quadruple_arc", "double_arc" or "involute"
        Without it S-shaped teeth with a conjugate ring gear for cups and plane drives with an
        elliptical cam, and the quadruple arc for others.
    cam : "elliptical", "parabolic", "simplified", "four_roller" or "harmonic"
        Without it the ellipse, and with three lobes the harmonic cam.
    layout : "ring_fixed" or "spline_fixed"
    model : "cup", "plane" or "pancake", as in the section [drive]
    shape : "cup", "short" (a cup of half the length) or "hat" (silk hat, with a flange outwards)
    lobes : 2 or 3, of the cam
    overwrite : bool
        Replace a file that exists.
    warn : function
        Called with the sentence of a warning, on all ranks. Without it rank 0 logs the warning.

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
    profile = profile or usual_profile(model, cam, lobes)
    request = Request(ratio, torque, diameter, bore, profile, cam, layout, model, shape, lobes)
    design, table = starter_design(request)
    build_sector_meshes(design.geometry, load_mesh(MESHES[model]))
    if out is not None:
        path = given_path("out", out)
        _write_new(path, as_toml(request, design, table, path.name), overwrite)
    if too_much := overload(request, design):
        (warn or _warn)(too_much)
    return design


def new_train(
    out: str | Path | None = None,
    *,
    train: Literal["planetary_stage"],
    ratio: float,
    diameter: float,
    torque: float,
    overwrite: bool = False,
) -> Design:
    """A checked gear train to start from; collective when it is written.

    Parameters
    ----------
    out : path
        Design file to write, with the meaning of every key.
    train : "planetary_stage"
        Model of the gear train.
    ratio : float
        Speed of the sun over that of the carrier.
    diameter : float, mm
        Pitch diameter of the ring.
    torque : float, N·m
        On the carrier.
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
    >>> design = swgpar.new_train(
    ...     train="planetary_stage", ratio=5.7, diameter=1000.0, torque=1e5
    ... )
    """
    from swgpar.systems.gear_train import GEAR_TRAIN  # loads what gear trains need

    name = "train.toml" if out is None else given_path("out", out).name
    started, text = GEAR_TRAIN.starter(train, (ratio, diameter, torque), name)
    design = GEAR_TRAIN.load(started.model_dump(exclude_unset=True))
    if out is not None:
        _write_new(given_path("out", out), text, overwrite)
    return design


def _warn(sentence: str) -> None:
    if MPI.COMM_WORLD.rank == 0:
        log.logger.warning("%s", sentence)


def _write_new(path: Path, text: str, overwrite: bool) -> None:
    """Write a design file that is not there yet; collective."""
    comm = MPI.COMM_WORLD
    with agreed(comm, path):
        if comm.rank == 0 and path.exists() and not overwrite:
            raise OutputError(
                f"{path} exists: replace it with overwrite = true (--overwrite), or give another "
                "name"
            )
    write_from_root(comm, path, text.encode())


def mesh(
    design: DesignLike,
    mesh: MeshLike,
    out: str | Path | None = None,
    formats: Sequence[str] = ("vtu",),
    comm: MPI.Comm = MPI.COMM_WORLD,
    *,
    overwrite: bool = False,
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
    overwrite : bool
        Replace files of the same names in `out`.

    Raises
    ------
    InputError
        The design is not that of a drive, or the recipe turns an element inside out, or needs more
        memory than this machine has.
    OutputError
        The folder cannot be written, or a file is there already.

    Examples
    --------
    >>> swgpar.mesh("drivers/cup_45deg.toml", "coarse").quality["ring_gear"]["min_scaled_jacobian"]
    """

    from swgpar.analysis.forecast import require_memory_of_mesh
    from swgpar.meshing.drive_mesh import DriveMesh  # with what writes files of meshes

    def make() -> DriveMesh:
        drive, recipe = _drive(load_design(design)), load_mesh(mesh)
        require_memory_of_mesh(drive, recipe)
        sectors = build_sector_meshes(drive.geometry, recipe)
        return DriveMesh(sectors, drive.materials, drive.drive.face_width)

    if out is None:
        return make()
    folder, names = given_path("out", out), given_texts("formats", formats)
    whole = on_all(comm, make)
    with agreed(comm, folder):
        if comm.rank == 0:
            whole.write(folder, names, overwrite=overwrite)
    return whole


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


def _needs(design: DriveDesign, recipe: MeshRecipe) -> dict[str, float]:
    from swgpar.analysis.forecast import forecast, require_memory
    from swgpar.rating.forecast import rating_seconds
    from swgpar.rating.planned_runs import plan_runs

    needs = forecast(design, recipe)
    require_memory(needs, design.solver.memory_limit)
    build_sector_meshes(design.geometry, recipe)  # or the reason why the recipe gives no mesh
    values = {
        "elements of the drive": needs.elements,
        "unknowns modelled": needs.unknowns,
        "memory of all ranks, about (GB)": needs.memory,
        "time of a run on 2 cores, about (s)": needs.seconds,
    }
    if design.rating is not None:
        values["time of a rating on 2 cores, about (s)"] = rating_seconds(plan_runs(design), recipe)
    return values


def _drive(design: Design) -> DriveDesign:
    if not isinstance(design, DriveDesign):
        raise InputError(f"{system_of_section(design.system).noun} has no mesh: allowed are drives")
    return design
