"""Elements of the owned sectors: internal forces, tangent blocks and pattern, nodal stress.

Every rank computes complete rows of the nodes it owns: its sectors' elements and those of the
sector before that share nodes with it. No matrix or vector entry is ever sent, and a row's terms
are summed in the same order on any number of ranks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from swgpar.fem.body_layout import BodyLayout
from swgpar.fem.local_nodes import LocalNodes
from swgpar.fem.partition import Partition
from swgpar.fem.sparse import BlockRows
from swgpar.geometry.rotation import rotated, to_images
from swgpar.kernel import ReferenceElements, assemble_elements, recover_stress


@dataclass(frozen=True)
class AssembledElements:
    """The n elements of one kind and body that a rank assembles, of m nodes each.

    matrices : of the congruent elements;  reference : (n,) int32, index in them
    rotation : (n, 2) cosine and sine of the angle of the element's sector
    conn : (n, m) int32 local nodes, -1 where there are no unknowns
    sixths : (n, m) uint8, sixths of a turn by which nodes are rotated that are images
    """

    matrices: ReferenceElements
    reference: np.ndarray
    rotation: np.ndarray
    conn: np.ndarray
    sixths: np.ndarray

    def assemble(
        self,
        u: np.ndarray,
        residual: np.ndarray | None,
        block_indices: np.ndarray | None = None,
        values: np.ndarray | None = None,
    ) -> None:
        """Add their internal forces and tangent blocks, see `Elements.assemble`."""
        if len(self.conn):
            frames = self.reference, self.rotation, self.conn, self.sixths
            assemble_elements(self.matrices, *frames, u, residual, block_indices, values)


def sectors_seen(partition: Partition, body: str) -> np.ndarray:
    """Indices (n,) in the chain of the sectors that a rank needs: its own and one on either side.

    Owned rows need the sector before them, nodal averages of stress both; none if a rank owns none.
    """
    layout = partition.layouts[body]
    first, end = partition.owned_sectors(body)
    sectors = np.arange(first - 1, end + 1) if end > first else np.zeros(0, dtype=np.int64)
    return sectors if layout.closed else sectors[(sectors >= 0) & (sectors < layout.count)]


def _held(layout: BodyLayout, matrices: ReferenceElements, nodes: np.ndarray) -> ReferenceElements:
    """Matrices of elements of nodes (n, m) with the fixed nodes where they are held: the kernels
    take their displacement as zero."""
    if not layout.held:
        return matrices
    coords, fixed = matrices.coords.copy(), np.isin(nodes, layout.fixed)
    coords[fixed] += layout.held.of(coords[fixed])
    return matrices._replace(coords=coords)


class BodyElements:
    """The elements of one body as one rank sees them. A condensed sector is a single element.

    partition, body : ownership, and name of the body;  local : nodes of this rank

    Attributes:
    layout : BodyLayout
    sectors : (n_sectors,) indices in the chain, see `sectors_seen`;  owned : slice of the owned
    ones among them
    preceding : (n_sectors,) bool, the sector before the first owned one, where another rank owns it
    number, sixths, local : (n_sectors, n_node) global numbers, image flags and local indices of the
    nodes
    sector_rotation : (n_sectors, 2) cosine and sine of the angles of the sectors
    active : (n_sectors,) bool, sectors whose elements count
    whole_teeth : (n_sectors,) bool, sectors whose tooth is not one element
    assembled : elements of the active sectors that this rank assembles, of every kind
    """

    def __init__(self, partition: Partition, body: str, local: LocalNodes) -> None:
        layout = partition.layouts[body]
        self.layout, self.reference, condensed = layout, layout.body.elements, layout.condensed
        self._kinds = [(self.reference, layout.mesh.elements)]
        if condensed is not None:
            self._kinds = [(condensed.reference, condensed.outer[None])]
        elif layout.tooth is not None:
            self._kinds.append((layout.tooth.reference, layout.tooth.outer[None]))
        self._kinds = [(_held(layout, *kind), kind[1]) for kind in self._kinds]
        first, end = partition.owned_sectors(body)
        sectors = sectors_seen(partition, body)
        self.sectors = sectors
        self.owned = slice(int(np.searchsorted(sectors, first)), int(np.searchsorted(sectors, end)))
        self.number, self.sixths = partition.node_numbers(
            body, sectors, np.arange(len(layout.mesh.coords))
        )
        self.local = local.index(self.number)
        # on a single rank the sector before the first is an image of an owned one: it must not
        # count twice
        self.preceding = np.zeros(len(sectors), dtype=bool)
        self.preceding[: self.owned.start] = True
        if layout.closed and end - first == layout.count:
            self.preceding[:] = False
        self.sector_rotation = self._rotation()
        counted = self.preceding.copy()
        counted[self.owned] = True
        owned = partition.owns(self.number) & counted[:, None]
        self._touching = [owned[:, nodes].any(axis=2) for _, nodes in self._kinds]
        self.active, self.whole_teeth = np.ones((2, len(sectors)), dtype=bool)
        self.assembled = self._assembled()

    def rotate(self, layout: BodyLayout) -> None:
        """Take a layout that differs in its first tooth alone."""
        self.layout = layout
        self.sector_rotation = self._rotation()
        self.assembled = self._assembled()

    def _rotation(self) -> np.ndarray:
        angle = self.layout.chain_angle(self.sectors)
        return np.column_stack([np.cos(angle), np.sin(angle)]).reshape(-1, 2)

    def activate(self, active: np.ndarray) -> None:
        """Let the elements of the sectors (n_sectors,) bool count, and no others."""
        self.active = active
        self.assembled = self._assembled()

    def keep_teeth(self, whole: np.ndarray) -> None:
        """Let the teeth of all sectors but these (n_sectors,) bool be one element each."""
        self.whole_teeth = whole
        self.assembled = self._assembled()

    def _assembled(self) -> list[AssembledElements]:
        """Elements of active sectors that have an owned node."""
        chosen = [touching & self.active[:, None] for touching in self._touching]
        if self.layout.tooth is not None:
            chosen[0][np.ix_(~self.whole_teeth, self.layout.mesh.tooth)] = False
            chosen[1] &= ~self.whole_teeth[:, None]
        return [self._of_kind(*kind, mask) for kind, mask in zip(self._kinds, chosen)]

    def _of_kind(
        self, matrices: ReferenceElements, nodes: np.ndarray, chosen: np.ndarray
    ) -> AssembledElements:
        sector, element = (v.astype(np.int32) for v in np.nonzero(chosen))
        nodes = nodes[element]
        return AssembledElements(
            matrices,
            element,
            np.ascontiguousarray(self.sector_rotation[sector]),
            np.ascontiguousarray(self.local[sector[:, None], nodes]),
            np.ascontiguousarray(self.sixths[sector[:, None], nodes]),
        )

    def inside_of_teeth(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Own nodes (n,) in condensed teeth, their displacement (n, 3) mm by u (n_local, 3)."""
        rows = np.flatnonzero(~self.whole_teeth)
        rows = rows[(rows >= self.owned.start) & (rows < self.owned.stop)]
        tooth = self.layout.tooth
        if tooth is None or not len(rows):
            return np.zeros(0, dtype=np.int64), np.zeros((0, 3))
        angle = np.arctan2(self.sector_rotation[rows, 1], self.sector_rotation[rows, 0])
        inner = tooth.inner_displacement(angle, u[self.local[np.ix_(rows, tooth.outer)]])
        return self.local[np.ix_(rows, tooth.inner)].ravel(), inner.reshape(-1, 3)

    def displacement(self, u: np.ndarray) -> np.ndarray:
        """Displacement (n_sectors, n_node, 3) mm of the sectors seen, images rotated."""
        field = np.where(self.local[..., None] >= 0, u[self.local], 0.0)
        return self.layout.with_inner_nodes(self.sectors, to_images(field, self.sixths))

    def positions(self) -> np.ndarray:
        """Undeformed positions of all nodes of the sectors seen; (n_sectors, n_node, 3) mm."""
        angle = self.layout.chain_angle(self.sectors)
        return rotated(self.layout.mesh.coords, angle[:, None])

    def part_forces(self, u: np.ndarray, part: int) -> np.ndarray:
        """Forces (n_owned, n_node, 3) N on the nodes of each owned sector by what is around a part.

        u : (n_local, 3) mm;  part : of the mesh, see `SectorMesh.parts`
        """
        indices = np.ascontiguousarray(self.layout.mesh.parts[part])
        elements, field = self.layout.mesh.elements[indices], self.displacement(u)[self.owned]
        forces, no_image = np.zeros_like(field), np.zeros(elements.shape, dtype=np.uint8)
        for k, rotation in enumerate(self.sector_rotation[self.owned]):
            frames = indices, np.tile(rotation, (len(indices), 1)), elements, no_image
            assemble_elements(self.reference, *frames, field[k], forces[k], None, None)
        return forces

    def nodal_stress(self, u: np.ndarray, part: int = 0) -> np.ndarray:
        """Stress at the nodes of the owned sectors: extrapolated, averaged over elements of a part.

        Returns (n_owned, n_node, 6) MPa; components xx, yy, zz, xy, yz, zx in global axes.
        It is zero in sectors without elements, and at nodes that the part has not.

        part : of the mesh, see `SectorMesh.parts`: stress jumps where the material changes
        """
        mesh = self.layout.mesh
        indices = np.ascontiguousarray(mesh.parts[part])
        elements, lower = np.ascontiguousarray(mesh.elements[indices]), mesh.lower_nodes
        n_sectors, n_node, n_elem = len(self.sectors), len(mesh.coords), len(elements)
        sums, field = np.zeros((n_sectors, n_node, 6)), self.displacement(u)
        no_image = np.zeros(elements.shape, dtype=np.uint8)
        for k in np.flatnonzero(self.active):
            stress = recover_stress(
                self.reference,
                indices,
                np.repeat(self.sector_rotation[k : k + 1], n_elem, axis=0),
                elements,
                no_image,
                field[k],
            )
            for c in range(6):
                sums[k, :, c] = np.bincount(
                    elements.ravel(), stress[:, :, c].ravel(), minlength=n_node
                )
        count = np.bincount(elements.ravel(), minlength=n_node).astype(float)
        if lower is not None:
            sums, count = sums[:, lower], count[lower]
        counts = self.active[:, None] * count
        ccw, cw = mesh.ccw_nodes, mesh.cw_nodes
        total = sums[:-1, ccw] + sums[1:, cw]
        number = counts[:-1, ccw] + counts[1:, cw]
        sums[:-1, ccw], sums[1:, cw] = total, total
        counts[:-1, ccw], counts[1:, cw] = number, number
        return (sums / np.maximum(counts, 1.0)[..., None])[self.owned]


