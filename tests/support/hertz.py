"""Hertz's line contact: a cylinder pressed on a flat block, both elastic, by the flank contact on
meshes of blocks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from support.contact_blocks import Blocks, block, master
from swgpar.contact.flank_pairs import PlacedFaces
from swgpar.contact.segments import SAMPLES, face_corners
from swgpar.materials import Isotropic

YOUNG = 210e3
POISSON = 0.3
RADIUS = 1000.0
SIZE = 50.0
"""MPa, of both bodies; mm, radius, height and width of the blocks. The half width is about 1 mm:
strains are 5e-4."""

APPROACH, FINE, GROWTH = 2.2e-3, 1.3, 0.8
"""mm, of the far sides; half widths with equal elements; logarithm of the growth beyond, times
elements on one."""

STIFFNESS, AUGMENTATIONS = 2.0, 2
"""Penalty over E and the elements' size, as of the flanks on fine meshes. It leaves a penetration
of a few per cent of the cylinder's height over the contact, before that is augmented away."""


@dataclass(frozen=True)
class Hertz:
    """What was found, and the half-plane solution for the load that was found (Johnson, Contact
    Mechanics, 4.2).

    unknowns : of the mesh in the plane;  x, p (n,) : places and pressures of the cylinder's surface
    nodes, mm, MPa
    load : N/mm;  found_half_width : mm, from the second moment of the pressure
    """

    unknowns: int
    x: np.ndarray
    p: np.ndarray
    load: float
    found_half_width: float

    @property
    def modulus(self) -> float:
        """E* of two bodies of one material, in plane strain."""
        return YOUNG / (2.0 * (1.0 - POISSON**2))

    @property
    def peak(self) -> float:
        """p_0 = (P E* / (pi R))^(1/2)"""
        return float(np.sqrt(self.load * self.modulus / (np.pi * RADIUS)))

    @property
    def half_width(self) -> float:
        """b = (4 P R / (pi E*))^(1/2)"""
        return float(np.sqrt(4.0 * self.load * RADIUS / (np.pi * self.modulus)))

    @property
    def deviation(self) -> float:
        """Largest deviation of the nodal pressures within 0.9 half widths, over the peak
        pressure."""
        exact = self.peak * np.sqrt(np.maximum(1.0 - (self.x / self.half_width) ** 2, 0.0))
        return float(np.abs(self.p - exact)[self.x < 0.9 * self.half_width].max() / self.peak)


def spacing(fine: float, length: float, growth: float) -> np.ndarray:
    """Nodes of [0, length]: elements of size `fine` up to FINE, then ever longer ones."""
    steps = [fine] * int(np.ceil(FINE / fine))
    while sum(steps) < length:
        steps.append(steps[-1] * growth)
    return np.concatenate([[0.0], np.cumsum(steps) * length / sum(steps)])


def hertz(on_half_width: int, order: int = 2, incompatible: bool = True) -> Hertz:
    """Half of the problem, by symmetry, in plane strain.

    on_half_width : elements of the cylinder on a half width; the block has a ninth fewer, so that
    meshes do not match
    order : Gauss points per direction on a segment
    """
    growth, z = float(np.exp(GROWTH / on_half_width)), np.array([0.0, 1.0])
    fine, line = (spacing(size / on_half_width, SIZE, growth) for size in (1.0, 1.125))
    lower, lower_hexes, lower_grid = block(line, -line[::-1], z)
    upper, upper_hexes, upper_grid = block(fine, fine, z)
    upper[:, 1] += (RADIUS - np.sqrt(RADIUS**2 - upper[:, 0] ** 2)) * (1.0 - upper[:, 1] / SIZE)
    points, first = np.vstack([lower, upper]), len(lower)
    hexes = np.vstack([lower_hexes, upper_hexes + first])
    # the nodes of both surfaces come first
    surface = np.concatenate([lower_grid[:, -1].ravel(), first + upper_grid[:, 0].ravel()])
    order_of = np.concatenate([surface, np.setdiff1d(np.arange(len(points)), surface)])
    number = np.argsort(order_of)
    points, hexes = points[order_of], number[hexes]
    flanks = master(
        np.column_stack([line, 0.0 * line]), np.tile([1.0, 0.0], (len(line), 1)), line, z, 0
    )
    flanks.conn[0] = number[lower_grid[:, -1]]
    placed = cylinder_faces(points, face_corners(number[first + upper_grid[:, 0]]).astype(np.int32))
    fixed = np.zeros(points.shape, dtype=bool)
    fixed[:, 2] = True
    fixed[points[:, 0] < 1e-12, 0] = True
    fixed[np.abs(points[:, 1]) > SIZE - 1e-12, 1] = True
    u = np.zeros_like(points)
    u[number[first + upper_grid.ravel()], 1] = -APPROACH
    penalty = STIFFNESS * YOUNG * on_half_width
    blocks = Blocks(
        points,
        hexes,
        len(surface),
        flanks,
        placed,
        fixed,
        Isotropic(E=YOUNG, nu=POISSON),
        penalty,
        order,
    )
    blocks.incompatible = incompatible
    faces, pressure, contact = blocks.press(u, np.zeros_like(points), AUGMENTATIONS)
    # pressure as it is reported: by nodes, force over area
    force, area = np.zeros(len(points)), np.zeros(len(points))
    np.add.at(force, faces.conn, np.einsum("fq,fqa->fa", faces.weight * pressure, faces.shape))
    np.add.at(area, faces.conn, np.einsum("fq,fqa->fa", faces.weight, faces.shape))
    nodes = number[first + upper_grid[:, 0, 0]]
    place = np.einsum("fqa,fa->fq", faces.shape, points[faces.conn][..., 0])
    weight = faces.weight * pressure
    # a semi-ellipse of half width b has the second moment b^2 / 4
    half_width = 2.0 * float(np.sqrt((weight * place**2).sum() / weight.sum()))
    load = -2.0 * float(contact[number[first + upper_grid[:, 0]], 1].sum())
    return Hertz(
        len(points), points[nodes, 0] + u[nodes, 0], force[nodes] / area[nodes], load, half_width
    )


def cylinder_faces(points: np.ndarray, conn: np.ndarray) -> PlacedFaces:
    """Faces (n, 4) of the cylinder, with the height of their chords over the arc, whose centre is
    at height RADIUS."""
    chord = points[conn[:, 1]] - points[conn[:, 0]]
    length = np.linalg.norm(chord, axis=1)
    normal = np.column_stack([chord[:, 1], -chord[:, 0], 0.0 * length]) / length[:, None]
    on_chord = points[conn[:, 0], None] + SAMPLES[:, None] * chord[:, None]
    below = RADIUS - np.hypot(on_chord[..., 0], RADIUS - on_chord[..., 1])
    return PlacedFaces(
        conn,
        np.zeros_like(conn, dtype=np.uint8),
        points[conn],
        normal,
        np.column_stack([length, np.ones(len(length))]),
        np.repeat(below[:, :, None], len(SAMPLES), axis=2),
        np.zeros(len(conn), np.int32),
    )
