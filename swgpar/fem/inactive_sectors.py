"""Ring-gear sectors that no tooth of the flexible spline can reach are left out of the model.

The frame supports them, and their effect on the loaded teeth decays within a few pitches: their elements are dropped,
their nodes are fixed, and their rows of the tangent have a diagonal only, which causes no fill.
"""

from __future__ import annotations

import numpy as np

from swgpar.fem.body_layout import RING_GEAR
from swgpar.fem.elements import Elements

LEAST, MARGIN = 2, 3
"""Active sectors on each side of those within reach: at least, and when the choice is made anew."""


class InactiveSectors:
    """Which sectors of the ring gear are active; the same choice on every rank.

    Parameters
    ----------
    count : int
        Sectors of the ring gear in the model, a closed chain.

    Attributes
    ----------
    active : (count,) bool
    """

    def __init__(self, count: int) -> None:
        self.active = np.ones(count, dtype=bool)

    def _with_neighbours(self, sectors: np.ndarray, margin: int) -> np.ndarray:
        """Mask (count,) of the sectors (n,) and of `margin` sectors on either side."""
        mask = np.zeros(len(self.active), dtype=bool)
        mask[(sectors[:, None] + np.arange(-margin, margin + 1)) % len(mask)] = True
        return mask

    def update(self, within_reach: np.ndarray, elements: Elements) -> bool:
        """Choose by the sectors (n,) within reach; returns whether the active elements have changed."""
        most = self._with_neighbours(within_reach, MARGIN + LEAST)
        missing = self._with_neighbours(within_reach, LEAST) & ~self.active
        if not missing.any() and not (self.active & ~most).any():
            return False
        self.active = self._with_neighbours(within_reach, MARGIN)
        sectors = elements.bodies[RING_GEAR].sectors
        elements.activate(RING_GEAR, self.active[sectors % len(self.active)])
        return True
