"""Plane tooth sectors whose inside is eliminated: congruent sectors share one stiffness of their outer nodes.

A sector is then one element (a superelement, by static condensation) of the nodes that neighbours, contact, cam and
couplings need. Its inside is linear in a frame that rotates with the outer nodes, as every element is in a frame of its
own (`kernel/corotation.hpp`). The rotation of a sector's ends relative to each other (`relative_end_rotation`) is not
seen: strains of an eighth of the square of that angle are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu
from scipy.spatial.transform import Rotation

from swgpar.kernel import ReferenceElements
from swgpar.meshing.sector import SectorMesh


@dataclass(frozen=True)
class CondensedSector:
    """The elements of a sector as one.

    outer : (m,) nodes that keep their unknowns;  inner : (k,) nodes that are eliminated;  inner_coords : (k, 3) mm
    reference : the sector as an element of m nodes, without recovery of stress
    modes : (3 k, 3 m) constraint modes: displacement of the inner nodes by that of the outer ones, in that frame
    """

    outer: np.ndarray
    inner: np.ndarray
    inner_coords: np.ndarray
    reference: ReferenceElements
    modes: np.ndarray

    def inner_displacement(self, angle: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Displacement (n, k, 3) mm of the inner nodes of sectors from that of the outer ones.

        angle : (n,) rad, of the sectors;  u : (n, m, 3) mm
        """
        coords, gradient = self.reference.coords[0], self.reference.gradient[0]
        middle = coords.mean(axis=0)
        outer, inner = coords - middle, self.inner_coords - middle
        rotation = _about_z(angle)
        mean = u.mean(axis=1, keepdims=True)
        position = outer @ rotation + u - mean
        stretch = position.transpose(0, 2, 1) @ gradient
        frame = _about_z(np.arctan2(stretch[:, 1, 0] - stretch[:, 0, 1], stretch[:, 0, 0] + stretch[:, 1, 1]))
        deformed = (position @ frame.transpose(0, 2, 1) - outer).reshape(len(u), outer.size) @ self.modes.T
        return (inner + deformed.reshape(len(u), *inner.shape)) @ frame - inner @ rotation + mean


def _about_z(angle: np.ndarray) -> np.ndarray:
    """Matrices (n, 3, 3) that rotate row vectors by angles (n,) rad about z when multiplied from the right."""
    return Rotation.from_euler("z", angle[:, None]).as_matrix().transpose(0, 2, 1)


def relative_end_rotation(mesh: SectorMesh, angle: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Rotation (n,) rad of the two ends of sectors relative to each other, at displacements u (n, n_node, 3) mm.

    angle : (n,) rad, of the sectors
    """
    rotations = []
    for nodes in (mesh.ccw_nodes, mesh.cw_nodes):
        undeformed = mesh.coords[nodes] @ _about_z(angle)
        undeformed -= undeformed.mean(axis=1, keepdims=True)
        deformed = undeformed + u[:, nodes] - u[:, nodes].mean(axis=1, keepdims=True)
        sine = (undeformed[..., 0] * deformed[..., 1] - undeformed[..., 1] * deformed[..., 0]).sum(axis=1)
        rotations.append(np.arctan2(sine, (undeformed * deformed)[..., :2].sum(axis=(1, 2))))
    return rotations[0] - rotations[1]


def outer_nodes(mesh: SectorMesh) -> np.ndarray:
    """Nodes of a sector's elements that something else acts on as well, sorted."""
    parts = [mesh.cw_nodes, mesh.ccw_nodes, *mesh.faces.values(), *mesh.node_sets.values()]
    parts += [grid.nodes for grid in mesh.flanks]
    return np.intersect1d(np.concatenate([part.ravel() for part in parts]), mesh.elements)


def condense(mesh: SectorMesh, elements: ReferenceElements) -> CondensedSector:
    """Eliminate the inside of a sector of the plane model from the stiffness of its elements."""
    outer = outer_nodes(mesh)
    inner = np.setdiff1d(mesh.elements, outer)
    n, m, k = len(mesh.coords), len(outer), len(inner)
    entry = (3 * mesh.elements[..., None] + np.arange(3)).reshape(len(mesh.elements), -1)
    row, column = np.broadcast_arrays(entry[:, :, None], entry[:, None, :])
    stiffness = coo_matrix((elements.stiffness.ravel(), (row.ravel(), column.ravel())), shape=(3 * n, 3 * n)).tocsr()
    at_outer, at_inner = ((3 * nodes[:, None] + np.arange(2)).ravel() for nodes in (outer, inner))
    coupling = stiffness[at_inner][:, at_outer].toarray()
    modes = np.zeros((k, 3, m, 3))
    reduced = np.zeros((m, 3, m, 3))
    solved = -splu(stiffness[at_inner][:, at_inner].tocsc()).solve(coupling)
    condensed = stiffness[at_outer][:, at_outer].toarray() + coupling.T @ solved
    modes[:, :2, :, :2] = solved.reshape(k, 2, m, 2)
    reduced[:, :2, :, :2] = (0.5 * (condensed + condensed.T)).reshape(m, 2, m, 2)
    coords = mesh.coords[outer]
    # the frame follows the least-squares gradient of the outer nodes' motion
    about = (coords - coords.mean(axis=0))[:, :2]
    gradient = np.zeros((m, 3))
    gradient[:, :2] = about @ np.linalg.inv(about.T @ about)
    reference = ReferenceElements(
        reduced.reshape(1, 3 * m, 3 * m),
        np.zeros((1, 0, 3 * m)),
        gradient[None],
        coords[None],
        elements.volume.sum(keepdims=True),
    )
    return CondensedSector(outer, inner, mesh.coords[inner], reference, modes.reshape(3 * k, 3 * m))
