"""What flanks cannot reach is modelled with less.

Ring-gear sectors that no tooth of the flexible spline can reach are left out: the frame supports
them, and their effect on loaded teeth decays within a few pitches. The tangent has no rows of them.

Teeth of solid gears that reach no flank are one element each (`condensed_parts.py`). The tangent
has no rows of the nodes inside of them either; their displacement follows from the tooth's rim.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from swgpar.fem.body import RING_GEAR
from swgpar.fem.elements import BodyElements, Elements


class SectorsInReach(ABC):
    """Which sectors of a closed chain are within reach or near; the same choice on every rank.

    count : sectors of the body in the model

    Attributes:
    active : (count,) bool
    """

    LEAST: int
    """Sectors on each side of those within reach that are active, at least."""
    MARGIN: int
    """The same when the choice is made anew."""
    MOST: int
    """The same, at most."""

    def __init__(self, count: int) -> None:
        self.active = np.ones(count, dtype=bool)

    def _with_neighbours(self, sectors: np.ndarray, margin: int) -> np.ndarray:
        """Mask (count,) of the sectors (n,) and of `margin` sectors on either side."""
        mask = np.zeros(len(self.active), dtype=bool)
        mask[(sectors[:, None] + np.arange(-margin, margin + 1)) % len(mask)] = True
        return mask

    def update(self, within_reach: np.ndarray, elements: Elements) -> bool:
        """Choose by the sectors (n,) within reach; returns whether the elements have changed."""
        missing = self._with_neighbours(within_reach, self.LEAST) & ~self.active
        if (
            not missing.any()
            and not (self.active & ~self._with_neighbours(within_reach, self.MOST)).any()
        ):
            return False
        self.active = self._with_neighbours(within_reach, self.MARGIN)
        self._apply(elements)
        return True

    def resume(self, active: list[int], elements: Elements) -> None:
        """Take a choice as it was made before: the sectors that are active."""
        self.active = np.isin(np.arange(len(self.active)), active)
        self._apply(elements)

    def chosen(self) -> list[int]:
        """The sectors that are active, for `resume`."""
        return np.flatnonzero(self.active).tolist()

    @abstractmethod
    def _apply(self, elements: Elements) -> None:
        """Change the elements."""

    def _seen(self, body: BodyElements) -> np.ndarray:
        """The choice (n_sectors,) for the sectors of a body that a rank sees."""
        return self.active[body.sectors % len(self.active)]


class RingSectors(SectorsInReach):
    """Sectors of the ring gear that are modelled."""

    LEAST, MARGIN, MOST = 2, 3, 5

    def _apply(self, elements: Elements) -> None:
        body = elements.bodies[RING_GEAR]
        body.activate(self._seen(body))


class WholeTeeth(SectorsInReach):
    """Teeth of a body that are not one element; no flank of the others may touch. `body` : its name

    The choice follows from the shape at the search alone: one that repeats has the same teeth.
    """

    LEAST, MARGIN, MOST = 1, 1, 1

    def __init__(self, count: int, body: str) -> None:
        super().__init__(count)
        self.body = body

    def _apply(self, elements: Elements) -> None:
        body = elements.bodies[self.body]
        body.condense_teeth(~self._seen(body))
