"""Which rank owns what: sectors, nodes, ghosts and global numbers.

A body is a chain of congruent tooth sectors. Rank r owns a contiguous range of them, so that node
numbers, owners and neighbours follow from arithmetic and nothing global is ever stored. A node on the
counter-clockwise side of sector k is the clockwise-side node of sector k + 1.

With twofold symmetry only half a turn is modelled: the sector after the last one is sector 0 turned by
180 degrees, so a node of it is an *image*: its vectors are diag(-1, -1, 1) times those of the owner.
Displacement unknowns are numbered in blocks of three per node; nodes fixed to the frame and inside of condensed sectors
have none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from swgpar.fem.condensed_sectors import CondensedSector
from swgpar.meshing.sector import SectorMesh

MULTIPLIER_NODES = 2
"""Blocks appended after the last node for each body that floats: six multipliers of its coupling."""


def split(n: int, parts: int) -> np.ndarray:
    """Starts of `parts` contiguous ranges that share `n` things evenly; shape (parts + 1,)."""
    return (np.arange(parts + 1) * n) // parts


@dataclass(frozen=True)
class BodyLayout:
    """The modelled sectors of one body.

    mesh : the congruent sector
    first_tooth, count : modelled teeth first_tooth .. first_tooth + count - 1
    closed : the chain closes on itself (with a half turn when the model is halved)
    images : True when the model holds half a turn
    fixed : (n_fixed,) local nodes that do not move
    condensed : the sector as one element, whose inner nodes have no unknowns; None where they have
    """

    mesh: SectorMesh
    first_tooth: int
    count: int
    closed: bool
    images: bool
    fixed: np.ndarray
    condensed: CondensedSector | None = None

    def __post_init__(self) -> None:
        n = len(self.mesh.coords)
        partner = np.full(n, -1, dtype=np.int64)
        partner[self.mesh.ccw_nodes] = self.mesh.cw_nodes
        absent = np.zeros(n, dtype=bool)
        absent[self.fixed] = True
        if self.condensed is not None:
            absent[self.condensed.inner] = True
        row = np.where(absent, -1, 0)
        row[self.mesh.ccw_nodes] = -1
        tied = self.mesh.tied
        if tied is not None:
            row[tied != np.arange(n)] = -1
        own = np.flatnonzero(row == 0)
        row[own] = np.arange(len(own))
        if tied is not None:
            row = row[tied]
        cap = row[self.mesh.cw_nodes]
        cap_nodes = np.sort(self.mesh.cw_nodes[cap >= 0])
        cap_row = np.full(n, -1, dtype=np.int64)
        cap_row[cap_nodes] = np.arange(len(cap_nodes))
        if tied is not None:
            absent = absent[tied]
        for name, value in dict(
            partner=partner,
            row=row,
            own=own,
            cap_row=cap_row,
            absent=absent,
            n_cap=0 if self.closed else len(cap_nodes),
        ).items():
            object.__setattr__(self, name, value)

    @property
    def name(self) -> str:
        return self.mesh.body

    @property
    def teeth_per_period(self) -> int:
        """Teeth after which the model repeats: half or all of them."""
        return self.mesh.n_sectors // 2 if self.images else self.mesh.n_sectors

    def turn(self, tooth: np.ndarray) -> np.ndarray:
        """Angle of a tooth about z, counter-clockwise from +y, radians."""
        return self.mesh.phase + np.asarray(tooth) * (2.0 * np.pi / self.mesh.n_sectors)

    def fill_inside(self, sectors: np.ndarray, field: np.ndarray) -> np.ndarray:
        """`field` (n, n_local_nodes, 3) mm of chain indices (n,), with what is inside of condensed sectors."""
        if self.condensed is not None:
            angle = self.turn(self.first_tooth + sectors)
            field[:, self.condensed.inner] = self.condensed.inside(angle, field[:, self.condensed.outer])
            if self.mesh.tied is not None:
                field = np.ascontiguousarray(field[:, self.mesh.tied])
        return field

    def locate(self, tooth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Modelled chain index of any tooth number (-1 where it is left out) and its image flag."""
        periods, rest = np.divmod(np.asarray(tooth) - self.first_tooth, self.teeth_per_period)
        index = np.where(rest < self.count, rest, -1)
        flip = (periods % 2).astype(np.uint8) if self.images else np.zeros_like(rest, dtype=np.uint8)
        return index, flip


