"""Hertz's line contact: a cylinder pressed on a flat block, both elastic, by the flank contact on
meshes of blocks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from support.contact_blocks import Block, Blocks, Surface, arc_block
from support.element_mesh import ElementMesh
from swgpar.materials import Isotropic, Material

STEEL = Isotropic(E=210e3, nu=0.3)

HALF_WIDTH = 0.2
"""mm, that the approach is made for."""

RADIUS = 4000.0 * HALF_WIDTH
"""mm. Strains are 1e-4."""

SIZE = 24.0
"""mm, height and half the length of the blocks: many half widths, and some of the longest
elements."""

WIDTH = np.array([0.0, 1.0])
"""mm, places of the nodes along the line: plane strain."""


def graded(element: float, fine: float, length: float, growth: float) -> np.ndarray:
    """Nodes of [0, length]: elements of this length up to `fine`, then ever longer ones."""
    steps = [element] * int(np.ceil(fine / element))
    while sum(steps) < length:
        steps.append(steps[-1] * growth)
    return np.concatenate([[0.0], np.cumsum(steps) * length / sum(steps)])


def plane_modulus(material: Material) -> float:
    """E / (1 - nu²), MPa."""
    return material.modulus / (1.0 - material.poisson**2)


@cache
def centre_yields(material: Material) -> float:
    """Displacement (mm) of the middle of the contact towards the far side of a block under Hertz's
    pressure of 1 N/mm on `HALF_WIDTH`: by linear elements, without a contact.

    Half of the block, by symmetry, with ten elements on the half width. On 20, and on elements that
    grow half as fast beyond, it is 0.1 % larger.
    """
    line = graded(0.1 * HALF_WIDTH, 1.5 * HALF_WIDTH, SIZE, 1.1)
    block = arc_block(line, line, WIDTH, Surface((0.0, 0.0), 0.0, -1, RADIUS), material)
    mesh = ElementMesh(block.points, block.hexes, material)
    load, fixed = np.zeros_like(block.points), np.zeros(block.points.shape, dtype=bool)
    fixed[:, 2] = True
    fixed[np.abs(block.points[:, 0]) < 1e-9, 0] = True
    fixed[np.abs(block.points[:, 1] - SIZE) < 1e-9] = True
    t, w = np.polynomial.legendre.leggauss(20)
    for k, (low, high) in enumerate(zip(line, line[1:])):
        x = 0.5 * (low + high) + 0.5 * (high - low) * t
        pressure = np.sqrt(np.maximum(1.0 - (x / HALF_WIDTH) ** 2, 0.0))
        pressure *= 2.0 / (np.pi * HALF_WIDTH)
        share = (x - low) / (high - low)
        for node, shape in ((k, 1.0 - share), (k + 1, share)):
            force = 0.5 * (high - low) * (w * pressure * shape).sum()
            load[block.nodes[node], 1] += 0.5 * force
    u = mesh.solve(fixed, np.zeros_like(load), load)
    return float(u[block.nodes[0, 0], 1])


@dataclass(frozen=True)
class Hertz:
    """What was found, and the half-plane solution for the load that was found (Johnson, Contact
    Mechanics, 4.2).

    materials : of the block and of the cylinder;  approach : mm, of the far sides;  load : N/mm
    unknowns : nodes of the mesh;  iterations : of Newton
    x, p, width (n,) : places (mm), pressures (MPa) and widths (mm) of the cells of a line
    """

    materials: tuple[Material, Material]
    approach: float
    load: float
    unknowns: int
    iterations: int
    x: np.ndarray
    p: np.ndarray
    width: np.ndarray

    @property
    def modulus(self) -> float:
        """E* in plane strain."""
        return 1.0 / sum(1.0 / plane_modulus(material) for material in self.materials)

    @property
    def peak(self) -> float:
        """p_0 = (P E* / (pi R))^(1/2)"""
        return float(np.sqrt(self.load * self.modulus / (np.pi * RADIUS)))

    @property
    def half_width(self) -> float:
        """b = (4 P R / (pi E*))^(1/2)"""
        return float(np.sqrt(4.0 * self.load * RADIUS / (np.pi * self.modulus)))

    @property
    def found_half_width(self) -> float:
        """From the second moment of the pressure: that of a semi-ellipse is b² / 4."""
        force = self.p * self.width
        middle = (force * self.x).sum() / force.sum()
        moment = (force * ((self.x - middle) ** 2 + self.width**2 / 12.0)).sum()
        return 2.0 * float(np.sqrt(moment / force.sum()))

    @property
    def exact_approach(self) -> float:
        """mm, for the load that was found: the logarithm of the half width tells it from that of
        `centre_yields`."""
        return self.load * sum(
            centre_yields(material)
            + 2.0 / (np.pi * plane_modulus(material)) * np.log(HALF_WIDTH / self.half_width)
            for material in self.materials
        )

    @property
    def deviation(self) -> float:
        """Largest deviation of the pressure within 0.9 half widths, over the peak pressure."""
        middle = (self.p * self.width * self.x).sum() / (self.p * self.width).sum()
        place = (self.x - middle) / self.half_width
        exact = self.peak * np.sqrt(np.maximum(1.0 - place**2, 0.0))
        return float(np.abs(self.p - exact)[np.abs(place) < 0.9].max() / self.peak)


def flank_line(element: float) -> np.ndarray:
    """Nodes of a contact surface, equal elements of about this length on -SIZE .. SIZE."""
    count = round(2.0 * SIZE / element)
    return np.linspace(-SIZE, SIZE, count + 1)


def hertz(
    ratio: float,
    place: float = 0.0,
    *,
    materials: tuple[Material, Material] = (STEEL, STEEL),
    other: float = 1.125,
    incompatible: bool = True,
) -> Hertz:
    """Press the cylinder on the block.

    ratio : length of the cylinder's elements over the half width;  place : of the contact's middle
    in an element, 0 at a node
    other : length of the block's elements over that of the cylinder's, so that meshes do not match
    """
    element = ratio * HALF_WIDTH
    blocks = cylinder_on_block(element, place, materials, other, incompatible)
    exact = Hertz(materials, 0.0, 0.0, 0, 0, *np.zeros((3, 0)))
    load = 0.25 * np.pi * exact.modulus * HALF_WIDTH**2 / RADIUS
    approach = load * sum(centre_yields(material) for material in materials)
    u = np.zeros_like(blocks.points)
    u[blocks.first :, 1] = -approach
    pressed = blocks.press(u, np.zeros_like(u))
    line = pressed.line == pressed.line[0]
    return Hertz(
        materials,
        approach,
        -float(pressed.contact[blocks.first :, 1].sum()),
        len(u),
        blocks.iterations,
        pressed.x[line],
        pressed.pressure[line],
        pressed.width[line],
    )


def cylinder_on_block(
    element: float,
    place: float,
    materials: tuple[Material, Material],
    other: float,
    incompatible: bool,
) -> Blocks:
    """Both bodies with their far sides held."""
    bodies: list[Block] = []
    for length, facing, radius, material in (
        (other * element, 1, np.inf, materials[0]),
        (element, -1, RADIUS, materials[1]),
    ):
        line, depth = flank_line(length), graded(length, 4.0 * length, SIZE, 1.2)
        step = line[1] - line[0]
        # the middle of the line is a node or the middle of an element
        shift = (0.5 * step if len(line) % 2 == 0 else 0.0) + (place * step if facing < 0 else 0.0)
        line = line + shift
        bodies.append(
            arc_block(line, depth, WIDTH, Surface((0.0, 0.0), line[0], facing, radius), material)
        )
    lower, upper = bodies
    points = np.vstack([lower.points, upper.points])
    fixed = np.zeros(points.shape, dtype=bool)
    fixed[:, 2] = True
    fixed[np.abs(np.abs(points[:, 1]) - SIZE) < 1e-9] = True
    return Blocks(lower, upper, fixed, incompatible=incompatible)
