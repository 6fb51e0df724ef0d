"""Parts of a sector without their inside: congruent parts share a stiffness of their outer nodes.

A part is then one element (a superelement, by static condensation) of the nodes that others act on.
Its inside is linear in a frame that rotates with the outer nodes, as every element is in a frame of
its own (`kernel/corotation.hpp`). Two kinds of parts are condensed:

- whole sectors of the plane model. The rotation of a sector's ends relative to each other
(`relative_end_rotation`) is
  not seen: strains of an eighth of the square of that angle are left out.
- teeth of solid gears above their rims, while no flank is within reach. They hardly bend.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

from swgpar.geometry.rotation import rotated, rotation_between
from swgpar.kernel import ReferenceElements
from swgpar.meshing.sector import SectorMesh


@dataclass(frozen=True)
class CondensedPart:
    """Elements of a sector as one.

    outer : (m,) nodes that keep their unknowns;  inner : (k,) nodes that are eliminated
    inner_coords, inner_free : (k, 3) mm, undeformed and without stress
    reference : the part as an element of m nodes, without recovery of stress
    modes : (3 k, 3 m) constraint modes in that frame: displacement of inner by that of outer nodes
    """

    outer: np.ndarray
    inner: np.ndarray
    inner_coords: np.ndarray
    inner_free: np.ndarray
    reference: ReferenceElements
    modes: np.ndarray

    def inner_displacement(self, angle: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Displacement (n, k, 3) mm of the inner nodes of sectors from that of the outer ones.

        angle : (n,) rad, of the sectors;  u : (n, m, 3) mm
        """
        coords, gradient = self.reference.coords[0], self.reference.gradient[0]
        middle, free = coords.mean(axis=0), self.reference.stress_free[0]
        outer, inner = coords - middle, self.inner_coords - middle
        mean, turn = u.mean(axis=1, keepdims=True), angle[:, None]
        position = rotated(outer, turn) + u - mean
        stretch = position.transpose(0, 2, 1) @ gradient
        if not gradient[:, 2].any():  # plane
            stretch[:, 2, 2] = 1.0
        left, _, right = np.linalg.svd(stretch)
        frame = left @ right
        stretched = position @ frame - (free - free.mean(axis=0))
        deformed = stretched.reshape(len(u), outer.size) @ self.modes.T
        frame = frame.transpose(0, 2, 1)
        inner_free = self.inner_free - free.mean(axis=0)
        moved = (inner_free + deformed.reshape(len(u), *inner.shape)) @ frame
        return moved - rotated(inner, turn) + mean


def relative_end_rotation(mesh: SectorMesh, angle: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Rotation (n,) rad of the two ends of sectors relative to each other, at u (n, n_node, 3) mm.

    angle : (n,) rad, of the sectors
    """
    rotations = []
    for nodes in (mesh.ccw_nodes, mesh.cw_nodes):
        undeformed = rotated(mesh.coords[nodes], angle[:, None])
        rotations.append(rotation_between(undeformed, undeformed + u[:, nodes]))
    return rotations[0] - rotations[1]


def outer_nodes(mesh: SectorMesh) -> np.ndarray:
    """Nodes of a sector's elements that something else acts on as well, sorted."""
    parts = [mesh.cw_nodes, mesh.ccw_nodes, *mesh.faces.values(), *mesh.node_sets.values()]
    parts += [grid.nodes for grid in mesh.flanks]
    return np.intersect1d(np.concatenate([part.ravel() for part in parts]), mesh.elements)


def condense_sector(mesh: SectorMesh, elements: ReferenceElements) -> CondensedPart:
    """A sector of the plane model as one element."""
    return _condense(mesh, elements, np.arange(len(mesh.elements)), outer_nodes(mesh))


def condense_tooth(mesh: SectorMesh, elements: ReferenceElements) -> CondensedPart:
    """The tooth of a solid sector as one element of nodes on its rim and where its flanks begin.

    The latter give the frame: those on the rim lie close to a plane.
    """
    above = np.zeros(len(mesh.elements), dtype=bool)
    above[mesh.tooth] = True
    base = np.intersect1d(mesh.elements[above], mesh.elements[~above])
    ends = np.concatenate([grid.nodes[0, [0, -1]] for grid in mesh.flanks])
    return _condense(mesh, elements, mesh.tooth, np.union1d(base, ends))


def _condense(
    mesh: SectorMesh, elements: ReferenceElements, part: np.ndarray, outer: np.ndarray
) -> CondensedPart:
    """Eliminate all nodes but `outer` from the stiffness of the elements `part` of a sector, which
    grow alike."""
    conn, dims = mesh.elements[part], 2 if mesh.plane else 3
    inner = np.setdiff1d(conn, outer)
    n, m, k = len(mesh.coords), len(outer), len(inner)
    entry = (3 * conn[..., None] + np.arange(3)).reshape(len(conn), -1)
    row, column = np.broadcast_arrays(entry[:, :, None], entry[:, None, :])
    entries = elements.stiffness[part].ravel(), (row.ravel(), column.ravel())
    stiffness = coo_matrix(entries, shape=(3 * n, 3 * n)).tocsr()
    at_outer, at_inner = (
        (3 * nodes[:, None] + np.arange(dims)).ravel() for nodes in (outer, inner)
    )
    coupling = stiffness[at_inner][:, at_outer].toarray()
    modes = np.zeros((k, 3, m, 3))
    reduced = np.zeros((m, 3, m, 3))
    factor = splu(
        stiffness[at_inner][:, at_inner].tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        options={"SymmetricMode": True},
    )
    solved = -factor.solve(coupling)
    condensed = stiffness[at_outer][:, at_outer].toarray() + coupling.T @ solved
    modes[:, :dims, :, :dims] = solved.reshape(k, dims, m, dims)
    reduced[:, :dims, :, :dims] = (0.5 * (condensed + condensed.T)).reshape(m, dims, m, dims)
    coords, free = mesh.coords[outer], mesh.coords.copy()
    free[conn] = elements.stress_free[part]
    # the frame follows the least-squares gradient of the outer nodes' motion
    about = (coords - coords.mean(axis=0))[:, :dims]
    gradient = np.zeros((m, 3))
    gradient[:, :dims] = about @ np.linalg.inv(about.T @ about)
    reference = ReferenceElements(
        reduced.reshape(1, 3 * m, 3 * m),
        np.zeros((1, 0, 3 * m)),
        gradient[None],
        coords[None],
        free[outer][None],
        elements.volume[part].sum(keepdims=True),
    )
    places = mesh.coords[inner], free[inner]
    return CondensedPart(outer, inner, *places, reference, modes.reshape(3 * k, 3 * m))
