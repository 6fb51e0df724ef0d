"""A plain ring under three loads, for two programs: dimensions, meshes, and the nodes that are
loaded or looked at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from plain_ring import ring_sector
from swgpar.materials import Isotropic
from swgpar.meshing.sector import SectorMesh

INNER, OUTER, WIDTH = 58.2, 59.2, 10.0
"""mm, near the rim of the reference drive"""

STEEL = Isotropic(E=210e3, nu=0.29)

PENALTY = 50.0
"""Of the contact, over E / mm."""

CAM = (INNER, INNER - 2.0)
"""Semi-axes (mm) of the ellipse whose two halves are moved apart: at first they touch at their tips
only."""

CAM_HALF_ANGLE = 60.0
"""Degrees from the major axis that the cam's halves cover."""


@dataclass(frozen=True)
class Problem:
    """force : N, dead, inwards on both ends of the major axis;  travel : mm, of each half of the
    cam outwards

    linear : CalculiX solves one linear step; the other program always solves with finite rotations
    """

    force: float = 0.0
    travel: float = 0.0
    linear: bool = False


PROBLEMS = {
    "linear: pinched ring": Problem(force=1e-3, linear=True),
    "finite rotation: pinched ring": Problem(force=100.0),
    "contact: ring on the halves of a cam": Problem(travel=1.0),
}

LEVELS = ((80, 1, 4), (160, 2, 8), (240, 3, 14), (320, 4, 20), (400, 5, 26))
"""Sectors of two elements around the ring, elements through the thickness and along the width."""


def sector(counts: tuple[int, int, int]) -> SectorMesh:
    """Mesh of a sector of the ring."""
    return ring_sector(INNER, OUTER, WIDTH, *counts, False)


def line(coords: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of the cross-section at x = 0, y > 0 among `coords` (n, 3), and their shares of a load
    spread over it."""
    nodes = np.flatnonzero((np.abs(coords[:, 0]) < 1e-9) & (coords[:, 1] > 0.0))
    share = np.ones(len(nodes))
    for values in (coords[nodes, 1], coords[nodes, 2]):
        share *= np.where((values < values.min() + 1e-9) | (values > values.max() - 1e-9), 0.5, 1.0)
    return nodes, share / share.sum()


def side(coords: np.ndarray) -> int:
    """The node of the outer surface at mid-width, a right angle from the major axis, at x > 0."""
    return int(np.argmin(np.linalg.norm(coords - (OUTER, 0.0, 0.0), axis=1)))