class Partition:
    """Ownership and numbering of all bodies on one communicator.

    Parameters
    ----------
    layouts : the bodies, flexible spline first
    comm : communicator; each rank owns a contiguous range of sectors of every body

    `dims` is the number of unknowns per node that the tangent has: 2 in the plane, where vectors keep a zero z.
    """

    def __init__(self, layouts: list[BodyLayout], comm: MPI.Comm) -> None:
        self.comm = comm
        self.layouts = layouts
        self.dims = 3 if layouts[0].mesh.tied is None else 2
        self.starts = [split(b.count, comm.size) for b in layouts]
        sizes = np.array(
            [
                [
                    np.diff(s)[r] * len(b.own) + (b.n_cap if r == comm.size - 1 else 0)
                    for s, b in zip(self.starts, layouts)
                ]
                for r in range(comm.size)
            ]
        )
        appended = MULTIPLIER_NODES * sum(len(b.fixed) == 0 for b in layouts)
        sizes[-1, -1] += appended
        flat = np.concatenate([[0], np.cumsum(sizes.ravel())])
        self._base = flat[:-1].reshape(sizes.shape)
        self.n_global = int(flat[-1])
        self.row_start = int(self._base[comm.rank, 0])
        self.n_own = int(sizes[comm.rank].sum())
        self.multiplier_nodes = self.n_global - appended + np.arange(appended)
        self.n_multipliers = 3 * appended

    def owned(self, body: int) -> tuple[int, int]:
        """Range (first, end) of chain indices this rank owns."""
        return int(self.starts[body][self.comm.rank]), int(self.starts[body][self.comm.rank + 1])

    def owner(self, body: int, index: np.ndarray) -> np.ndarray:
        """Rank that owns a chain index."""
        return np.searchsorted(self.starts[body], index, side="right") - 1

    def wrap(self, body: int, index: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Chain index brought into 0 .. count - 1 of a closed chain, and the image flag of the way."""
        b = self.layouts[body]
        index = np.asarray(index)
        periods, rest = np.divmod(index, b.count)
        flip = (periods % 2).astype(np.uint8) if b.images else np.zeros_like(rest, dtype=np.uint8)
        return rest, flip

    def numbers(self, body: int, index: np.ndarray, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Global block numbers of local nodes of sectors.

        Parameters
        ----------
        index : (m,) chain indices; for a closed chain one below 0 or above the end is an image
        nodes : (k,) local nodes

        Returns
        -------
        number : (m, k) int64, -1 where the node has no unknowns
        flip : (m, k) uint8, 1 where the owner's vectors must be turned by 180 degrees
        """
        b = self.layouts[body]
        index, nodes = np.asarray(index, dtype=np.int64), np.asarray(nodes, dtype=np.int64)
        side = b.partner[nodes] >= 0
        local = np.where(side, b.partner[nodes], nodes)
        k = index[:, None] + side[None, :]
        cap = np.zeros(k.shape, dtype=bool)
        flip = np.zeros(k.shape, dtype=np.uint8)
        if b.closed:
            k, flip = self.wrap(body, k)
        else:
            cap = k == b.count
            k = np.where(cap, b.count - 1, k)
        rank = self.owner(body, k)
        local = np.broadcast_to(local, k.shape)
        offset = np.where(
            cap,
            (self.starts[body][rank + 1] - self.starts[body][rank]) * len(b.own) + b.cap_row[local],
            (k - self.starts[body][rank]) * len(b.own) + b.row[local],
        )
        number = self._base[rank, body] + offset
        absent = np.broadcast_to(b.absent[nodes], k.shape)
        return np.where(absent, -1, number), np.where(absent, 0, flip).astype(np.uint8)


class LocalNodes:
    """The nodes a rank sees: its own, in global order, then ghosts, then further ghosts.

    Parameters
    ----------
    wanted : global block numbers whose local indices must not change (negative ones are ignored)
    further : more global block numbers, indexed after all of those
    """

    def __init__(self, partition: Partition, wanted: np.ndarray, further: np.ndarray | None = None) -> None:
        self.row_start, self.n_own = partition.row_start, partition.n_own
        self.ghosts = self._foreign(wanted)
        extra = self._foreign(further) if further is not None else np.zeros(0, dtype=np.int64)
        self.further = np.setdiff1d(extra, self.ghosts)
        own = np.arange(self.row_start, self.row_start + self.n_own)
        self.number = np.concatenate([own, self.ghosts, self.further]).astype(np.int32)

    def _foreign(self, number: np.ndarray) -> np.ndarray:
        number = np.unique(number)
        outside = (number < self.row_start) | (number >= self.row_start + self.n_own)
        return number[outside & (number >= 0)].astype(np.int64)

    def __len__(self) -> int:
        return len(self.number)

    def index(self, number: np.ndarray) -> np.ndarray:
        """Local index (int32) of global numbers; -1 where there is none (-1) or this rank does not see it."""
        number = np.asarray(number)
        own = (number >= self.row_start) & (number < self.row_start + self.n_own)
        found = np.where(own, number - self.row_start, -1)
        for ghosts, first in ((self.ghosts, self.n_own), (self.further, self.n_own + len(self.ghosts))):
            if len(ghosts):
                place = np.minimum(np.searchsorted(ghosts, number), len(ghosts) - 1)
                found = np.where(ghosts[place] == number, first + place, found)
        return found.astype(np.int32)
