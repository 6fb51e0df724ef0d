"""Regions that a window resolves.

A window reaches from its teeth into the wall behind them. Near its cuts, at the contact of flanks,
near the edge of the wave generator and near a corner without a radius its stresses mean nothing.
"""

from __future__ import annotations

import numpy as np

from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.largest_stress.places import inside_teeth
from swgpar.meshing.drive_geometry import CupGeometry, DriveGeometry
from swgpar.meshing.sector import SectorMesh
from swgpar.model.regions import (
    BACK,
    BESIDE,
    CUP_WALL,
    END,
    FLANK,
    RIM,
    RIM_INSIDE,
    TIP,
    TOOTH_END,
    TOOTH_ROOT,
    at_the_cam_edge,
)

OF_SPLINE = (TOOTH_ROOT, TOOTH_END, FLANK, TIP, RIM_INSIDE, BACK, CUP_WALL)
OF_RING = (TOOTH_ROOT, TOOTH_END, FLANK, TIP, RIM)
"""Regions that windows of the gears resolve. The outer surface of a ring gear is held in them."""

BEHIND = 1.5
"""Distance from the back of the teeth over the thickness of the wall as far as which rings of the
wall do not resolve it, and that from the cut of a window from which it does."""


TOOTHED = 0.5 + 1e-9
"""Share of the face width on either side of its middle to which the toothed part reaches."""


def wall_start(geometry: DriveGeometry, cup: CupGeometry) -> float:
    """Distance (mm) from the back of the teeth at which rings begin: behind its fillet, and where
    no cam touches."""
    return max(cup.back_fillet, 0.5 * (geometry.cam_width - geometry.face_width))


def read_regions(
    geometry: DriveGeometry, mesh: SectorMesh, length: float, every: np.ndarray
) -> np.ndarray:
    """Region (n_node,) of the nodes of a window's sector, empty where nothing is read.

    length : mm, of the wall behind the teeth that belongs to the window
    every : (n_node,) regions of all nodes where no contact presses
    """
    wanted = OF_SPLINE if mesh.body == FLEXIBLE_SPLINE else OF_RING
    regions = np.full(len(mesh.coords), "", dtype=object)
    read = np.zeros(len(mesh.coords), dtype=bool)
    read[mesh.nodes_of(0)] = True  # the housing of a ring gear is another body
    read[mesh.node_sets.get("outer", [])] = False
    read &= ~inside_teeth(geometry, mesh) & ~_beside_edges(geometry, mesh, length)
    if mesh.lower_nodes is not None:
        read &= mesh.lower_nodes == np.arange(len(read))
    read &= np.isin(every, wanted)
    regions[read] = every[read]
    return regions


def _beside_edges(geometry: DriveGeometry, mesh: SectorMesh, length: float) -> np.ndarray:
    """Nodes (n_node,) bool near a cut of the wall, a corner without a radius, or the edge of the
    wave generator."""
    radius, z = np.hypot(*mesh.coords[:, :2].T), mesh.coords[:, 2]
    if mesh.plane or mesh.body != FLEXIBLE_SPLINE:
        return np.zeros(len(z), dtype=bool)
    on_rim = radius < geometry.inner_radius + BESIDE * geometry.gears[mesh.body].rim
    beside = on_rim & at_the_cam_edge(geometry, mesh.coords)
    if geometry.cup is None:
        return beside
    thickness, back = geometry.cup_thickness, geometry.cup.wall.back
    resolved = max(geometry.wall_decay, wall_start(geometry, geometry.cup) + BEHIND * thickness)
    beside |= z > back + min(resolved, length - BEHIND * thickness)
    if geometry.cup.back_fillet == 0.0:
        corner = geometry.inner_radius + thickness
        beside |= np.hypot(radius - corner, z - back) < BESIDE * thickness
    return beside


def tooth_nodes(mesh: SectorMesh, geometry: DriveGeometry, ends: bool) -> np.ndarray:
    """Nodes (n,) of the toothed part at the ends of its face width, or between them. The plane has
    no ends.

    The fillet at the back of the teeth belongs to their end.
    """
    z, face_width = (
        np.zeros(len(mesh.coords)) if mesh.plane else np.abs(mesh.coords[:, 2]),
        geometry.face_width,
    )
    if not ends:
        return np.flatnonzero(z <= END * face_width)
    behind = 0.0 if geometry.cup is None else geometry.cup.back_fillet
    return np.flatnonzero((z > END * face_width) & (z <= TOOTHED * face_width + behind))
