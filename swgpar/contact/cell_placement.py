"""Where the cells of lines of contact lie: on the lines that are near, as narrow as their overlap
asks for.

It depends on the displacement alone, so that equal states have equal cells on any path to them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from swgpar.contact.cells import Cells, Stations, divided
from swgpar.contact.flank_pairs import Faces, FlankPairs

COARSE, FINEST = 8, 10
"""Cells of a line on a face where the overlap is looked for; most of them on a face, over those
that are asked for in an overlap."""

ACROSS, RESOLVED = 24, 48
"""Cells in the overlap that are asked for: in a solve, and where pressures are reported."""

PLACED = 0.2
"""Gap, over the length of a face, above which a line on it has no cells."""

TOUCHES = 0.01
"""Gap, over the length of a face, below which a line is taken to touch between its cells."""

CONTINUATION = 5.0
"""Length, in facets, of the straight continuation past the ends of the master's flank. Ends of
lines have their foot points on it, so that the cut at the flank's end changes continuously while a
face slides over that end."""

Gaps = Callable[[Faces, np.ndarray, float | None], tuple[np.ndarray, np.ndarray]]
"""Gaps and foot points of faces at a displacement; facets by which foot points may lie past the
ends of the flank, None for none."""


@dataclass(frozen=True)
class PlacedCells:
    """Cells of the lines that are near.

    cells, faces : their places and quadrature points;  line : (n,) number of each cell's line,
    ascending
    nearest : smallest gap (mm) by side of the teeth
    """

    cells: Cells
    faces: Faces
    line: np.ndarray
    nearest: dict[int, float]


class CellPlacement:
    """Places cells on the faces that can meet.

    flank_pairs : pairs and faces of a search;  near : (n,) faces that can meet
    n_face, n_layer : faces and layers of a flank;  stations : lines on a layer
    gaps : gives those of faces
    across : cells in an overlap that are asked for
    """

    def __init__(
        self,
        flank_pairs: FlankPairs,
        near: np.ndarray,
        *,
        n_face: int,
        n_layer: int,
        stations: Stations,
        gaps: Gaps,
        across: int,
    ) -> None:
        self._pairs, self._gaps, self._across = flank_pairs, gaps, across
        at, n_line = stations.place, len(stations.place)
        self._share = np.tile(stations.share, len(near))
        self._face, self._station = np.repeat(near, n_line), np.tile(at, len(near))
        pair, face = np.divmod(self._face, n_face)
        layer = pair * n_layer + face % n_layer
        self._line = layer * n_line + np.tile(np.arange(n_line), len(near))
        self._size = flank_pairs.faces.size[self._face, 0]
        a = np.tile(np.linspace(0.0, 1.0, COARSE + 1), (len(self._face), 1))
        b = np.repeat(self._station[:, None], COARSE + 1, axis=1)
        self._samples = flank_pairs.faces.points(self._face, a, b, np.ones_like(a))
        sides = np.array([p.side for p in flank_pairs.pairs])
        self._side = sides[self._samples.patch]

    def place(self, u: np.ndarray) -> PlacedCells:
        """The cells for displacement u (n_local, 3) mm."""
        gap, foot = self._gaps(self._samples, u, CONTINUATION)
        least = _least(gap)
        nearest = {k: float(least[self._side == k].min(initial=np.inf)) for k in (1, -1)}
        near = np.flatnonzero(least < PLACED * self._size)
        cells, line, faces = self._divided(near, foot, self._fineness(u, near, foot, least))
        return PlacedCells(cells, faces, line, nearest)

    def overlapping(self, u: np.ndarray) -> np.ndarray:
        """Numbers (n,) of the lines that touch at u."""
        gap, foot = self._gaps(self._samples, u, CONTINUATION)
        rows = np.flatnonzero(gap.min(axis=1) < PLACED * self._size)
        cells, line, faces = self._divided(rows, foot, np.full(len(rows), COARSE))
        gap, _ = self._gaps(faces, u, None)
        return np.unique(line[gap.mean(axis=1) < 0.0])

    def _fineness(
        self, u: np.ndarray, rows: np.ndarray, foot: np.ndarray, least: np.ndarray
    ) -> np.ndarray:
        """Numbers of cells of the rows (n,): as many as an overlap of their line asks for. Lines
        that do not touch have cells too, which meet while the cells are frozen."""
        cells, line, faces = self._divided(rows, foot, np.full(len(rows), COARSE))
        gap, _ = self._gaps(faces, u, None)
        size = self._pairs.faces.size[cells.parent, 0]
        numbers, index = np.unique(line, return_inverse=True)
        n = len(numbers)
        if not n:
            return np.zeros(0, dtype=np.int64)
        overlap = np.bincount(index[:-1], _negative_parts(cells, line, gap), minlength=n)
        closest = np.full(n, np.inf)
        np.minimum.at(closest, index, gap.min(axis=1) / size)
        of_row = np.searchsorted(numbers, self._line[rows])
        np.minimum.at(closest, of_row, least[rows] / self._size[rows])
        wanted = self._across / np.maximum(COARSE * overlap, 1e-3)
        number = np.ceil(COARSE * np.maximum(wanted, 1.0)).astype(np.int64)
        number = np.where(closest < TOUCHES, np.minimum(number, FINEST * self._across), COARSE)
        return number[of_row]

    def _divided(
        self, rows: np.ndarray, foot: np.ndarray, number: np.ndarray
    ) -> tuple[Cells, np.ndarray, Faces]:
        """Cells of rows (n,), `number` on a face; their lines; their quadrature points."""
        s = self._pairs.masters.s
        row, low, high = divided(foot[rows][:, [0, -1], 0], -self._size[rows], s, number)
        row = rows[row]
        order = np.lexsort((low, self._face[row], self._line[row]))
        row, low, high = row[order], low[order], high[order]
        cells = Cells(self._face[row], low, high, self._station[row], self._share[row])
        return cells, self._line[row], self._pairs.faces.of_cells(cells)


def _least(gap: np.ndarray) -> np.ndarray:
    """Least gaps (n,) mm of lines with samples (n, m): those of parabolas through three of them."""
    row = np.arange(len(gap))
    k = np.clip(gap.argmin(axis=1), 1, gap.shape[1] - 2)
    left, middle, right = (gap[row, k + step] for step in (-1, 0, 1))
    with np.errstate(invalid="ignore", divide="ignore"):
        bend = left - 2.0 * middle + right
        vertex = middle - (right - left) ** 2 / (8.0 * bend)
        inside = np.abs(right - left) < 2.0 * bend
    return np.minimum(gap.min(axis=1), np.where(inside, vertex, np.inf))


def _negative_parts(cells: Cells, line: np.ndarray, gap: np.ndarray) -> np.ndarray:
    """Lengths (n - 1,), in faces, where the gap (n, 2) is negative between the middles of
    neighbouring cells of a line."""
    middle, mean = 0.5 * (cells.low + cells.high), gap.mean(axis=1)
    step = np.where(np.diff(cells.parent) == 0, np.diff(middle), 1.0 + np.diff(middle))
    depth = np.maximum(-mean, 0.0)
    height = np.where(np.isfinite(mean), np.maximum(mean, 0.0), np.inf)
    deep, high = depth[:-1] + depth[1:], height[:-1] + height[1:]
    share = np.divide(deep, deep + high, out=np.zeros_like(deep), where=deep > 0.0)
    return np.where(line[1:] == line[:-1], step * share, 0.0)
