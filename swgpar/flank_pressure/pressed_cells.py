"""Cells of the contact law that carry, by flank of either gear, in the plane."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from swgpar.contact.flanks import FlankContact
from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.flank_pressure.flank_loads import nodal_shares
from swgpar.model.drive_model import DriveModel

POINTS = 8
"""Points of a cell at which its force acts on another mesh."""


@dataclass(frozen=True)
class PressedCells:
    """Cells that carry on a flank.

    low, high : (n,) mm, their ends, arc lengths from the tip of the tooth
    force : (n,) N/mm
    """

    low: np.ndarray
    high: np.ndarray
    force: np.ndarray

    def shares(self, s: np.ndarray) -> np.ndarray:
        """Shares (n,) of the nodes at `s` (n,) mm of another mesh in a load of 1."""
        across = (np.arange(POINTS) + 0.5) / POINTS
        place = self.low[:, None] + (self.high - self.low)[:, None] * across
        return nodal_shares(s, place.ravel(), np.repeat(self.force / POINTS, POINTS))

    @property
    def ends(self) -> np.ndarray:
        """Ends (m,) mm of all cells."""
        return np.unique(np.r_[self.low, self.high])


def pressed_cells(
    model: DriveModel, flanks: FlankContact, gear: str, teeth: np.ndarray
) -> Mapping[tuple[int, int], PressedCells]:
    """Cells on the flanks of the `teeth` (n,) of a gear by (index of the tooth, side), by the last
    evaluation of `flanks`; collective."""
    layout, active, own = model.partition.layouts[gear], flanks.cells.active, []
    on_spline = gear == FLEXIBLE_SPLINE
    if active is not None:
        strips = active.slave if on_spline else active.master
        carries = active.carries & active.owned
        for k in np.unique(active.faces.patch[carries]):
            pair, of_pair = flanks.pairs[k], carries & (active.faces.patch == k)
            flank = (pair.sector, pair.side) if on_spline else (pair.ring, -pair.side)
            values = (strips.low, strips.high, active.forces.force)
            own.append((flank, [value[of_pair] for value in values]))
    found: dict[tuple[int, int], list[list[np.ndarray]]] = {}
    index = {int(sector): k for k, sector in enumerate(layout.sector_of_tooth(teeth)[0])}
    for (sector, side), values in (one for part in model.comm.allgather(own) for one in part):
        if (k := index.get(sector)) is not None:
            found.setdefault((k, side), []).append(values)
    return {
        flank: PressedCells(*(np.concatenate(each) for each in zip(*parts)))
        for flank, parts in found.items()
    }
