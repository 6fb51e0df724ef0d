"""The rigid flange of a clamped or bolted end in a job of CalculiX.

It is a `*RIGID BODY` of nodes, each for a node of the attached area, at its place after a
growth without stress. Springs between both are the bedding of the program's own flange: k a along
x, y and z, with the area a of the node. Nodes need not lie on the rims of washers.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from swgpar.constraints.rigid_attachment import area_shares
from swgpar.exchange.calculix_model import JobModel
from swgpar.geometry.arrays import Floats, Ints
from swgpar.materials import NO_GROWTH

DIGITS = 9
"""Of areas over the largest one: springs of areas that agree in them share a section."""


class Flange:
    """The flange of a clamped or bolted end, and its bedding.

    model : the drive;  first_node, first_element : numbers from 1 from which it has its own

    Attributes:
    nodes : (n,) of the attached area, from 0;  stiffness : (n,) N/mm, of their springs
    growth : (n, 3) mm, displacements of the flange's nodes from them
    """

    def __init__(self, model: JobModel, first_node: int, first_element: int) -> None:
        self.model, self.first_node, self.first_element = model, first_node, first_element
        cup, mesh = model.design.cup, model.spline
        areas = np.zeros(len(model.points))
        angles = mesh.sector_angle(np.arange(mesh.n_sectors))
        numbers = model.numbers(mesh, np.arange(len(mesh.coords), dtype=np.int32))
        for angle, sector in zip(angles, numbers, strict=True):
            shares = area_shares(mesh, "end", angle, cup.is_attached, cup.attached_width)
            np.add.at(areas, sector, shares)
        self.nodes: Ints = np.flatnonzero(areas)
        self.stiffness: Floats = model.design.penalty("flexible_spline") * areas[self.nodes]
        points = model.points[self.nodes]
        self.middle = float(np.average(points[:, 2], weights=self.stiffness))
        growth = model.design.growths.get("flexible_spline", NO_GROWTH)
        self.growth: Floats = growth.of(points - [0.0, 0.0, self.middle])

    @property
    def next_element(self) -> int:
        """The number after those of its springs."""
        return self.first_element + self.growth.size

    def lines(self, reference: int) -> Iterator[str]:
        """Nodes, springs and rigid body. reference : its node, from 1, of the displacements; that
        of the rotations is the next one"""
        first, element = self.first_node, self.first_element
        yield "*NODE, NSET=FLANGE"
        for k, (x, y, z) in enumerate(self.model.points[self.nodes] + self.growth, start=first):
            yield f"{k}, {x:.12e}, {y:.12e}, {z:.12e}"
        _, group = np.unique(
            (self.stiffness / self.stiffness.max()).round(DIGITS), return_inverse=True
        )
        for one in range(int(group.max()) + 1):
            members = np.flatnonzero(group == one)
            for axis in (1, 2, 3):
                name = f"BEDDING_{one + 1}_{axis}"
                yield f"*ELEMENT, TYPE=SPRING2, ELSET={name}"
                for k in members:
                    yield f"{element}, {self.nodes[k] + 1}, {first + k}"
                    element += 1
                yield from (f"*SPRING, ELSET={name}", f"{axis}, {axis}")
                yield f"{self.stiffness[members[0]]:.12e}"
        yield f"*RIGID BODY, NSET=FLANGE, REF NODE={reference}, ROT NODE={reference + 1}"

    def forces(self) -> Iterator[str]:
        """Forces of springs that are free of stress at the growth; nothing without one."""
        if not self.growth.any():
            return
        forces = self.stiffness[:, None] * self.growth
        yield "*CLOAD"
        for k, (node, values) in enumerate(zip(self.nodes + 1, forces, strict=True)):
            for axis, force in enumerate(values, start=1):
                yield f"{node}, {axis}, {force:.12e}"
                yield f"{self.first_node + k}, {axis}, {-force:.12e}"
