"""Stresses on the surface of teeth, apart from the contact of flanks.

Up to a distance from a contact a window has a line load. Beside a contact near the root the largest
stress is at that distance, where it falls steeply. The first node beyond may lie an element
farther, so that windows would show the place of their nodes rather than the stress.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from swgpar.flank_pressure.pressed_cells import PressedCells
from swgpar.geometry.rotation import rotated
from swgpar.meshing.sector import SectorMesh


def surface_mises(
    s1: np.ndarray, s3: np.ndarray, mises: np.ndarray, free: np.ndarray
) -> np.ndarray:
    """Von Mises stress (MPa) in the plane where a surface without a load has a stress along it and
    none across.

    Nodal averages have some across it, which falls with the first order of the element size alone.
    free : whether such a surface is there;  s1, s3, mises : of nodal averages, of its shape
    """
    return np.where(free, np.maximum(s1, -s3), mises)


@dataclass(frozen=True)
class BesideContact:
    """Nodes near the contact of flanks, and edges of the surface on which that ends.

    near : (count, n_node) bool, of the sectors of a window, not read
    sector, within, beyond : (n,) of edges, their nodes on either side of the end
    share : (n,) of the stress of the node beyond in that at the end
    """

    near: np.ndarray
    sector: np.ndarray
    within: np.ndarray
    beyond: np.ndarray
    share: np.ndarray

    @classmethod
    def of_nodes(cls, near: np.ndarray) -> BesideContact:
        """Where nodes (count, n_node) bool alone are known to be near."""
        none = np.zeros(0, dtype=np.int64)
        return cls(near, none, none, none, np.zeros(0))

    @classmethod
    def of_cells(
        cls,
        mesh: SectorMesh,
        count: int,
        cells: Mapping[tuple[int, int], PressedCells],
        distance: float,
        loaded: np.ndarray,
    ) -> BesideContact:
        """From the ends of the cells that carry, in the plane.

        mesh : sector;  count : of them;  cells : by (sector, side);  distance : mm
        loaded : nodes (count, n_node) bool with a force, whose stress is that of the contact
        """
        far = _distances(mesh, count, cells)
        near, edges = far < distance, mesh.surface_edges
        one, other = np.concatenate([edges, edges[:, ::-1]]).T
        sector, k = np.nonzero(near[:, one] & ~near[:, other] & ~loaded[:, one])
        within, beyond = one[k], other[k]
        inner, outer = far[sector, within], far[sector, beyond]
        return cls(near, sector, within, beyond, (distance - inner) / (outer - inner))

    def read(self, stress: np.ndarray, sectors: np.ndarray) -> np.ndarray:
        """Stress (n, n_node) MPa of sectors (n,) as it is read: none where it is near, at the first
        node beyond at least that at the end."""
        read = np.where(self.near[sectors], -np.inf, stress)
        for k, sector in enumerate(sectors):
            own = self.sector == sector
            within, beyond, share = self.within[own], self.beyond[own], self.share[own]
            at_end = (1.0 - share) * stress[k, within] + share * stress[k, beyond]
            np.maximum.at(read[k], beyond, at_end)
        return read


def _distances(
    mesh: SectorMesh, count: int, cells: Mapping[tuple[int, int], PressedCells]
) -> np.ndarray:
    """Distances (count, n_node) mm of the nodes of plane sectors from the nearest end of a cell, on
    their own tooth or on one beside it; infinite without one."""
    found, profile = np.full((count, len(mesh.coords)), np.inf), mesh.profile
    for (sector, side), of_flank in cells.items():
        s = np.clip(of_flank.ends, 0.0, profile.length)
        x, y = (profile.point(s) * [side, 1.0]).T
        points = np.column_stack([x, y, 0.0 * x])
        for beside in (-1, 0, 1):
            if 0 <= sector + beside < count:
                tree = cKDTree(rotated(points, np.array(-beside * mesh.pitch))[:, :2])
                nearest, _ = tree.query(mesh.coords[:, :2])
                of_sector = found[sector + beside]
                np.minimum(of_sector, nearest, out=of_sector)
    return found
