"""Cells of the lines of contact that are near, with the results of the last evaluation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.contact.cell_placement import PlacedCells
from swgpar.contact.contact import FacePressure
from swgpar.contact.contact_lines import CellLoads, Strips
from swgpar.contact.flank_pairs import Faces, FlankPairs
from swgpar.contact.friction import Friction

SLIP_SHARE = 0.99
"""Share of the friction bound from which a point counts as slipping: base vectors have unit length
but for strain."""


@dataclass
class ActiveCells:
    """The cells of a contact of flanks.

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
    forces: CellLoads
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

    @property
    def carries(self) -> np.ndarray:
        """Which cells (n,) have a force."""
        return self.forces.force > 0.0

    @property
    def owned(self) -> np.ndarray:
        """Which cells (n,) are on a tooth of the flexible spline that this rank owns."""
        return self.flank_pairs.owned[self.faces.patch]

    def _slips(self, law: Friction) -> np.ndarray:
        """Which points (n, n_q) have a traction at the bound of the friction."""
        limit = SLIP_SHARE * law.coefficient * self.pressure
        return np.linalg.norm(law.current, axis=2) >= limit

    def active_sets(self) -> list[np.ndarray]:
        """Numbers of the faces with pressure, and with friction of those with points that slip."""
        carries = self.carries
        sets = [carries]
        if self.friction is not None:
            sets.append(carries & self._slips(self.friction).any(axis=1))
        return [np.unique(self.parent[cells]) for cells in sets]

    def touching_pairs(self) -> int:
        """Flank pairs with pressure whose flexible-spline tooth this rank owns."""
        return len(np.unique(self.faces.patch[self.carries & self.owned]))

    def doubtful_slip(self) -> tuple[float, float]:
        """Force (N) on points of owned faces that stick, or have no foot in the accepted state and
        so no slip; and on all points. 0 without friction."""
        law = self.friction
        if law is None:
            return 0.0, 0.0
        force = self.faces.weight * self.pressure
        force[~self.owned] = 0.0
        slips = self._slips(law) & np.isfinite(law.foot_point[..., 0])
        return float(force[~slips].sum()), float(force.sum())

    def smallest_gap(self, side: int) -> float:
        """Smallest gap (mm) of the flanks on one side (+1, -1); inf without any."""
        of_side = np.array([p.side for p in self.flank_pairs.pairs])[self.faces.patch] == side
        return min(self.placed.nearest[side], float(self.gap[of_side].min(initial=np.inf)))

    def owned_pressure(self) -> FacePressure:
        """Pressures on owned faces."""
        own, faces = self.owned, self.faces
        return FacePressure(
            faces.conn[own], faces.shape[own], faces.weight[own], self.pressure[own]
        )
