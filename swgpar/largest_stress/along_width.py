"""The largest stress along the face width, between the stations of a mesh.

Elements in the middle of the face width are long, and the largest stress may lie between two of
their stations: where a race touches along one line, the nodes of the third window of a cup drive
have 3 % less. So it is read from the parabola through the largest station and those beside it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.meshing.sector import SectorMesh

DIGITS = 9
"""Of the coordinate along the axis (mm), in which the nodes of a station agree."""


@dataclass(frozen=True)
class Peak:
    """A largest stress.

    value : MPa;  z : mm, where
    node : index of the node with the largest stress, at the station nearest to it
    """

    value: float
    z: float
    node: int


@dataclass(frozen=True)
class WidthStations:
    """Stations of a face width. z : (n,) mm, ascending"""

    z: np.ndarray

    @classmethod
    def of(cls, mesh: SectorMesh) -> WidthStations:
        """Those of the flanks of a sector."""
        return cls(np.unique(np.round(mesh.coords[mesh.flanks[0].nodes.ravel(), 2], DIGITS)))

    def largest(self, z: np.ndarray, stress: np.ndarray) -> Peak:
        """The largest of the stresses (n,) MPa of nodes at z (n,) mm.

        It is that of a node at the ends of the face width, away from it, and where a station beside
        it has no node with a stress.
        """
        node, heights = int(stress.argmax()), np.round(z, DIGITS)
        k = int(np.searchsorted(self.z, heights[node]))
        around = self.z[max(k - 1, 0) : k + 2]
        at = [stress[heights == one].max(initial=-np.inf) for one in around]
        if len(at) < 3 or around[1] != heights[node] or not np.isfinite(at).all():
            return Peak(float(stress[node]), float(z[node]), node)
        place, value = vertex(around, np.array(at))
        return Peak(value, place, node)


def vertex(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Place and value of the vertex of the parabola through three points (3,), of which the middle
    one is the largest."""
    rise, fall = np.diff(y) / np.diff(x)
    bend = (fall - rise) / (x[2] - x[0])
    if bend == 0.0:  # three equal values
        return float(x[1]), float(y[1])
    slope = rise + bend * (x[1] - x[0])
    return float(x[1] - 0.5 * slope / bend), float(y[1] - 0.25 * slope**2 / bend)
