"""Sections through deformed bodies, as figures draw them; those of a plane drive need no VTK."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from swgpar.geometry.rotation import SIXTHS, rotated, sixths_of_turn

if TYPE_CHECKING:
    import pyvista
    from matplotlib.axes import Axes

SAME_PLACE = 1e-5
"""mm: sectors have nodes of their own where they meet."""

COLOURS = "turbo"

Box = tuple[float, float, float, float]
"""Lowest and largest value along both axes of a figure, mm."""


@dataclass(frozen=True)
class SectionView:
    """A plane section through a deformed body.

    points : (n, 2) mm, places in the figure;  triangles : (m, 3)
    mises : (n,) MPa;  outline : (k, 2, 2) mm, ends of its edges
    """

    points: np.ndarray
    triangles: np.ndarray
    mises: np.ndarray
    outline: np.ndarray

    def draw(self, axes: Axes, limit: float) -> None:
        """Draw the section with its outline. limit : MPa, end of the colours"""
        from matplotlib.collections import LineCollection
        from matplotlib.tri import Triangulation

        x, y = self.points.T
        triangles = Triangulation(x, y, self.triangles)
        picture = axes.tripcolor(triangles, self.mises, shading="gouraud", cmap=COLOURS)
        picture.set(clim=(0.0, limit), rasterized=True)
        axes.add_collection(LineCollection(list(self.outline), colors="#222", linewidths=0.5))


def section_of_cut(cut: pyvista.PolyData, at: np.ndarray, box: Box) -> SectionView | None:
    """The part in a box of a plane cut through a body; None without one. at : (n, 2) mm, places of
    its points in the figure"""
    if not cut.n_points:
        return None
    flat = cut.copy()
    flat.points = np.column_stack([at, np.zeros(len(at))])
    inside = flat.clip_box((*box, -1.0, 1.0), invert=False)
    flat = inside.extract_surface(algorithm="dataset_surface").triangulate()
    if not flat.n_cells:
        return None
    flat = flat.clean(tolerance=SAME_PLACE, absolute=True)
    edges = flat.extract_feature_edges(
        boundary_edges=True, feature_edges=False, manifold_edges=False, non_manifold_edges=False
    )
    return SectionView(
        np.asarray(flat.points)[:, :2],
        flat.regular_faces,
        np.asarray(flat.point_data["vm"]),
        np.asarray(edges.points)[edges.lines.reshape(-1, 3)[:, 1:], :2],
    )


@dataclass(frozen=True)
class PlaneBody:
    """A whole deformed body of a plane drive.

    points : (n, 2) mm;  quads : (m, 4);  mises : (n,) MPa, or another field of the nodes
    """

    points: np.ndarray
    quads: np.ndarray
    mises: np.ndarray

    @classmethod
    def of(cls, points: np.ndarray, cells: np.ndarray, mises: np.ndarray, copies: int) -> PlaneBody:
        """The body of which symmetry leaves a part.

        points : (n, 3) mm, deformed;  cells : (m, 8) hexahedra of the one layer
        mises : (n,) MPa;  copies : of that part
        """
        lower, index = np.unique(cells[:, :4], return_inverse=True)
        quads, flat = index.reshape(-1, 4), points[lower, :2]
        turns = SIXTHS[sixths_of_turn(copies, np.arange(copies)), :2, :2]
        return cls(
            np.concatenate([flat @ turn.T for turn in turns]),
            np.concatenate([quads + k * len(flat) for k in range(copies)]),
            np.tile(mises[lower], copies),
        )

    def section(self, angle: float, box: Box) -> SectionView | None:
        """The elements that reach into a box; None without one. angle : rad, of the figure's upward
        axis from +y, counter-clockwise"""
        points = rotated(self.points, -angle)
        low, high = (bound(points[self.quads], axis=1) for bound in (np.min, np.max))
        left, right, bottom, top = box
        reach = (high >= (left, bottom)).all(axis=1) & (low <= (right, top)).all(axis=1)
        if not reach.any():
            return None
        kept, index = np.unique(self.quads[reach], return_inverse=True)
        first, quads = _joined(points[kept], index.reshape(-1, 4))
        places, mises = points[kept][first], self.mises[kept][first]
        triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        return SectionView(places, triangles, mises, places[_free_edges(quads)])

    def surface(self) -> np.ndarray:
        """Nodes (n,) on its surface."""
        first, quads = _joined(self.points, self.quads)
        return first[np.unique(_free_edges(quads))]


def _joined(points: np.ndarray, quads: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of nodes (n, 2) mm at one place the first, (k,), and the elements (m, 4) with these alone."""
    x, y = np.rint((points - points.min(axis=0)) / SAME_PLACE).astype(np.int64).T
    # one number for a place: rows of two would be sorted in ten times the time
    _, first, same = np.unique(x * (y.max() + 1) + y, return_index=True, return_inverse=True)
    return first, same[quads]


def _free_edges(quads: np.ndarray) -> np.ndarray:
    """Edges (k, 2) that one element alone has."""
    ends = np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2).astype(np.int64)
    low, high, nodes = ends.min(axis=1), ends.max(axis=1), int(ends.max()) + 1
    sides, count = np.unique(low * nodes + high, return_counts=True)
    return np.column_stack(np.divmod(sides[count == 1], nodes))
