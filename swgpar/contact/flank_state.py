"""What the flanks' contact is given: the motion of the ring gear, and the distances of a search."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np


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
class ContactSearch:
    """How far the contact search of the flanks looks.

    tip_margin : mm, radial distance of a tooth's tip inside the ring gear's tip circle up to which
    its flanks are followed
    distances : of the faces;  outer_radius : mm, no tooth is farther out
    """

    tip_margin: float
    distances: SearchRange
    outer_radius: float
