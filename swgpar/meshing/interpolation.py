"""Interpolation of nodal values from one mesh of a sector to another mesh of the same sector."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import Delaunay, QhullError, cKDTree

from swgpar.errors import InputError
from swgpar.meshing.sector import SectorMesh

FLAT = 1e-3
"""Share of the median cell volume below which cells are not used: round-off rules their weights."""

NEIGHBOURS = 4
"""Nearest nodes whose cells are tried for a point outside of all cells."""


def interpolation(coarse: SectorMesh, fine: SectorMesh) -> csr_matrix:
    """Matrix (n_fine, n_coarse) that maps nodal values of the coarse sector to the fine one; see
    `interpolation_at`."""
    return interpolation_at(coarse, fine.coords)


def interpolated(field: np.ndarray, matrix: csr_matrix) -> np.ndarray:
    """Values (n_sectors, n_fine, 3) from those of other nodes, (n_sectors, n_coarse, 3), by a
    matrix of `interpolation`."""
    columns = matrix @ field.transpose(1, 0, 2).reshape(field.shape[1], -1)
    return columns.reshape(-1, len(field), 3).transpose(1, 0, 2)


def interpolation_at(coarse: SectorMesh, points: np.ndarray) -> csr_matrix:
    """Matrix (n, n_coarse) that maps nodal values of the coarse sector to points (n, 3) mm.

    The values are linear in the Delaunay tetrahedra (triangles in the plane) of the coarse nodes,
    in cylindrical coordinates, in which rim and cup are flat. Values at points outside are
    extrapolated from the adjacent cell in which their smallest weight is largest. Raises InputError
    where the coarse nodes have no such tetrahedra.
    """
    plane = coarse.plane
    nodes = np.unique(coarse.lower_nodes) if plane else np.arange(len(coarse.coords))
    radius = float(np.hypot(*coarse.coords[:, :2].T).max())
    known = _unrolled(coarse.coords[nodes], radius, plane)
    sought = _unrolled(points, radius, plane)
    try:
        mesh, dims = Delaunay(known), known.shape[1]
    except QhullError as error:
        raise InputError(
            f"no state can be taken from the other mesh: {str(error).splitlines()[0]}"
        ) from None
    cell = _cells(mesh, known, sought)
    weight = _barycentric(mesh, cell, sought)
    entries = np.repeat(np.arange(len(sought)), dims + 1), nodes[mesh.simplices[cell].ravel()]
    return csr_matrix((weight.ravel(), entries), shape=(len(sought), len(coarse.coords)))


def _cells(mesh: Delaunay, known: np.ndarray, sought: np.ndarray) -> np.ndarray:
    """Cell (n,) of each of the points `sought` (n, dims), or for one outside the adjacent."""
    cell = mesh.find_simplex(sought, tol=1e-9)
    volume = np.abs(np.linalg.det(known[mesh.simplices[:, 1:]] - known[mesh.simplices[:, :1]]))
    usable = volume > FLAT * np.median(volume)
    of_cells = mesh.simplices[usable]
    order = np.argsort(of_cells, axis=None, kind="stable")
    at_node = np.repeat(np.flatnonzero(usable), of_cells.shape[1])[order]
    start = np.searchsorted(of_cells.ravel()[order], np.arange(len(known) + 1))
    outside = np.flatnonzero((cell < 0) | ~usable[cell])
    with_cells = np.unique(of_cells)
    _, nearest = cKDTree(known[with_cells]).query(sought[outside], k=NEIGHBOURS)
    for k, neighbours in zip(outside, with_cells[nearest]):
        choice = np.unique(
            np.concatenate([at_node[start[node] : start[node + 1]] for node in neighbours])
        )
        weight = _barycentric(mesh, choice, np.repeat(sought[k : k + 1], len(choice), axis=0))
        cell[k] = choice[weight.min(axis=1).argmax()]
    return cell


def _unrolled(points: np.ndarray, radius: float, plane: bool) -> np.ndarray:
    """Points (n, 3), mm, near +y: arc length at `radius`, distance from the axis, z in space."""
    distance = np.hypot(points[:, 0], points[:, 1])
    arc = np.arctan2(points[:, 0], points[:, 1]) * radius
    return np.column_stack([arc, distance] if plane else [arc, distance, points[:, 2]])


def _barycentric(mesh: Delaunay, cell: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Weights (n, dims + 1) of the corners of cells (n,) at points (n, dims)."""
    dims = points.shape[1]
    transform = mesh.transform[cell]
    first = np.einsum("nij,nj->ni", transform[:, :dims], points - transform[:, dims])
    return np.column_stack([first, 1.0 - first.sum(axis=1)])
