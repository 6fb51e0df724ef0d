"""What the elements under a flank lack in compliance: the half plane's surface displacement minus
that of the elements, for forces on strips narrower than an element.

Elements of a tooth are longer than a contact is wide. They see a force on a strip as nodal forces,
and between nodes their surface is straight, so that their approach depends on their size, like a
logarithm, and on the place in the element. The difference from the half plane is a property of the
discretisation:

    D(x, x') = T(x - x') - sum_ab N_a(x) G_ab N_b(x'),

T of the half plane, N the shape functions of the flank's nodes. G_ab is the displacement of node a
under a unit force at node b: of the half plane at nodes farther apart than `PATCH` facets, nearer
by of the elements themselves, on a patch of the element columns around node b with the half plane's
displacement on its boundary. So the far field and the constant of the logarithm cancel. Beyond the
ends of the flank the forces have images, without which the half plane would carry on there what the
elements do not: a uniform pressure lacks nothing then, but for the error of the patches. Where that
error would make D lose its sign, a smooth compliance of `SOFTEST` of an element's own is added.

Displacements count into the body, per unit force on a line of unit length: mm / (N/mm). The half
plane is that of a point force on its surface (Johnson, Contact Mechanics, 2.18, 2.19), written for
the in-plane modulus E' and ratio n' (plane strain: E / (1 - nu²) and nu / (1 - nu)).
"""

from __future__ import annotations

import numpy as np

from swgpar.kernel import add_line_compliances, reference_elements
from swgpar.meshing.sector import FlankGrid, SectorMesh
from swgpar.meshing.sweep import grid_quads

PATCH = 3
"""Facets of a patch on each side of the loaded node, and elements in depth."""

SOFTEST = 0.015
"""Least compliance under a uniform pressure, over the length of a facet and the modulus."""

SAMPLED = 8
"""Cells of a facet on which the compliance under a uniform pressure is measured."""


