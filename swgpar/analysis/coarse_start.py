"""Start on coarser meshes: pins, engagement and torque there, the loaded state interpolated onto the finer mesh.

Most Newton iterations of a start find out which points touch. On a mesh with half of the elements in every direction
they cost an eighth and less, and its loaded state is so close that a few iterations remain. Without friction the loaded
state does not depend on the way to it, so that the result is the same to the solver's tolerance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc
from scipy.sparse import csr_matrix
from scipy.spatial import Delaunay, QhullError, cKDTree

from swgpar.analysis.drive_model import DriveModel, stresses
from swgpar.analysis.load_stepping import LOADED, LoadStepper
from swgpar.analysis.predictor import turned
from swgpar.design.drive_design import DriveDesign
from swgpar.design.load_states import LoadState
from swgpar.errors import InputError, SwgparError
from swgpar.fem.vectors import read_field, write_field
from swgpar.input.toml_file import validate
from swgpar.log import logger
from swgpar.meshing import MeshRecipe
from swgpar.meshing.sector import SectorMesh

SMALLEST = {"tip": 2, "root": 2}
"""Counts that a recipe may not go below; all others reach 1, along the face width 2 or 3."""


def recounted(recipe: MeshRecipe, count: Callable[[str, str, int], int]) -> MeshRecipe:
    """The recipe with count(section, name, elements) for every count, gradings as they are.

    The middle of the face width stays what it is, a node or an element: a crowned cam touches along it. Where the
    coarser mesh has no node there its ring takes a shape of its own, 0.1 micrometres beside that of the finer one, and
    the finer mesh finds its contacts anew. Raises InputError beyond bounds.
    """

    def section(title: str, counts: dict[str, int | float]) -> dict[str, int | float]:
        return {name: count(title, name, value) if isinstance(value, int) else value for name, value in counts.items()}

    content = {title: section(title, counts) for title, counts in recipe.model_dump(exclude_none=True).items()}
    if recipe.face_width is not None:
        width = content["face_width"]
        width["elements"] += (width["elements"] + recipe.face_width.elements) % 2
    return validate(MeshRecipe, content)


def coarser(recipe: MeshRecipe) -> MeshRecipe:
    """The recipe with half of every count, rounded up."""
    return recounted(recipe, lambda _, name, value: max(SMALLEST.get(name, 1), -(-value // 2)))


def interpolation(coarse: SectorMesh, fine: SectorMesh) -> csr_matrix:
    """Matrix (n_fine, n_coarse) that takes nodal values of the coarse sector to the nodes of the fine one.

    Linear in the tetrahedra (triangles in the plane) between the coarse nodes, in cylindrical coordinates, in which
    rim and cup are flat. Nodes outside are extrapolated, from the cell beside them that they are least outside of.
    Raises InputError where the coarse nodes have no such tetrahedra.
    """
    plane = coarse.tied is not None
    nodes = np.unique(coarse.tied) if plane else np.arange(len(coarse.coords))
    scale = float(np.hypot(*coarse.coords[:, :2].T).max())
    place, wanted = _unrolled(coarse.coords[nodes], scale, plane), _unrolled(fine.coords, scale, plane)
    try:
        mesh, dims = Delaunay(place), place.shape[1]
    except QhullError as error:
        raise InputError(f"no state can be taken from the other mesh: {str(error).splitlines()[0]}") from None
    cell = mesh.find_simplex(wanted, tol=1e-9)
    volume = np.abs(np.linalg.det(place[mesh.simplices[:, 1:]] - place[mesh.simplices[:, :1]]))
    sound = volume > 1e-3 * np.median(volume)
    at_node = [[] for _ in place]
    for k in np.flatnonzero(sound):
        for node in mesh.simplices[k]:
            at_node[node].append(k)
    outside = np.flatnonzero((cell < 0) | ~sound[cell])
    _, nearest = cKDTree(place).query(wanted[outside], k=4)
    for k, around in zip(outside, nearest):
        choice = np.unique(np.concatenate([at_node[node] for node in around]).astype(np.int64))
        weight = _barycentric(mesh, choice, np.repeat(wanted[k : k + 1], len(choice), axis=0))
        cell[k] = choice[weight.min(axis=1).argmax()]
    weight = _barycentric(mesh, cell, wanted)
    where = np.repeat(np.arange(len(wanted)), dims + 1), nodes[mesh.simplices[cell].ravel()]
    return csr_matrix((weight.ravel(), where), shape=(len(wanted), len(coarse.coords)))


def _unrolled(points: np.ndarray, scale: float, plane: bool) -> np.ndarray:
    """Points (n, 3) near +y as angle times `scale`, radius and, in space, z; mm."""
    radius = np.hypot(points[:, 0], points[:, 1])
    around = np.arctan2(points[:, 0], points[:, 1]) * scale
    return np.column_stack([around, radius] if plane else [around, radius, points[:, 2]])


def _barycentric(mesh: Delaunay, cell: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Weights (n, dims + 1) of the corners of cells (n,) at points (n, dims)."""
    dims = points.shape[1]
    transform = mesh.transform[cell]
    first = np.einsum("nij,nj->ni", transform[:, :dims], points - transform[:, dims])
    return np.column_stack([first, 1.0 - first.sum(axis=1)])


