"""What flanks cannot reach is modelled with less.

Ring-gear sectors that no tooth of the flexible spline can reach are left out: the frame supports
them, and their effect on loaded teeth decays within a few pitches. The tangent has no rows of them.

Teeth of solid gears that reach no flank are one element each (`condensed_parts.py`). The tangent
has no rows of the nodes inside of them either; their displacement follows from the tooth's rim.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence

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


class ModelledSectors:
    """What of a drive is modelled in full.

    elements : of the drive
    ring_sectors : of the ring gear that are modelled; None where all are
    whole_teeth : teeth of bodies that are not one element; none where all are
    """

    def __init__(
        self,
        elements: Elements,
        ring_sectors: RingSectors | None = None,
        whole_teeth: Sequence[WholeTeeth] = (),
    ) -> None:
        self.elements, self.ring_sectors, self.whole_teeth = elements, ring_sectors, whole_teeth
        self.choices: list[SectorsInReach] = [*whole_teeth]
        if ring_sectors is not None:
            self.choices.append(ring_sectors)

    def update(self, within: Mapping[str, np.ndarray], near: Mapping[str, np.ndarray]) -> bool:
        """Choose anew by the sectors (n,) of each body within reach, and those of ring gears near
        others; returns whether the elements have changed."""
        changed = [teeth.update(within[teeth.body], self.elements) for teeth in self.whole_teeth]
        if self.ring_sectors is not None:
            changed.append(self.ring_sectors.update(near[RING_GEAR], self.elements))
        if any(changed):
            self.elements.renew_pattern()
        return any(changed)

    def resume(self, chosen: Sequence[list[int]]) -> None:
        """Take choices as `chosen` gave them."""
        for choice, active in zip(self.choices, chosen):
            choice.resume(active, self.elements)
        self.elements.renew_pattern()

    def chosen(self) -> list[list[int]]:
        """Which teeth and sectors are modelled in full, for `resume`."""
        return [choice.chosen() for choice in self.choices]

    def complete(self, u: np.ndarray, x: np.ndarray) -> None:
        """Let the inside of condensed teeth follow their rims.

        u : (n_local, 3) mm, of the nodes that this rank sees;  x : (n_own, 3) mm, of its own nodes
        """
        for teeth in self.whole_teeth:
            nodes, values = self.elements.bodies[teeth.body].inside_of_teeth(u)
            x[nodes] = values
