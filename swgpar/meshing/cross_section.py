"""Mesh of the cross-section of one tooth and its rim (blocks: see `half_tooth.py`)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from swgpar.geometry.arrays import Floats, Ints
from swgpar.meshing.half_tooth import HalfTooth
from swgpar.meshing.mapped import QuadMesh, mapped_mesh
from swgpar.meshing.recipe import ToothRecipe
from swgpar.profiles.flank import ToothProfile

UNDER, ROOT, RIM = 3, 4, 5
"""Numbers of the blocks below the core and below the root, and of the first of the lower rim."""


@dataclass(frozen=True)
class CrossSection:
    """Plane mesh of a full tooth, symmetric about the +y axis.

    coords : (n_node, 2) mm;  quads : (n_quad, 4), counter-clockwise
    s : (n_s + 1,) mm, arc lengths of the flank's nodes, from T to R
    flank : (n_s + 1,) nodes of the flank at x > 0
    mirror : (n_node,) node at (-x, y)
    edge : (n_edge,) nodes on the sector's clockwise side, ordered by radius
    free : (n_angle + 1,) nodes on the free circle, from the clockwise to the counter-clockwise
        side
    below_root : (n_node,) bool nodes of the rim: on the interface circle or beyond
    root_layer, rim_layer : (n_quad,) bool quadrilaterals between root and interface circle, and of
        the lower rim
    housing : (n_quad,) bool quadrilaterals of the rim that belong to a housing
    """

    coords: Floats
    quads: Ints
    s: Floats
    flank: Ints
    mirror: Ints
    edge: Ints
    free: Ints
    below_root: NDArray[np.bool_]
    root_layer: NDArray[np.bool_]
    rim_layer: NDArray[np.bool_]
    housing: NDArray[np.bool_]


def cross_section(
    profile: ToothProfile, recipe: ToothRecipe, interface: float, free: float
) -> CrossSection:
    """Mesh the cross-section of one tooth and its rim; parameters as for `HalfTooth`."""
    half = HalfTooth(profile, recipe, interface, free)
    mesh = mapped_mesh(half.blocks(), scale=half.half_pitch * profile.r_tip_circle)
    flank_points = profile.point(half.s)
    _, flank = scipy.spatial.cKDTree(mesh.coords).query(flank_points)
    mesh.coords[flank] = flank_points
    edge = np.flatnonzero(
        np.abs(np.arctan2(*mesh.coords.T) - half.half_pitch) < 1e-9 * half.half_pitch
    )
    full, mirror = mirrored(mesh)
    radius = np.hypot(*full.coords.T)
    rim_layer, root_layer = full.block >= RIM, (full.block == UNDER) | (full.block == ROOT)
    below_root = np.zeros(len(full.coords), dtype=bool)
    below_root[full.quads[rim_layer]] = True
    on_free = np.flatnonzero(np.abs(radius - free) < 1e-9 * free)
    on_free = on_free[np.argsort(-full.coords[on_free, 0])]
    edge = edge[np.argsort(radius[edge])]
    return CrossSection(
        coords=full.coords,
        quads=full.quads,
        s=half.s,
        flank=flank.astype(np.int32),
        mirror=mirror,
        edge=edge.astype(np.int32),
        free=on_free.astype(np.int32),
        below_root=below_root,
        root_layer=root_layer,
        rim_layer=rim_layer,
        housing=np.zeros(len(full.quads), dtype=bool),
    )


def mirrored(half: QuadMesh) -> tuple[QuadMesh, Ints]:
    """Complete the half x >= 0 by its mirror image.

    Returns it and the node (n_node,) at (-x, y); the nodes on the axis are their own.
    """
    coords = half.coords.copy()
    tolerance = 1e-9 * np.abs(coords).max()
    axis = np.abs(coords[:, 0]) < tolerance
    coords[axis, 0] = 0.0
    n = len(coords)
    image = np.arange(n, dtype=np.int32)
    image[~axis] = n + np.arange(np.count_nonzero(~axis))
    mirror = np.concatenate((image, np.flatnonzero(~axis))).astype(np.int32)
    quads = np.concatenate((half.quads, image[half.quads[:, ::-1]]))
    return QuadMesh(
        np.concatenate((coords, coords[~axis] * (-1.0, 1.0))), quads, np.tile(half.block, 2)
    ), mirror
