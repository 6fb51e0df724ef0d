"""Which rank owns what: sectors, nodes and global numbers.

Rank r owns a contiguous range of the sectors of every body, so that node numbers, owners and
neighbours follow from arithmetic and no global array is stored. Displacement unknowns are numbered
in blocks of three per node. Fixed nodes and nodes inside of condensed sectors have none.
"""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from swgpar.fem.body_layout import BodyLayout
from swgpar.geometry.rotation import sixths_of_turn

MULTIPLIER_NODES = 2
"""Blocks after the last node for each body that floats: six multipliers of its coupling."""


def split(n: int, parts: int) -> np.ndarray:
    """Starts of `parts` contiguous ranges that share `n` items evenly; shape (parts + 1,)."""
    return (np.arange(parts + 1) * n) // parts


class Partition:
    """Ownership and numbering of all bodies on one communicator.

    layouts : the bodies in the order in which each rank numbers their nodes
    comm : communicator; each rank owns a contiguous range of sectors of every body

    Attributes:
    layouts : bodies by name
    dims : unknowns per node that the tangent has: 2 in the plane, where vectors keep a zero z
    """

    def __init__(self, layouts: list[BodyLayout], comm: MPI.Comm) -> None:
        self.comm = comm
        self.layouts = {layout.name: layout for layout in layouts}
        self.dims = 2 if layouts[0].mesh.plane else 3
        self._first = {b.name: split(b.count, comm.size) for b in layouts}
        sizes = np.column_stack(
            [np.diff(self._first[b.name]) * len(b.numbering.owned_nodes) for b in layouts]
        )
        sizes[-1] += [b.numbering.n_end for b in layouts]
        appended = MULTIPLIER_NODES * sum(len(b.fixed) == 0 for b in layouts)
        sizes[-1, -1] += appended
        flat = np.concatenate([[0], np.cumsum(sizes.ravel())])
        base = flat[:-1].reshape(sizes.shape)
        self._base = {b.name: base[:, k] for k, b in enumerate(layouts)}
        self.n_global = int(flat[-1])
        self.row_start = int(base[comm.rank, 0])
        self.n_own = int(sizes[comm.rank].sum())
        self.multiplier_nodes = self.n_global - appended + np.arange(appended)
        self.n_multipliers = 3 * appended

    @property
    def has_multipliers(self) -> bool:
        """Whether the rows of the multipliers are on this rank: the last one, if there are any."""
        return self.n_multipliers > 0 and self.comm.rank == self.comm.size - 1

    def owns(self, number: np.ndarray) -> np.ndarray:
        """Whether this rank owns the nodes of global numbers; any shape."""
        return (number >= self.row_start) & (number < self.row_start + self.n_own)

    def owned_sectors(self, body: str) -> tuple[int, int]:
        """Range (first, end) of the indices in the chain of the sectors that this rank owns."""
        return int(self._first[body][self.comm.rank]), int(self._first[body][self.comm.rank + 1])

    def owned_indices(self, body: str) -> np.ndarray:
        """Indices (n,) in the chain of the sectors that this rank owns."""
        return np.arange(*self.owned_sectors(body))

    def owner_of_sector(self, body: str, index: np.ndarray) -> np.ndarray:
        """Ranks (n,) that own the sectors of the indices (n,) in the chain."""
        return np.searchsorted(self._first[body], index, side="right") - 1

    def node_numbers(
        self, body: str, index: np.ndarray, nodes: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Global block numbers of local nodes of sectors.

        index : (m,) chain indices; for a closed chain one below 0 or above the end is an image
        nodes : (k,) local nodes

        Returns numbers (m, k), -1 where the node has no unknowns, and sixths of a turn (m, k),
        uint8, by which the owner's vectors must be rotated.
        """
        b, numbering = self.layouts[body], self.layouts[body].numbering
        index, nodes = np.asarray(index, dtype=np.int64), np.asarray(nodes, dtype=np.int64)
        shared = numbering.previous[nodes] >= 0
        local = np.where(shared, numbering.previous[nodes], nodes)
        k = index[:, None] + shared[None, :]
        end = np.zeros(k.shape, dtype=bool)
        sixths = np.zeros(k.shape, dtype=np.uint8)
        if b.closed:
            periods, k = np.divmod(k, b.count)
            sixths = sixths_of_turn(b.copies, periods)
        else:
            end = k == b.count
            k = np.where(end, b.count - 1, k)
        rank = self.owner_of_sector(body, k)
        local = np.broadcast_to(local, k.shape)
        # the nodes that close an open chain follow those of its last sector
        before = (k + end - self._first[body][rank]) * len(numbering.owned_nodes)
        row = np.where(end, numbering.end_row[local], numbering.row[local])
        number = self._base[body][rank] + before + row
        absent = np.broadcast_to(numbering.without_unknowns[nodes], k.shape)
        return np.where(absent, -1, number), np.where(absent, 0, sixths).astype(np.uint8)
