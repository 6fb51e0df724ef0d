"""Data of the flanks' contact: its settings, the state from which friction counts, the cells of an
evaluation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from swgpar.contact.cell_placement import PlacedCells
from swgpar.contact.contact_lines import LineForces, Strips
from swgpar.contact.flank_pairs import Faces, FlankPairs
from swgpar.contact.friction import CellTractions, Friction, PairKey


class RingMotion(Protocol):
    """Rotation of the ring gear as a whole; both methods are collective.

    floats : whether it is not fixed
    """

    floats: bool

    def ring_rotation(self, u: np.ndarray) -> float:
        """Rotation (rad) of the ring gear at displacement u (n_local, 3) mm; zero when it is
        fixed."""

    def add_ring_moment(self, u: np.ndarray, moment: float, residual: np.ndarray) -> None:
        """Add to residual (n_local, 3) N this rank's part of a moment (N mm) that acts on that
        rotation."""


@dataclass(frozen=True)
class SearchRange:
    """Distances (mm) of a search.

    near : faces whose middle is closer to the master are evaluated
    reach : the same of a whole flank, without which none of its faces is
    touch : for faces closer than that the tangent's pattern has blocks
    """

    near: float
    reach: float
    touch: float


@dataclass(frozen=True)
class FrictionStart:
    """State from which friction counts the slip.

    displacement : (n_local, 3) mm, converged
    tractions : by flank pair
    """

    displacement: np.ndarray
    tractions: Mapping[PairKey, CellTractions]


@dataclass
class ActiveCells:
    """Cells of the lines that touch, with the results of the last evaluation.

    flank_pairs : pairs and faces of the search that they belong to
    placed : the cells;  slave, master : their ends on both flanks
    has_foot : (n,) bool, cells that lay on the master when they were placed
    softness : (n,) mm / (N/mm), further compliance of each cell by itself
    length : (n,) mm, share of each cell's line in the face width
    friction : law and tractions at the points, None without friction
    gap (n,) mm, averaged over each cell;  forces : on the cells;  pressure : (n, n_q) MPa
    """

    flank_pairs: FlankPairs
    placed: PlacedCells
    slave: Strips
    master: Strips
    has_foot: np.ndarray
    softness: np.ndarray
    length: np.ndarray
    friction: Friction | None
    gap: np.ndarray
    forces: LineForces
    pressure: np.ndarray

    @property
    def faces(self) -> Faces:
        """Quadrature points of the cells."""
        return self.placed.faces

    @property
    def parent(self) -> np.ndarray:
        """Face (n,) of each cell among those of all pairs."""
        return self.placed.cells.parent

    @property
    def width(self) -> np.ndarray:
        """Width (n,) mm of each cell along the profile."""
        return self.slave.high - self.slave.low
