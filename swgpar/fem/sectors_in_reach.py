"""What flanks cannot reach is modelled with less.

Ring-gear sectors that no tooth of the flexible spline can reach are left out: the frame supports
them, and their effect on loaded teeth decays within a few pitches. The tangent has no rows of them.

Teeth of solid gears that reach no flank are one element each (`condensed_parts.py`). The tangent
has no rows of the nodes inside of them either; their displacement follows from the tooth's rim.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from swgpar.fem.body import RING_GEAR
from swgpar.fem.elements import BodyElements, Elements


class SectorsInReach:
    """Which sectors of a closed chain are within reach or near; the same choice on every rank.

    body : name of the body;  count : its sectors in the model
    take : changes the elements of the body, by the choice for the sectors that a rank sees
    margins : active sectors on each side of those within reach: at least, when the choice is made
    anew, and at most

    Attributes:
    active : (count,) bool
    """

    def __init__(
        self,
        body: str,
        count: int,
        take: Callable[[BodyElements, np.ndarray], None],
        margins: tuple[int, int, int],
    ) -> None:
        self.body, self.margins, self._take = body, margins, take
        self.active = np.ones(count, dtype=bool)

    @classmethod
    def of_ring(cls, count: int) -> SectorsInReach:
        """Sectors of the ring gear that are modelled."""
        return cls(RING_GEAR, count, BodyElements.activate, (2, 3, 5))

    @classmethod
    def whole_teeth(cls, body: str, count: int) -> SectorsInReach:
        """Teeth of a body that are not one element; no flank of the others may touch.

        The choice follows from the shape at the search alone: one that repeats has the same teeth.
        """
        return cls(body, count, BodyElements.keep_teeth, (1, 1, 1))

    def _with_neighbours(self, sectors: np.ndarray, margin: int) -> np.ndarray:
        """Mask (count,) of the sectors (n,) and of `margin` sectors on either side."""
        mask = np.zeros(len(self.active), dtype=bool)
        mask[(sectors[:, None] + np.arange(-margin, margin + 1)) % len(mask)] = True
        return mask

    def update(self, within_reach: np.ndarray, elements: Elements) -> bool:
        """Choose by the sectors (n,) within reach; returns whether the elements have changed."""
        least, anew, most = (self._with_neighbours(within_reach, one) for one in self.margins)
        if not (least & ~self.active).any() and not (self.active & ~most).any():
            return False
        self._choose(anew, elements)
        return True

    def resume(self, active: list[int], elements: Elements) -> None:
        """Take a choice as it was made before: the sectors that are active."""
        self._choose(np.isin(np.arange(len(self.active)), active), elements)

    def chosen(self) -> list[int]:
        """The sectors that are active, for `resume`."""
        return np.flatnonzero(self.active).tolist()

    def _choose(self, active: np.ndarray, elements: Elements) -> None:
        self.active, body = active, elements.bodies[self.body]
        self._take(body, active[body.sectors % len(active)])


class ModelledSectors:
    """What of a drive is modelled in full.

    elements : of the drive
    ring_sectors : of the ring gear that are modelled; None where all are
    whole_teeth : teeth of bodies that are not one element; none where all are
    """

    def __init__(
        self,
        elements: Elements,
        ring_sectors: SectorsInReach | None = None,
        whole_teeth: Sequence[SectorsInReach] = (),
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
