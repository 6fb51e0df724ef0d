"""Data of the flanks' contact: its settings, the state from which friction counts, the segments of
an evaluation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from swgpar.contact.flank_pairs import Faces, FlankPairs
from swgpar.contact.friction import Friction
from swgpar.contact.segments import Segments


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
    tractions : (n_pair * n_face, SAMPLES, SAMPLES, 2) MPa, on the samples of all faces
    """

    displacement: np.ndarray
    tractions: np.ndarray


@dataclass
class ActiveSegments:
    """Segments of the faces near the master, with the results of the last evaluation.

    flank_pairs : pairs and faces of the search that they belong to
    faces, segments : quadrature points and their position in the parent faces
    friction : law and tractions at the points, None without friction
    multiplier, gap, pressure : (n_segment, n_q) MPa, mm, MPa
    """

    flank_pairs: FlankPairs
    faces: Faces
    segments: Segments
    friction: Friction | None
    multiplier: np.ndarray
    gap: np.ndarray
    pressure: np.ndarray