@dataclass(frozen=True)
class TangentPattern:
    """Blocks of the tangent's owned rows that elements, multipliers and the diagonal need.

    keys : sorted row * n_global + column of the blocks
    block_indices : of each kind's (n, m * m) element blocks among the keys, -1 for other ranks'
    nodes_without_elements : (n,) owned local nodes, which have no blocks
    """

    keys: np.ndarray
    block_indices: list[np.ndarray]
    nodes_without_elements: np.ndarray


class Elements:
    """All bodies' elements on one rank: residual and tangent of the structure.

    partition : ownership;  symmetric : keep the tangent's upper triangle only

    Attributes:
    local : nodes of this rank that its elements, multipliers and averages of stress need
    bodies : elements of each body by its name;  pattern : of the tangent for the active sectors
    """

    def __init__(self, partition: Partition, symmetric: bool = True) -> None:
        self.partition, self.symmetric = partition, symmetric
        needed = [
            partition.node_numbers(
                name, sectors_seen(partition, name), np.arange(len(layout.mesh.coords))
            )[0].ravel()
            for name, layout in partition.layouts.items()
        ]
        self.local = LocalNodes(partition, np.concatenate([*needed, partition.multiplier_nodes]))
        self.bodies = {
            name: BodyElements(partition, name, self.local) for name in partition.layouts
        }
        self.pattern = self._pattern()

    @property
    def assembled(self) -> list[AssembledElements]:
        """Elements that this rank assembles, by bodies and kinds."""
        return [part for body in self.bodies.values() for part in body.assembled]

    def renew_pattern(self) -> None:
        """Take over what was chosen of the bodies' elements."""
        self.pattern = self._pattern()

    def _pattern(self) -> TangentPattern:
        partition, local = self.partition, self.local
        touched = np.zeros(local.n_own, dtype=bool)
        for elements in self.assembled:
            conn = elements.conn
            touched[conn[(conn >= 0) & (conn < local.n_own)]] = True
        multipliers = partition.multiplier_nodes
        own = multipliers - local.row_start
        touched[own[(own >= 0) & (own < local.n_own)]] = True
        blocks = [self.block_keys(elements.conn) for elements in self.assembled]
        nodes = local.row_start + np.flatnonzero(touched)
        if local.n_own and local.row_start + local.n_own == partition.n_global:
            nodes = np.union1d(nodes, multipliers)
        owned = [block >= 0 for block in blocks]
        keys = [block[own] for block, own in zip(blocks, owned)]
        every = np.unique(np.concatenate([*keys, nodes * (partition.n_global + 1)]))
        block_indices = []
        for present, of_blocks in zip(owned, keys):
            index = np.full(present.shape, -1)
            index[present] = np.searchsorted(every, of_blocks)
            block_indices.append(index)
        return TangentPattern(every, block_indices, np.flatnonzero(~touched))

    def block_keys(self, conn: np.ndarray) -> np.ndarray:
        """Keys row * n_global + column (n, m * m) of owned blocks, else -1, of elements (n, m)."""
        local = self.local
        number = np.where(conn >= 0, local.number[conn], -1).astype(np.int64)
        row, col = number[:, :, None], number[:, None, :]
        owned = ((conn >= 0) & (conn < local.n_own))[:, :, None]
        keys = np.where(
            owned & (col >= (row if self.symmetric else 0)), row * self.partition.n_global + col, -1
        )
        return keys.reshape(len(conn), conn.shape[1] ** 2)

    def rows(self, extra: np.ndarray, number: np.ndarray) -> tuple[BlockRows, list[np.ndarray]]:
        """Rows of the tangent, and the indices of element blocks among them.

        extra : keys row * n_global + column of contact blocks;  number : (n_local,) global numbers
        """
        own_keys = self.pattern.keys
        keys = np.union1d(own_keys, extra) if len(extra) else own_keys
        row, column = np.divmod(keys, self.partition.n_global)
        first = self.partition.row_start
        start = np.searchsorted(row, np.arange(first, first + self.partition.n_own + 1))
        index = np.searchsorted(keys, own_keys)
        rows = BlockRows(
            start.astype(np.int64),
            column.astype(np.int32),
            np.zeros((len(keys), 3, 3)),
            number,
            self.partition.n_own,
            keys,
            self.symmetric,
        )
        return rows, [np.where(own >= 0, index[own], -1) for own in self.pattern.block_indices]

    def assemble(
        self,
        u: np.ndarray,
        residual: np.ndarray | None,
        rows: BlockRows | None,
        block_indices: Sequence[np.ndarray] | None,
    ) -> None:
        """Add internal forces to `residual` (n_local, 3) N, tangent blocks (N/mm) to `rows.values`.

        u : (n_local, 3) mm;  block_indices : of the element blocks in `rows`, as `rows` gives them
        Raises FloatingPointError where an element has collapsed.
        """
        values = None if rows is None else rows.values
        for k, part in enumerate(self.assembled):
            part.assemble(u, residual, None if block_indices is None else block_indices[k], values)
