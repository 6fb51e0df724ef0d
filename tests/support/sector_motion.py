"""Stiffness of a body of revolution under motions that are alike in all sectors, of small
displacements: a sector stands for all."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from swgpar.fem.element_matrices import element_matrices
from swgpar.materials import Material
from swgpar.meshing import SectorMesh

TANGENTIAL, RADIAL, AXIAL = range(3)


def stiffness_between(
    mesh: SectorMesh, material: Material, used: np.ndarray, at: np.ndarray, component: int
) -> float:
    """Torque over angle (N mm / rad), or axial force over motion (N / mm), between two rigid ends.

    used : (n_elem,) bool, of the elements;  at : (n_node,) 0 at the fixed end, 1 at the one that
    moves, else NaN;  component : `TANGENTIAL` for a rotation, `AXIAL` for a motion along the axis
    """
    elements = mesh.hexes[used]
    stiffness = element_matrices(mesh.coords[elements], material).stiffness
    x, y = mesh.coords[:, :2].T / np.hypot(*mesh.coords[:, :2].T)
    frame = np.zeros((len(x), 3, 3))
    frame[:, 0, TANGENTIAL], frame[:, 1, TANGENTIAL] = -y, x
    frame[:, 0, RADIAL], frame[:, 1, RADIAL] = x, y
    frame[:, 2, AXIAL] = 1.0
    # a pair of nodes on the sides has the same components
    number = np.arange(len(x))
    number[mesh.ccw_nodes] = mesh.cw_nodes
    local = np.einsum(
        "enmNM,enma,eNMb->enaNb",
        stiffness.reshape(-1, 8, 3, 8, 3),
        *[frame[elements]] * 2,
        optimize=True,
    )
    unknowns = (3 * number[elements][..., None] + np.arange(3)).reshape(len(elements), -1)
    row, column = np.broadcast_arrays(unknowns[:, :, None], unknowns[:, None, :])
    matrix = coo_matrix(
        (local.ravel(), (row.ravel(), column.ravel())), shape=(3 * len(x), 3 * len(x))
    ).tocsr()
    nodes = np.unique(number[elements])
    held = nodes[~np.isnan(at[nodes])]
    moved = held[at[held] == 1.0]
    motion = np.zeros(3 * len(x))
    size = np.hypot(*mesh.coords[moved, :2].T) if component == TANGENTIAL else 1.0
    motion[3 * moved + component] = size
    free = (3 * np.setdiff1d(nodes, held)[:, None] + np.arange(3)).ravel()
    motion[free] = spsolve(matrix[free][:, free].tocsc(), -(matrix @ motion)[free])
    return mesh.n_sectors * float(motion @ (matrix @ motion))
