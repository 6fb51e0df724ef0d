"""Element arrays of the owned sectors: internal forces, tangent blocks, nodal stress, pattern of the tangent.

Every rank computes complete rows of the nodes it owns: its sectors' elements and those of the sector
before that share nodes with it. No matrix or vector entry is ever sent, and a row's terms are summed in
the same order on any number of ranks.
"""

from __future__ import annotations

import numpy as np

from swgpar.fem.partition import LocalNodes, Partition
from swgpar.fem.sparse import BlockRows
from swgpar.geometry.rotation import HALF_TURN
from swgpar.kernel import ReferenceElements, assemble_elements, recover_stress


class BodyElements:
    """The elements of one body as one rank sees them.

    Sectors run from one before the first owned to one after the last, as far as they exist: the owned
    rows need the former, nodal averages of stress need both. A condensed sector is a single element here.
    """

    def __init__(self, partition: Partition, body: int, reference: ReferenceElements) -> None:
        layout = partition.layouts[body]
        self.layout, self.reference, condensed = layout, reference, layout.condensed
        self.assembled = reference if condensed is None else condensed.reference
        self.cells = layout.mesh.elements if condensed is None else condensed.outer[None]
        first, end = partition.owned(body)
        sectors = np.arange(first - 1, end + 1) if end > first else np.zeros(0, dtype=np.int64)
        if not layout.closed:
            sectors = sectors[(sectors >= 0) & (sectors < layout.count)]
        self.sectors = sectors
        self.owned = slice(int(np.searchsorted(sectors, first)), int(np.searchsorted(sectors, end)))
        nodes = np.arange(len(layout.mesh.coords))
        self.number, self.flip = partition.numbers(body, sectors, nodes)
        lo, hi = partition.row_start, partition.row_start + partition.n_own
        # on a single rank the sector before the first is an image of an owned one: it must not count twice
        self.neighbour = np.zeros(len(sectors), dtype=bool)
        self.neighbour[: self.owned.start] = True
        if layout.closed and end - first == layout.count:
            self.neighbour[:] = False
        counted = self.neighbour.copy()
        counted[self.owned] = True
        here = (self.number >= lo) & (self.number < hi) & counted[:, None]
        touches = here[:, self.cells].any(axis=2) if len(sectors) else np.zeros((0, len(self.cells)), dtype=bool)
        self.every = tuple(v.astype(np.int32) for v in np.nonzero(touches))
        self.modelled = np.ones(len(sectors), dtype=bool)
        angle = layout.turn(layout.first_tooth + sectors)
        self.turn_of_sector = np.column_stack([np.cos(angle), np.sin(angle)]).reshape(-1, 2)
        self.local = np.zeros_like(self.number, dtype=np.int32)

    def bind(self, local: LocalNodes) -> None:
        """Look up the local indices of all nodes once the rank's local nodes are known."""
        self.local = local.index(self.number)
        sector_of, ref_of = self.every
        pick = self.modelled[sector_of]
        self.sector_of, self.ref_of = sector_of[pick], ref_of[pick]
        nodes = self.cells[self.ref_of]
        self.conn = np.ascontiguousarray(self.local[self.sector_of[:, None], nodes])
        self.conn_flip = np.ascontiguousarray(self.flip[self.sector_of[:, None], nodes])
        self.turn = np.ascontiguousarray(self.turn_of_sector[self.sector_of])

    def displacement(self, u: np.ndarray) -> np.ndarray:
        """Displacement of all nodes of the seen sectors, images turned; (n_sectors, n_local, 3) mm."""
        field = np.where(self.local[..., None] >= 0, u[self.local], 0.0)
        return self.layout.fill_inside(self.sectors, np.where(self.flip[..., None] == 1, HALF_TURN * field, field))

    def positions(self) -> np.ndarray:
        """Undeformed positions of all nodes of the seen sectors; (n_sectors, n_local, 3) mm."""
        x, y, z = self.layout.mesh.coords.T
        c, s = self.turn_of_sector[:, :1], self.turn_of_sector[:, 1:]
        return np.stack([c * x - s * y, s * x + c * y, np.broadcast_to(z, (len(c), len(z)))], axis=-1)

    def nodal_stress(self, u: np.ndarray) -> np.ndarray:
        """Stress at the nodes of the owned sectors: extrapolated per element, averaged over the body's elements.

        Returns (n_owned, n_local, 6) MPa; components xx, yy, zz, xy, yz, zx in global axes; zero in sectors left out.
        """
        mesh = self.layout.mesh
        elements, tied = np.ascontiguousarray(mesh.elements), mesh.tied
        n_sectors, n_node, n_elem = len(self.sectors), len(mesh.coords), len(elements)
        sums, field = np.zeros((n_sectors, n_node, 6)), self.displacement(u)
        every, unturned = np.arange(n_elem, dtype=np.int32), np.zeros(elements.shape, dtype=np.uint8)
        for k in np.flatnonzero(self.modelled):
            stress = recover_stress(
                self.reference,
                every,
                np.repeat(self.turn_of_sector[k : k + 1], n_elem, axis=0),
                elements,
                unturned,
                field[k],
            )
            for c in range(6):
                sums[k, :, c] = np.bincount(elements.ravel(), stress[:, :, c].ravel(), minlength=n_node)
        count = np.bincount(elements.ravel(), minlength=n_node).astype(float)
        if tied is not None:
            sums, count = sums[:, tied], count[tied]
        counts = self.modelled[:, None] * count
        ccw, cw = mesh.ccw_nodes, mesh.cw_nodes
        total = sums[:-1, ccw] + sums[1:, cw]
        number = counts[:-1, ccw] + counts[1:, cw]
        sums[:-1, ccw], sums[1:, cw] = total, total
        counts[:-1, ccw], counts[1:, cw] = number, number
        return (sums / np.maximum(counts, 1.0)[..., None])[self.owned]