class MissingCompliance:
    """Missing compliance of one flank of a body.

    Parameters
    ----------
    mesh, grid : sector and its flank
    elasticity : (3, 3) MPa, stresses xx, yy, xy by strains in the section
    incompatible : whether the elements have incompatible modes

    Attributes
    ----------
    s : (n,) mm, arc lengths of the flank's nodes
    green : (n, n) mm / (N/mm), G of the nodes with the images of the forces, symmetrised
    modulus : MPa, E'
    logarithm : mm / (N/mm), the half plane's surface yields -logarithm ln|x|, x in mm
    """

    def __init__(
        self,
        mesh: SectorMesh,
        grid: FlankGrid,
        elasticity: np.ndarray,
        incompatible: bool = True,
    ) -> None:
        compliance = np.linalg.inv(elasticity)
        self.modulus = 1.0 / compliance[0, 0]
        self._ratio = -compliance[0, 1] / compliance[0, 0]
        self._incompatible = incompatible
        self.logarithm = 2.0 / (np.pi * self.modulus)
        self.s = np.ascontiguousarray(grid.s)
        n = len(self.s)
        places = np.pad(self.s, PATCH, mode="reflect", reflect_type="odd")
        columns = _columns(mesh, grid)
        node, image = np.arange(n), np.arange(-PATCH, PATCH + 1)
        self.green = np.zeros((n, n))
        for b in range(n):
            around = columns[max(b - 1, 0) : b + 1].mean(axis=0)
            near = self._near(places[b : b + 2 * PATCH + 1], around, elasticity)
            # the node itself and its images beyond both ends
            for at, index in (
                (self.s, node),
                (2.0 * self.s[0] - self.s, -node),
                (2.0 * self.s[-1] - self.s, 2 * (n - 1) - node),
            ):
                apart = index - b
                distance = np.where(apart == 0, 1.0, np.abs(at - self.s[b]))
                far = -self.logarithm * np.log(distance)
                self.green[:, b] += np.where(
                    np.abs(apart) <= PATCH, np.interp(apart, image, near), far
                )
        self.green = 0.5 * (self.green + self.green.T)
        self._soften()

    def _soften(self) -> None:
        """Give the compliance under a uniform pressure its least value."""
        n = len(self.s)
        parts = np.linspace(self.s[:-1], self.s[1:], SAMPLED + 1, axis=1)
        low, high = parts[:, :-1].ravel(), parts[:, 1:].ravel()
        values = np.zeros(len(low) ** 2)
        self.add(np.array([0, len(low)]), low, high, values)
        width, length = high - low, np.diff(self.s)
        uniform = (values.reshape(len(low), -1) @ width).reshape(n - 1, SAMPLED)
        for _ in range(n):
            lacks = SOFTEST * length / self.modulus - uniform.min(axis=1)
            facet = int(lacks.argmax())
            if not lacks[facet] > 0.0:
                break
            hat = np.maximum(0.0, 1.0 - np.abs(np.arange(n) - facet - 0.5) / (PATCH + 1))
            on_cells = np.interp(0.5 * (low + high), self.s, hat)
            force = on_cells @ width
            at_facet = on_cells.reshape(uniform.shape)[facet].min()
            amount = lacks[facet] / (at_facet * force)
            self.green -= amount * np.outer(hat, hat)
            uniform += amount * force * on_cells.reshape(uniform.shape)

    def _near(self, s: np.ndarray, column: np.ndarray, elasticity: np.ndarray) -> np.ndarray:
        """Displacements (2 PATCH + 1,) of the surface nodes of a patch under a unit force at the
        middle one.

        s : (2 PATCH + 1,) mm, places of the nodes;  column : (PATCH, 2) mm, from each to the nodes
        below it
        """
        x = np.zeros((len(s), PATCH + 1, 2))
        x[:, 0, 0] = s - s[PATCH]
        x[:, 1:] = column
        x[:, 1:, 0] += x[:, :1, 0]
        number = np.arange(x.shape[0] * x.shape[1]).reshape(x.shape[:2])
        quads = grid_quads(number)
        points = np.column_stack([x.reshape(-1, 2), np.zeros(number.size)])
        stiffness = reference_elements(points[quads], elasticity, 1.0, self._incompatible).stiffness
        dofs = (2 * quads[:, :, None] + np.arange(2)).reshape(len(quads), 8)
        in_plane = np.flatnonzero(np.tile([True, True, False], 4))
        k = np.zeros((2 * number.size, 2 * number.size))
        for nodes, block in zip(dofs, stiffness[:, in_plane][:, :, in_plane]):
            k[np.ix_(nodes, nodes)] += block
        boundary = np.ones(number.shape, dtype=bool)
        boundary[1:-1, :-1] = False
        given = np.flatnonzero(np.repeat(boundary.ravel(), 2))
        free = np.flatnonzero(np.repeat(~boundary.ravel(), 2))
        u, force = np.zeros((2, len(k)))
        u[given] = self._half_plane(*points[boundary.ravel(), :2].T)
        force[2 * number[PATCH, 0] + 1] = 1.0
        right = (force - k[:, given] @ u[given])[free]
        u[free] = np.linalg.solve(k[np.ix_(free, free)], right)
        return u[2 * number[:, 0] + 1]

    def _half_plane(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Displacements (2 n,), x and y of each point in turn, of the half plane under a unit force
        at the origin; x, y : (n,) mm along the surface and into the body."""
        r, angle = np.hypot(x, y), np.arctan2(x, y)
        k, n = 1.0 / (np.pi * self.modulus), self._ratio
        sine, cosine, log = np.sin(angle), np.cos(angle), 2.0 * np.log(r)
        radial = -k * (log * cosine + (1.0 - n) * angle * sine)
        around = k * (log * sine + (1.0 + n) * sine - (1.0 - n) * angle * cosine)
        # a translation makes the surface's displacement the logarithm alone
        into = radial * cosine - around * sine + k * (1.0 + n)
        return np.column_stack([radial * sine + around * cosine, into]).ravel()

    def add(self, start: np.ndarray, low: np.ndarray, high: np.ndarray, out: np.ndarray) -> None:
        """Add the missing compliance among the cells of lines: means over cells under unit forces
        spread over cells.

        start : (n_line + 1,) first cell of each line;  low, high : (n_cell,) mm, ends of the cells,
        each within a facet;  out : matrices (cells, cells), mm / (N/mm), one after the other
        """
        add_line_compliances(start, low, high, self, out)


def _columns(mesh: SectorMesh, grid: FlankGrid) -> np.ndarray:
    """The nodes below those of each facet of a flank, (n, PATCH, 2) mm along the flank and into the
    body, relative to the facet's nodes.

    They have the depths of the element column under the facet and the slant of the first of these
    elements. Where the tooth is thinner than the patch is deep, or a column no longer runs inwards,
    the last one is repeated.
    """
    nodes, x = grid.nodes[:, 0], mesh.coords[:, :2]
    at_edge: dict[frozenset[int], list[int]] = {}
    for k, quad in enumerate(mesh.elements[:, :4]):
        for a, b in zip(quad, np.roll(quad, -1)):
            at_edge.setdefault(frozenset((int(a), int(b))), []).append(k)
    out = np.zeros((len(nodes) - 1, PATCH, 2))
    for facet, column in enumerate(out):
        edge, above = [int(n) for n in nodes[facet : facet + 2]], -1
        middle = x[edge].mean(axis=0)
        along = np.diff(x[edge], axis=0)[0]
        along /= np.linalg.norm(along)
        depths: list[np.ndarray] = []
        while len(depths) < PATCH:
            below = [k for k in at_edge[frozenset(edge)] if k != above]
            if not below:
                break
            above = below[0]
            edge = _opposite([int(n) for n in mesh.elements[above, :4]], edge)
            depths.append(x[edge].mean(axis=0) - middle)
        into = depths[0] - along * (along @ depths[0])
        into /= np.linalg.norm(into)
        depth = np.array([d @ into for d in depths])
        # below a facet that is turned to the tip a column may run up again
        rises = np.append(np.diff(depth) > 0.0, False)
        depth = depth[: int(rises.argmin()) + 1]
        missing = PATCH - len(depth)
        last = np.diff(depth, prepend=0.0)[-1]
        depth = np.concatenate([depth, depth[-1] + last * np.arange(1, missing + 1)])
        column[:, 0], column[:, 1] = depth * (along @ depths[0]) / depth[0], depth
    return out


def _opposite(quad: list[int], edge: list[int]) -> list[int]:
    """The edge of a quadrilateral that faces `edge`, its nodes in the same order."""
    a, b = (quad.index(n) for n in edge)
    step = 1 if (a - b) % 4 == 1 else -1
    return [quad[(a + step) % 4], quad[(b - step) % 4]]
