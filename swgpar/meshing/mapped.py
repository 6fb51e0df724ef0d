"""Mapped quadrilateral meshes of plane blocks, by gmsh."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from types import ModuleType

import numpy as np
import scipy

from swgpar.geometry.arrays import Floats, Ints
from swgpar.meshing.gmsh_session import gmsh_model

Sides = tuple[Floats, Floats, Floats, Floats]
"""Nodes (n, 2), mm, on bottom, right, top and left side of a block: left to right, and upwards."""

Chains = tuple[list[int], list[int], list[int], list[int]]
"""Numbers of the nodes on the sides of a block, as in `Sides`."""

SAME = 1e-9
"""Distance of points, in units of the scale, up to which they are one node."""


class MeshError(Exception):
    """Blocks that cannot be meshed: sides that do not fit, cross, or have points that coincide."""


@dataclass(frozen=True)
class QuadMesh:
    """A plane mesh of quadrilaterals.

    coords : (n_node, 2) mm;  quads : (n_quad, 4), counter-clockwise
    block : (n_quad,) number of the block a quadrilateral lies in, in their order
    """

    coords: Floats
    quads: Ints
    block: Ints


def mapped_mesh(blocks: Sequence[Sides], scale: float) -> QuadMesh:
    """Mesh blocks whose sides are chains of given nodes; gmsh fills in the interior nodes.

    Every given point becomes a node with exactly its coordinates: a side is passed to gmsh as
    straight curves of one element each. Raises MeshError where the blocks cannot be meshed.

    scale : mm, length that gmsh sees as 1, so that its absolute tolerances do not depend on units
    """
    sides = [side for block in blocks for side in block]
    given = np.concatenate(sides)
    near = scipy.spatial.cKDTree(given).query_ball_point(given, SAME * scale)
    first, number = np.unique([min(same) for same in near], return_inverse=True)
    ends = np.cumsum([len(side) for side in sides])
    chains = [part.tolist() for part in np.split(number, ends[:-1])]
    numbered = [tuple(chains[k : k + 4]) for k in range(0, len(chains), 4)]
    for bottom, right, top, left in numbered:
        corners = (bottom[0], bottom[-1], top[-1], top[0])
        if (
            (left[0], right[0], right[-1], left[-1]) != corners
            or len(bottom) != len(top)
            or len(left) != len(right)
        ):
            raise MeshError("the sides of a block do not close or do not match")
    with gmsh_model("tooth section") as gmsh:
        try:
            _describe(gmsh, given[first] / scale, numbered)
            gmsh.model.mesh.generate(2)
            return _collect(gmsh, given[first], scale, numbered)
        except Exception as error:  # gmsh raises nothing more specific
            raise MeshError(str(error)) from error


def _describe(gmsh: ModuleType, points: Floats, blocks: Sequence[Chains]) -> None:
    """Define points, lines and blocks in gmsh."""
    geo = gmsh.model.geo
    for tag, (x, y) in enumerate(points.tolist(), 1):
        geo.addPoint(x, y, 0.0, tag=tag)
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

    for tag, (bottom, right, top, left) in enumerate(blocks, 1):
        loop = chain(bottom) + chain(right) + chain(top[::-1]) + chain(left[::-1])
        surface = geo.addPlaneSurface([geo.addCurveLoop(loop)], tag=tag)
        corners = [bottom[0] + 1, bottom[-1] + 1, top[-1] + 1, top[0] + 1]
        geo.mesh.setTransfiniteSurface(surface, cornerTags=corners)
        geo.mesh.setRecombine(2, surface)
    geo.synchronize()


def _collect(gmsh: ModuleType, points: Floats, scale: float, blocks: Sequence[Chains]) -> QuadMesh:
    """The mesh from gmsh."""
    mesh = gmsh.model.mesh
    tags, xyz, _ = mesh.getNodes()
    order = np.argsort(tags)
    tags, coords = tags[order], xyz.reshape(-1, 3)[order, :2] * scale
    cells = []
    for tag, (bottom, right, *_) in enumerate(blocks, 1):
        cells.append(np.searchsorted(tags, mesh.getElementsByType(3, tag)[1]).reshape(-1, 4))
        if len(cells[-1]) != (len(bottom) - 1) * (len(right) - 1):
            raise MeshError("gmsh made other quadrilaterals than were asked for")
    at_points = [mesh.getNodes(0, tag)[0][0] for tag in range(1, len(points) + 1)]
    # exact: scaling and its inverse round the last digit
    coords[np.searchsorted(tags, at_points)] = points
    quads = np.concatenate(cells)
    x, y = np.moveaxis(coords[quads], -1, 0)
    area = np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1)
    quads[area < 0.0] = quads[area < 0.0][:, ::-1]
    block = np.repeat(np.arange(len(cells)), [len(part) for part in cells])
    return QuadMesh(coords, quads.astype(np.int32), block.astype(np.int32))
