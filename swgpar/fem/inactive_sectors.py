"""Ring-gear sectors that no tooth of the flexible spline can reach are left out of the model.

They are held by the housing, and what little they do for the loaded teeth fades within a few pitches: their elements
are dropped, their nodes stand still, and their rows of the tangent hold nothing but a diagonal, which costs no fill.
"""

from __future__ import annotations

import numpy as np

from swgpar.fem.elements import Elements
from swgpar.fem.partition import LocalNodes

RING = 1
"""Place of the ring gear among the bodies."""

LEAST, MARGIN = 4, 6
"""Sectors kept on each side of those within reach: at least, and when the choice is made anew."""


class InactiveSectors:
    """Which sectors of the ring gear are modelled; the same choice on every rank.

    count : sectors of the ring gear in the model, a closed chain
    """

    def __init__(self, count: int) -> None:
        self.modelled = np.ones(count, dtype=bool)

    def _around(self, sectors: np.ndarray, margin: int) -> np.ndarray:
        mask = np.zeros(len(self.modelled), dtype=bool)
        mask[(sectors[:, None] + np.arange(-margin, margin + 1)) % len(mask)] = True
        return mask

    def update(self, near: np.ndarray, elements: Elements, local: LocalNodes) -> bool:
        """Choose by the sectors (n,) within reach; returns whether the elements were laid out anew."""
        most = self._around(near, MARGIN + LEAST)
        if not (self._around(near, LEAST) & ~self.modelled).any() and not (self.modelled & ~most).any():
            return False
        self.modelled = self._around(near, MARGIN)
        ring = elements.bodies[RING]
        ring.modelled = self.modelled[ring.sectors % len(self.modelled)]
        elements.bind(local)
        return True
