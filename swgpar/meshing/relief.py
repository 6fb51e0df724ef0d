"""Crowning in the mesh: flank nodes move inwards, the inside of the tooth follows smoothly."""

from __future__ import annotations

import numpy as np
import scipy

from swgpar.geometry.arrays import Floats
from swgpar.meshing.cross_section import CrossSection
from swgpar.meshing.quality import GAUSS, PLANE_CORNERS, jacobian_matrices, shape_gradients
from swgpar.profiles.flank import ToothProfile


def boundary_nodes(section: CrossSection) -> np.ndarray:
    """Return the nodes (n,) on the boundary of the cross-section."""
    edges = np.stack((section.quads, np.roll(section.quads, -1, axis=1)), axis=-1).reshape(-1, 2)
    unique, times = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    return np.unique(unique[times == 1])


def laplacian(section: CrossSection) -> scipy.sparse.coo_matrix:
    """Return the finite-element Laplace matrix (n_node, n_node) of the cross-section."""
    natural = shape_gradients(PLANE_CORNERS, GAUSS * PLANE_CORNERS)
    jacobian = jacobian_matrices(section.coords, section.quads, GAUSS)
    gradient = np.einsum("qak,eqki->eqai", natural, np.linalg.inv(jacobian))
    stiffness = np.einsum("eqai,eqbi,eq->eab", gradient, gradient, np.linalg.det(jacobian))
    rows = np.repeat(section.quads, 4, axis=1).ravel()
    columns = np.tile(section.quads, (1, 4)).ravel()
    n = len(section.coords)
    return scipy.sparse.coo_matrix((stiffness.ravel(), (rows, columns)), shape=(n, n)).tocsc()


def relief_field(section: CrossSection, profile: ToothProfile) -> Floats:
    """Return the displacement (n_node, 2) of the cross-section per unit of crowning.

    The flanks move by the crowning weight against their normal; the other boundaries and the rim
    stay, and the displacement in between is harmonic.
    """
    field = np.zeros((len(section.coords), 2))
    move = -profile.crowning_weight(section.s)[:, None] * profile.normal(section.s)
    field[section.flank] = move
    field[section.mirror[section.flank]] = move * (-1.0, 1.0)
    given = section.below_root.copy()
    given[boundary_nodes(section)] = True
    free = np.flatnonzero(~given)
    if free.size:
        rows = laplacian(section)[free]
        field[free] = scipy.sparse.linalg.splu(rows[:, free].tocsc()).solve(
            -(rows[:, given] @ field[given])
        )
    return field
