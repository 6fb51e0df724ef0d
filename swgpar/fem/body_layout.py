"""The modelled tooth sectors of one body, and where the unknowns of a sector's nodes are.

A body is a chain of congruent tooth sectors. A node on the counter-clockwise side of sector k is a
node on the clockwise side of sector k + 1. With a symmetry of rotation the chain is half a turn
long, or a third: the sector after the last one is sector 0 rotated by that. A node of it is an
*image*: its vectors are those of the owner, rotated. The flag of a node, `sixths`, is that rotation
in sixths of a turn: 0 for the owner itself, 3 after half a turn, 2 and 4 after one and two thirds.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from swgpar.fem.body import Body
from swgpar.fem.condensed_parts import CondensedPart
from swgpar.geometry.rotation import rotated, sixths_of_turn
from swgpar.materials import NO_GROWTH, Growth
from swgpar.meshing.sector import SectorMesh


@dataclass(frozen=True)
class SectorNumbering:
    """Rows of a sector's nodes, of n_node nodes each, -1 where there is none.

    previous : (n_node,) node of the next sector (on its clockwise side) with which a node on the
        counter-clockwise side coincides
    owned_nodes : (n_owned,) nodes whose unknowns belong to this sector: all but those of the
        counter-clockwise side and those without unknowns
    row : (n_node,) index of a node among the owned ones
    end_row : (n_node,) index of a clockwise-side node among those that close an open chain
    n_end : nodes that close an open chain; 0 for a closed one
    without_unknowns : (n_node,) bool nodes that are fixed, or inside of a condensed sector
    """

    previous: np.ndarray
    owned_nodes: np.ndarray
    row: np.ndarray
    end_row: np.ndarray
    n_end: int
    without_unknowns: np.ndarray


@dataclass(frozen=True, kw_only=True)
class BodyLayout:
    """The modelled sectors of one body.

    body : what is known of the body, with the mesh of the congruent sector
    first_tooth, count : modelled teeth first_tooth .. first_tooth + count - 1
    closed : the chain closes on itself, with a rotation by its own length where the model is a part
    of the drive
    copies : how many times the model makes the whole: 1, 2 or 3
    fixed : (n_fixed,) local nodes that what holds them moves, and nothing else
    held : growth of what holds them
    condensed : the sector as one element, whose inner nodes have no unknowns; None where they have
    tooth : the tooth as one element, where nothing touches its flanks; None where it is not used
    """

    body: Body
    first_tooth: int
    count: int
    closed: bool
    copies: int
    fixed: np.ndarray
    held: Growth = NO_GROWTH
    condensed: CondensedPart | None = None
    tooth: CondensedPart | None = None

    @cached_property
    def numbering(self) -> SectorNumbering:
        """Rows of the nodes of a sector."""
        mesh, n = self.mesh, len(self.mesh.coords)
        previous = np.full(n, -1, dtype=np.int64)
        previous[mesh.ccw_nodes] = mesh.cw_nodes
        without_unknowns = np.zeros(n, dtype=bool)
        without_unknowns[self.fixed] = True
        if self.condensed is not None:
            without_unknowns[self.condensed.inner] = True
        row = np.where(without_unknowns, -1, 0)
        row[mesh.ccw_nodes] = -1
        if mesh.lower_nodes is not None:
            row[mesh.lower_nodes != np.arange(n)] = -1
        owned_nodes = np.flatnonzero(row == 0)
        row[owned_nodes] = np.arange(len(owned_nodes))
        if mesh.lower_nodes is not None:
            row = row[mesh.lower_nodes]
        end_nodes = np.intersect1d(mesh.cw_nodes, owned_nodes)
        end_row = np.full(n, -1, dtype=np.int64)
        end_row[end_nodes] = np.arange(len(end_nodes))
        if mesh.lower_nodes is not None:
            end_row = end_row[mesh.lower_nodes]
            without_unknowns = without_unknowns[mesh.lower_nodes]
        n_end = 0 if self.closed else len(end_nodes)
        return SectorNumbering(previous, owned_nodes, row, end_row, n_end, without_unknowns)

    @property
    def mesh(self) -> SectorMesh:
        """The congruent sector."""
        return self.body.mesh

    @property
    def name(self) -> str:
        """Name of the body, as in the design file."""
        return self.body.name

    def sector_angle(self, tooth: np.ndarray) -> np.ndarray:
        """Angle (rad) of the sectors of teeth about z, counter-clockwise from +y; any shape."""
        return self.mesh.sector_angle(tooth)

    def chain_angle(self, index: np.ndarray) -> np.ndarray:
        """Angle (rad) of modelled sectors by their index in the chain; any shape."""
        return self.sector_angle(self.first_tooth + index)

    def sector_of_tooth(self, tooth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Index in the chain of any tooth (-1 where it is not modelled) and its flag (uint8)."""
        after = self.mesh.n_sectors // self.copies  # so many teeth the model repeats
        periods, rest = np.divmod(np.asarray(tooth) - self.first_tooth, after)
        return np.where(rest < self.count, rest, -1), sixths_of_turn(self.copies, periods)

    def with_inner_nodes(self, sectors: np.ndarray, field: np.ndarray) -> np.ndarray:
        """Displacement with the values at nodes without unknowns: fixed ones, and inner ones of
        condensed sectors.

        sectors : (n,) indices in the chain;  field : (n, n_node, 3) mm, overwritten at these nodes
        """
        angle = self.chain_angle(sectors)
        if self.held:
            nodes, lower = self.fixed, self.mesh.lower_nodes
            if lower is not None:
                nodes = np.flatnonzero(np.isin(lower, nodes))
            field[:, nodes] = rotated(self.held.of(self.mesh.coords[nodes]), angle[:, None])
        if self.condensed is not None:
            outer = field[:, self.condensed.outer]
            field[:, self.condensed.inner] = self.condensed.inner_displacement(angle, outer)
            if self.mesh.lower_nodes is not None:
                field = np.ascontiguousarray(field[:, self.mesh.lower_nodes])
        return field
