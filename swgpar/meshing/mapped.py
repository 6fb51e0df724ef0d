"""Mapped quadrilateral meshes of plane blocks, by transfinite interpolation of their sides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from swgpar.geometry.arrays import Floats, Ints
from swgpar.meshing.sweep import grid_quads

Sides = tuple[Floats, Floats, Floats, Floats]
"""Nodes (n, 2), mm, on the bottom, right, top and left side of a block: from left to right, and
upwards."""


class MeshError(Exception):
    """Blocks that cannot be meshed: their sides do not fit, or have points that coincide."""


@dataclass(frozen=True)
class QuadMesh:
    """A plane mesh of quadrilaterals.

    coords : (n_node, 2) mm;  quads : (n_quad, 4), counter-clockwise
    block : (n_quad,) number of the block that a quadrilateral lies in
    """

    coords: Floats
    quads: Ints
    block: Ints


def _shares(side: Floats) -> Floats:
    """Lengths (n,) of a side from its first point to each of its points, over that of the side."""
    lengths = np.cumsum(np.linalg.norm(np.diff(side, axis=0), axis=1))
    return np.concatenate(([0.0], lengths / lengths[-1]))


def transfinite(bottom: Floats, right: Floats, top: Floats, left: Floats) -> Floats:
    """Points (n, m, 2) between sides of n and of m points: the bilinearly blended Coons patch, with
    the arc lengths of the bottom and the right side as its parameters."""
    u, v = _shares(bottom)[:, None, None], _shares(right)[None, :, None]
    between = (1.0 - v) * bottom[:, None] + v * top[:, None] + (1.0 - u) * left + u * right
    low, high = (1.0 - u) * bottom[0] + u * bottom[-1], (1.0 - u) * top[0] + u * top[-1]
    return between - (1.0 - v) * low - v * high


def mapped_mesh(blocks: Sequence[Sides], tolerance: float) -> QuadMesh:
    """Mesh all blocks. Points of sides are nodes; those that coincide within `tolerance`, mm, are
    one.

    Raises MeshError where sides do not close or do not match, or have points that coincide.
    """
    points = np.concatenate([side for sides in blocks for side in sides])
    near = cKDTree(points).query_ball_point(points, tolerance)
    kept, node = np.unique([min(same) for same in near], return_inverse=True)
    coords, quads = [points[kept]], []
    first, count = 0, len(kept)
    for sides in blocks:
        ends = first + np.cumsum([len(side) for side in sides])
        bottom, right, top, left = np.split(node[first : ends[-1]], ends[:-1] - first)
        first = ends[-1]
        corners = (bottom[0], bottom[-1], top[-1], top[0])
        fits = len(bottom) == len(top) and len(right) == len(left)
        if not fits or (left[0], right[0], right[-1], left[-1]) != corners:
            raise MeshError("the sides of a block do not close or do not match")
        if any((side[1:] == side[:-1]).any() for side in (bottom, right, top, left)):
            raise MeshError("points on a side of a block coincide")
        inside = transfinite(*sides)[1:-1, 1:-1]
        grid = np.empty((len(bottom), len(left)), dtype=np.int32)
        grid[:, 0], grid[-1], grid[:, -1], grid[0] = bottom, right, top, left
        grid[1:-1, 1:-1] = count + np.arange(inside[..., 0].size).reshape(inside.shape[:2])
        coords.append(inside.reshape(-1, 2))
        count += len(coords[-1])
        quads.append(grid_quads(grid))
    block = np.repeat(np.arange(len(quads), dtype=np.int32), [len(part) for part in quads])
    return _counter_clockwise(QuadMesh(np.concatenate(coords), np.concatenate(quads), block))


def _counter_clockwise(mesh: QuadMesh) -> QuadMesh:
    """The mesh with its quadrilaterals reversed where they run clockwise, as the blocks of an
    internal tooth do."""
    x, y = np.moveaxis(mesh.coords[mesh.quads], -1, 0)
    area = np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1))
    return mesh if area > 0.0 else QuadMesh(mesh.coords, mesh.quads[:, ::-1], mesh.block)
