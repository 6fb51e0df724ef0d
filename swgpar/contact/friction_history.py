"""What friction counts from: the last accepted state of a contact of flanks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from swgpar.contact import friction
from swgpar.contact.active_cells import ActiveCells
from swgpar.contact.flank_kernel import FlankKernel
from swgpar.contact.friction import CellTractions, Friction, PairKey


@dataclass(frozen=True)
class _Start:
    """State from which friction counts the slip.

    displacement : (n_local, 3) mm, converged;  ring_rotation : rad
    tractions : by flank pair
    """

    displacement: np.ndarray
    ring_rotation: float
    tractions: Mapping[PairKey, CellTractions]


class FrictionHistory:
    """Tangential tractions of the last accepted state, and what begins from them.

    coefficient : of friction;  lines_of_flank : lines of contact on a flank

    Attributes
    ----------
    tractions : of the last accepted state by flank pair
    """

    def __init__(self, coefficient: float, lines_of_flank: int) -> None:
        self.coefficient, self._lines_of_flank = coefficient, lines_of_flank
        self.tractions: dict[PairKey, CellTractions] = {}
        self._start: _Start | None = None

    def begin(self, accepted: np.ndarray, ring_rotation: float) -> None:
        """Count the slip of a solve from the tractions of now and this state.

        accepted : (n_local, 3) mm, displacement;  ring_rotation : rad, of the ring gear
        """
        self._start = _Start(accepted, ring_rotation, self.tractions)

    def begin_without(self) -> None:
        """Let a solve be without friction."""
        self._start = None

    def on_cells(
        self, active: ActiveCells, stiffness: np.ndarray, kernel: FlankKernel
    ) -> Friction | None:
        """The law with the last accepted state at the points of cells; None without friction.

        stiffness : (n,) MPa / mm, tangential, of the cells;  kernel : gives gaps
        """
        start = self._start
        if start is None:
            return None
        faces, slave = active.faces, active.slave
        gap, foot_point = kernel.gaps(faces, start.displacement, None, 0.0, start.ring_rotation)
        traction = np.zeros((*faces.weight.shape, 2))
        of_flank = active.placed.line % self._lines_of_flank
        for k, pair in enumerate(active.flank_pairs.pairs):
            stored, mine = start.tractions.get(pair.key), faces.patch == k
            if stored is not None and mine.any():
                means = stored.means(of_flank[mine], slave.low[mine], slave.high[mine])
                traction[mine] = means[:, None]
        of_points = np.repeat(stiffness[:, None], faces.weight.shape[1], axis=1)
        return friction.begin(self.coefficient, of_points, foot_point, gap, traction)

    def accept(self, active: ActiveCells | None) -> None:
        """Keep the tractions of the last evaluation of cells, of a converged state."""
        self.tractions = {}
        if active is None or active.friction is None:
            return
        carries, of_flank = active.carries, active.placed.line % self._lines_of_flank
        for k in np.unique(active.faces.patch[carries]):
            mine = (active.faces.patch == k) & carries
            self.tractions[active.flank_pairs.pairs[k].key] = CellTractions(
                of_flank[mine],
                active.slave.low[mine],
                active.slave.high[mine],
                active.friction.current[mine].mean(axis=1),
            )
