"""Mapped quadrilateral meshes of plane blocks, by gmsh."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from types import ModuleType

import numpy as np

from swgpar.geometry.arrays import Floats, Ints
from swgpar.meshing.gmsh_session import gmsh_model


class MeshError(Exception):
    """Blocks that cannot be meshed: their sides do not fit, cross each other, or have points that
    coincide."""


@dataclass(frozen=True)
class QuadMesh:
    """A plane mesh of quadrilaterals.

    Attributes
    ----------
    coords : (n_node, 2) float64, mm
    quads : (n_quad, 4) int32
        Counter-clockwise.
    block : (n_quad,) int32
        Number of the block a quadrilateral lies in, in the order the blocks were added.
    """

    coords: Floats
    quads: Ints
    block: Ints


@dataclass
class MappedBlocks:
    """Four-sided blocks whose sides are chains of given nodes; gmsh fills in the interior nodes.

    Every given point becomes a node with exactly its coordinates: a side is passed to gmsh as
    straight curves of one element each. Points that coincide within `tolerance` are one node.

    Attributes
    ----------
    scale : float, mm
        Length that gmsh sees as 1, so that its absolute tolerances do not depend on the unit
        system.
    tolerance : float
        Coincidence of points, in units of `scale`.
    """

    scale: float
    tolerance: float = 1e-9
    points: list[tuple[float, float]] = field(default_factory=list)
    blocks: list[tuple[list[int], list[int], list[int], list[int]]] = field(default_factory=list)
    _index: dict[tuple[int, int], int] = field(default_factory=dict)

    def add_points(self, xy: Floats) -> list[int]:
        """Return the indices of the points `xy` (n, 2), mm; new ones are added."""
        indices = []
        for x, y in np.asarray(xy, dtype=np.float64):
            key = (round(x / self.scale / self.tolerance), round(y / self.scale / self.tolerance))
            # a coordinate that falls on the border of a rounding cell may end up in either of two
            # cells
            near = [(key[0] + i, key[1] + j) for i in (0, -1, 1) for j in (0, -1, 1)]
            hit = next((self._index[k] for k in near if k in self._index), None)
            if hit is None:
                hit = self._index[key] = len(self.points)
                self.points.append((float(x), float(y)))
            indices.append(hit)
        return indices

    def add_block(self, bottom: Floats, right: Floats, top: Floats, left: Floats) -> None:
        """Add a block: `bottom` and `top` (n, 2) run left to right, `left` and `right` (m, 2)
        upwards."""
        sides = [self.add_points(side) for side in (bottom, right, top, left)]
        b, r, t, lf = sides
        if (
            (b[-1], r[-1], t[0], lf[0]) != (r[0], t[-1], lf[-1], b[0])
            or len(b) != len(t)
            or len(r) != len(lf)
        ):
            raise MeshError("the sides of a block do not close or do not match")
        self.blocks.append((b, r, t, lf))

    def generate(self) -> tuple[QuadMesh, Ints]:
        """Mesh all blocks.

        Returns
        -------
        mesh : QuadMesh
        node : (n_point,) int32
            Node of each given point.

        Raises MeshError where gmsh cannot mesh the blocks.
        """
        with gmsh_model("tooth section") as gmsh:
            try:
                self._describe(gmsh)
                gmsh.model.mesh.generate(2)
                return self._collect(gmsh)
            except Exception as error:  # gmsh raises nothing more specific
                raise MeshError(str(error)) from error

    def _describe(self, gmsh: ModuleType) -> None:
        """Define points, lines and blocks in gmsh."""
        geo = gmsh.model.geo
        for k, (x, y) in enumerate(self.points):
            geo.addPoint(x / self.scale, y / self.scale, 0.0, tag=k + 1)
        lines: dict[tuple[int, int], int] = {}

        def chain(side: list[int]) -> list[int]:
            tags = []
            for a, b in pairwise(side):
                key = (min(a, b), max(a, b))
                if key not in lines:
                    lines[key] = geo.addLine(key[0] + 1, key[1] + 1)
                    geo.mesh.setTransfiniteCurve(lines[key], 2)
                tags.append(lines[key] if a == key[0] else -lines[key])
            return tags

        for k, (b, r, t, lf) in enumerate(self.blocks):
            loop = geo.addCurveLoop(chain(b) + chain(r) + chain(t[::-1]) + chain(lf[::-1]))
            surface = geo.addPlaneSurface([loop], tag=k + 1)
            geo.mesh.setTransfiniteSurface(
                surface, cornerTags=[b[0] + 1, b[-1] + 1, t[-1] + 1, t[0] + 1]
            )
            geo.mesh.setRecombine(2, surface)
        geo.synchronize()

    def _collect(self, gmsh: ModuleType) -> tuple[QuadMesh, Ints]:
        """Mesh and node of each given point, from gmsh."""
        mesh = gmsh.model.mesh
        tags, xyz, _ = mesh.getNodes()
        order = np.argsort(tags)
        tags = tags[order]
        coords = xyz.reshape(-1, 3)[order, :2] * self.scale
        quads, block = [], []
        for k in range(len(self.blocks)):
            _, nodes = mesh.getElementsByType(3, k + 1)
            cells = np.searchsorted(tags, nodes).reshape(-1, 4)
            expected = (len(self.blocks[k][0]) - 1) * (len(self.blocks[k][1]) - 1)
            if len(cells) != expected:
                raise MeshError(
                    f"gmsh made {len(cells)} quadrilaterals where {expected} were asked for"
                )
            quads.append(cells)
            block.append(np.full(len(cells), k))
        node = np.array([mesh.getNodes(0, k + 1)[0][0] for k in range(len(self.points))])
        node = np.searchsorted(tags, node)
        coords[node] = self.points  # exact: scaling and its inverse round the last digit
        quads = np.concatenate(quads)
        x, y = np.moveaxis(coords[quads], -1, 0)
        area = np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1)
        quads[area < 0.0] = quads[area < 0.0][:, ::-1]
        return QuadMesh(
            coords, quads.astype(np.int32), np.concatenate(block).astype(np.int32)
        ), node.astype(np.int32)