class Elements:
    """All bodies' elements on one rank: residual, tangent and stress of the structure.

    symmetric : keep the tangent's upper triangle only
    """

    def __init__(self, partition: Partition, references: list[ReferenceElements], symmetric: bool = True) -> None:
        self.partition, self.symmetric = partition, symmetric
        self.bodies = [BodyElements(partition, k, r) for k, r in enumerate(references)]
        seen = [b.number.ravel() for b in self.bodies] + [partition.multiplier_nodes]
        self.wanted = np.unique(np.concatenate(seen))

    def bind(self, local: LocalNodes) -> None:
        """Look up local indices, and lay out the blocks of the sectors that are modelled."""
        for body in self.bodies:
            body.bind(local)
        touched = np.zeros(local.n_own, dtype=bool)
        for body in self.bodies:
            touched[body.conn[(body.conn >= 0) & (body.conn < local.n_own)]] = True
        multipliers = self.partition.multiplier_nodes - local.row_start
        touched[multipliers[(multipliers >= 0) & (multipliers < local.n_own)]] = True
        self.idle = np.flatnonzero(~touched)
        keys = []
        for body in self.bodies:
            number = np.where(body.conn >= 0, local.number[body.conn], -1).astype(np.int64)
            keys.append(self._pairs(body.conn, number, local).ravel())
        if local.n_own and local.row_start + local.n_own == self.partition.n_global:
            m = self.partition.multiplier_nodes
            keys.append(m * self.partition.n_global + m)
        own = np.arange(local.row_start, local.row_start + local.n_own)
        keys.append(own * self.partition.n_global + own)
        keys = np.unique(np.concatenate(keys))
        self.keys = keys[keys >= 0]
        self.slots = [
            np.searchsorted(
                self.keys, self._pairs(b.conn, np.where(b.conn >= 0, local.number[b.conn], -1).astype(np.int64), local)
            )
            for b in self.bodies
        ]
        for slot, body in zip(self.slots, self.bodies):
            number = np.where(body.conn >= 0, local.number[body.conn], -1).astype(np.int64)
            slot[self._pairs(body.conn, number, local) < 0] = -1

    def _pairs(self, conn: np.ndarray, number: np.ndarray, local: LocalNodes) -> np.ndarray:
        """Keys row * n_global + column of an element's owned blocks, -1 elsewhere; (n, pairs)."""
        row, col = number[:, :, None], number[:, None, :]
        owned = ((conn >= 0) & (conn < local.n_own))[:, :, None]
        keys = np.where(owned & (col >= (row if self.symmetric else 0)), row * self.partition.n_global + col, -1)
        return keys.reshape(len(conn), conn.shape[1] ** 2)

    def rows(self, extra: np.ndarray, number: np.ndarray) -> tuple[BlockRows, list[np.ndarray]]:
        """Pattern of the elements joined with further keys, and where each body's element blocks are in it.

        extra : keys row * n_global + column of contact blocks;  number : (n_local,) int32 global numbers
        """
        keys = np.union1d(self.keys, extra) if len(extra) else self.keys
        n = self.partition.n_global
        row, column = np.divmod(keys, n)
        first = self.partition.row_start
        start = np.searchsorted(row, np.arange(first, first + self.partition.n_own + 1))
        place = np.searchsorted(keys, self.keys)
        rows = BlockRows(
            start.astype(np.int64),
            column.astype(np.int32),
            np.zeros((len(keys), 3, 3)),
            number,
            self.partition.n_own,
            keys,
            self.symmetric,
        )
        return rows, [np.where(slot >= 0, place[slot], -1) for slot in self.slots]

    def assemble(
        self, u: np.ndarray, residual: np.ndarray | None, rows: BlockRows | None, slots: list[np.ndarray] | None
    ) -> None:
        """Add internal forces to `residual` (n_local, 3) N and tangent blocks to `rows.values`."""
        for k, body in enumerate(self.bodies):
            if len(body.conn):
                assemble_elements(
                    body.assembled,
                    body.ref_of,
                    body.turn,
                    body.conn,
                    body.conn_flip,
                    u,
                    residual,
                    None if slots is None else slots[k],
                    None if rows is None else rows.values,
                )
