"""A crowned cylinder of steel pressed by the flank contact on a block that hardly yields: Hertz's
ellipse, which is half as long as the face is wide or shorter."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.special import ellipe, ellipk

from support.contact_blocks import Blocks, Surface, arc_block
from support.hertz import STEEL, graded, plane_modulus
from swgpar.contact.flank_faces import flank_faces
from swgpar.geometry.micro_geometry import FlankCrowning
from swgpar.materials import Isotropic

HARD = Isotropic(E=100.0 * STEEL.modulus, nu=0.3)
MODULUS = 1.0 / sum(1.0 / plane_modulus(material) for material in (STEEL, HARD))
"""E*, MPa"""

RADIUS, HALF_WIDTH, HALF_LENGTH = 20.0, 0.044, 1.05
"""mm, of the cylinder, and of the ellipse that the approach is made for."""

ELEMENT, SIZE, WIDTH = 0.2, 5.0, 10.0
"""mm: elements at the contact, half the length and the height of the cylinder's block, its
width."""


@dataclass(frozen=True)
class Ellipse:
    """Hertz's contact of `RADIUS` along and `crown` (mm) across with these half axes (Johnson,
    Contact Mechanics, 4.2); peak : MPa"""

    half_width: float
    half_length: float

    @property
    def _excentricity(self) -> float:
        return 1.0 - (self.half_width / self.half_length) ** 2

    @property
    def peak(self) -> float:
        a, c, m = self.half_width, self.half_length, self._excentricity
        return float(
            MODULUS / (2.0 * RADIUS) * c**2 * m / (a * (ellipe(m) * (c / a) ** 2 - ellipk(m)))
        )

    @property
    def crown(self) -> float:
        m, a = self._excentricity, self.half_width
        curvature = 2.0 * self.peak / MODULUS * a / (m * self.half_length**2)
        return float(1.0 / (curvature * (ellipk(m) - ellipe(m))))

    @property
    def approach(self) -> float:
        return float(self.peak / MODULUS * self.half_width * ellipk(self._excentricity))

    @property
    def force(self) -> float:
        return float(2.0 / 3.0 * np.pi * self.half_width * self.half_length * self.peak)


@dataclass(frozen=True)
class PressedCrown:
    """Cylinder on the block.

    s : (n_s,) mm, places of its nodes along the profile from the least gap, z (n_z,) mm across
    into (n_s, n_z) mm, force (n_s, n_z) N : displacement of the nodes of its surface into it, and
    their forces;  blocks : after the solve
    """

    s: np.ndarray
    z: np.ndarray
    into: np.ndarray
    force: np.ndarray
    blocks: Blocks

    @property
    def exact(self) -> Ellipse:
        """The contact under the force that was found: lengths go with its third root."""
        made = Ellipse(HALF_WIDTH, HALF_LENGTH)
        size = float(self.force.sum() / made.force) ** (1.0 / 3.0)
        return Ellipse(size * HALF_WIDTH, size * HALF_LENGTH)

    def gap(self, s: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Of both bodies undeformed, mm."""
        return s**2 / (2.0 * RADIUS) + z**2 / (2.0 * Ellipse(HALF_WIDTH, HALF_LENGTH).crown)


@cache
def pressed_crown(layers: int, place: float, element: float = ELEMENT) -> PressedCrown:
    """The cylinder pressed by the approach of the ellipse.

    layers : of elements over the width;  place : of the least gap, in layers from a station
    """
    made = Ellipse(HALF_WIDTH, HALF_LENGTH)
    z = np.linspace(-0.5 * WIDTH, 0.5 * WIDTH, layers + 1)
    z = z - z[layers // 2] - place * (z[1] - z[0])
    half = graded(element, 0.8, SIZE, 1.4)
    s = np.concatenate([-half[:0:-1], half]) + 0.25 * element
    upper = arc_block(s, half, z, Surface((0.0, 0.0), float(s[0]), -1, RADIUS), STEEL)
    below = Surface((0.0, 0.0), float(s[0] + 0.5 * element), 1)
    lower = arc_block(s + 0.5 * element, np.array([0.0, 0.5, 1.0]), z, below, HARD)
    points = np.vstack([lower.points, upper.points])
    fixed = np.zeros(points.shape, dtype=bool)
    fixed[np.isclose(points[:, 1], SIZE) | np.isclose(points[:, 1], -1.0)] = True
    blocks = Blocks(lower, upper, fixed, reach=0.5)
    width = 2.0 * WIDTH
    blocks.flanks.slaves = {
        grid.side: flank_faces(
            upper.mesh, grid, FlankCrowning(width**2 / (8.0 * made.crown), width)
        )
        for grid in upper.mesh.flanks
    }
    u = np.zeros_like(blocks.points)
    u[blocks.first :, 1] = -made.approach
    pressed = blocks.press(u, np.zeros_like(u))
    nodes = upper.nodes + blocks.first
    along = points[nodes[:, 0], 0]
    return PressedCrown(along, z, u[nodes, 1], -pressed.contact[nodes, 1], blocks)