def transfer(coarse: DriveModel, x: PETSc.Vec, fine: DriveModel, y: PETSc.Vec) -> None:
    """Set y of the fine model to the state x of the coarse one; both on the same ranks, sector by sector."""
    for body, layout in enumerate(fine.partition.layouts):
        first, end = fine.partition.owned(body)
        sectors = np.arange(first, end)
        angle = layout.turn(layout.first_tooth + sectors)
        local = turned(read_field(coarse.partition, body, sectors, x), -angle)
        matrix = interpolation(coarse.partition.layouts[body].mesh, layout.mesh)
        values = np.stack([matrix @ sector for sector in local]) if len(local) else np.zeros((0, matrix.shape[0], 3))
        write_field(fine.partition, body, sectors, turned(values, angle), y)
    if fine.comm.rank == fine.comm.size - 1:
        n = fine.partition.n_multipliers
        y.array[-n:] = x.array_r[-n:]


def levels(design: DriveDesign, recipe: MeshRecipe) -> list[MeshRecipe]:
    """Recipes of the coarser meshes of a start, the coarsest first.

    None with friction, under which the loaded state depends on the way to it.
    """
    found: list[MeshRecipe] = []
    while len(found) < design.steps.start_levels and not design.contact.friction:
        simpler = coarser(found[0] if found else recipe)
        if simpler == (found[0] if found else recipe):
            break
        found.insert(0, simpler)
    return found


def from_loaded(items: list[LoadState]) -> list[LoadState]:
    """The increments from the loaded state on."""
    loaded = max(k for k, item in enumerate(items) if item.step == LOADED)
    return items[loaded:]


@dataclass(frozen=True)
class Level:
    """The loaded state on one mesh. elements : of the whole drive;  stresses : largest ones, MPa"""

    elements: int
    stresses: dict[str, float]


def level_of(model: DriveModel) -> Level:
    """Elements and stresses of a model in its loaded state."""
    return Level(model.elements_whole(), stresses(model)[0])


def load(
    design: DriveDesign, recipe: MeshRecipe, items: list[LoadState], comm: MPI.Comm, below: DriveModel | None = None
) -> DriveModel:
    """The drive on one mesh in its loaded state, from that on another one, the model `below`, which is released.

    items : all increments of the run. Raises ConvergenceError or InputError where a mesh does not allow it.
    """
    way = None
    try:
        way = LoadStepper(DriveModel(design, recipe, comm))
        todo = [item for item in items if item.step <= LOADED]
        if below is not None:
            todo, taken, below = todo[-1:], below, None
            take_over(taken, way, todo[-1])
        iterations = []
        for item in todo:
            way.increment(item)
            iterations.append(way.iterations)
    except SwgparError:
        for model in (below, way and way.model):
            if model is not None:
                model.destroy()
        raise
    counted = " + ".join(map(str, iterations))
    logger.info("loaded on a mesh of %d elements, Newton iterations %s", way.model.elements_whole(), counted)
    return way.model


def start_loaded(runner: LoadStepper, recipes: list[MeshRecipe], items: list[LoadState]) -> Level:
    """Bring `runner` to the loaded state by way of coarser meshes, the coarsest of `recipes` first.

    items : all increments of the run. Raises ConvergenceError or InputError where a mesh does not allow it; `runner` is
    then to be reset.
    """
    target, below = runner.model, None
    loaded = from_loaded(items)[0]
    with target.phases("start"):
        for recipe in recipes:
            below = load(target.design, recipe, items, target.comm, below)
        level = level_of(below)
        take_over(below, runner, loaded)
        runner.increment(loaded)
    return level


def take_over(below: DriveModel, runner: LoadStepper, loaded: LoadState) -> None:
    """Take over the loaded state of the model on another mesh, and release that."""
    try:
        transfer(below, below.equilibrium.x, runner.model, runner.equilibrium.x)
    finally:
        below.destroy()
    runner.scene = loaded
