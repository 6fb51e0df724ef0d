"""Where the cells of lines of contact lie: on the lines that are near, as narrow as their overlap
asks for.

It depends on the displacement alone, so that equal states have equal cells on any path to them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from swgpar.contact.cells import Cells, Stations, divided
from swgpar.contact.contact_lines import CLOSED
from swgpar.contact.flank_pairs import Faces, FlankPairs

PIECES = 8
"""Equal pieces of a line on a face. The overlap is looked for with a cell on each."""

PARTS = np.array([1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256])
"""Cells on a piece. With other numbers between them the number would change with every half a
percent of the overlap. A force has a jump there, so that many states would have no solution."""

FINEST = 1.25
"""Most cells of a piece, over `across`."""

ACROSS, RESOLVED, NARROW = 22, 44, 176
"""Least number of cells in the overlap: in a solve, where pressures are reported, and where these
have peaks as narrow as the cells."""

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


@dataclass(frozen=True)
class _CoarseCells:
    """A cell on each piece of the rows, parts of lines on a face, that are near.

    closest : (n,) mm, least gap of all rows;  row : (n_row,) those that are near
    ends : (n_row, 2) mm, their ends on the master
    middle : (n_row, PIECES) of the cells, in [0, 1] on the face;  gap : (n_row, PIECES, 2) mm
    """

    closest: np.ndarray
    row: np.ndarray
    ends: np.ndarray
    middle: np.ndarray
    gap: np.ndarray


class CellPlacement:
    """Places cells on the faces that can meet.

    flank_pairs : pairs and faces of a search;  near : (n,) faces that can meet
    n_face, n_layer : faces and layers of a flank;  stations : lines on a layer
    """

    def __init__(
        self,
        flank_pairs: FlankPairs,
        near: np.ndarray,
        *,
        n_face: int,
        n_layer: int,
        stations: Stations,
    ) -> None:
        self._pairs, self._lines_of_flank = flank_pairs, n_layer * len(stations.place)
        at, n_line = stations.place, len(stations.place)
        face, number = np.repeat(near, n_line), np.tile(np.arange(n_line), len(near))
        pair, on_flank = np.divmod(face, n_face)
        line = (pair * n_layer + on_flank % n_layer) * n_line + number
        order = np.lexsort((face, line))
        self._face, self._line = face[order], line[order]
        self._station, self._share = at[number[order]], stations.share[number[order]]
        self._size = flank_pairs.faces.size[self._face, 0]
        a = np.tile(np.linspace(0.0, 1.0, PIECES + 1), (len(face), 1))
        b = np.repeat(self._station[:, None], PIECES + 1, axis=1)
        self._samples = flank_pairs.faces.points(self._face, a, b, np.ones_like(a))
        sides = np.array([p.side for p in flank_pairs.pairs])
        self._side = sides[self._samples.patch]

    def place(self, u: np.ndarray, gaps: Gaps, across: int) -> PlacedCells:
        """The cells for displacement u (n_local, 3) mm.

        gaps : gives those of faces;  across : least number of cells in an overlap
        """
        coarse = self._coarse(u, gaps)
        parts = self._parts(coarse, across)
        cells, line, faces = self._divided(coarse.row, coarse.ends, parts)
        nearest = {k: float(coarse.closest[self._side == k].min(initial=np.inf)) for k in (1, -1)}
        return PlacedCells(cells, faces, line, nearest)

    def least_gaps(self, u: np.ndarray, gaps: Gaps) -> np.ndarray:
        """Smallest gap (n_pair,) mm on the lines of each pair at u; inf without any."""
        gap, _ = gaps(self._samples, u, CONTINUATION)
        least = np.full(len(self._pairs.pairs), np.inf)
        np.minimum.at(least, self._samples.patch, _least(gap))
        return least

    def overlapping(self, u: np.ndarray, gaps: Gaps) -> np.ndarray:
        """Numbers (n,) of the lines that touch at u."""
        coarse = self._coarse(u, gaps)
        touching = (coarse.gap.mean(axis=2) < 0.0).any(axis=1)
        return np.unique(self._line[coarse.row[touching]])

    def _coarse(self, u: np.ndarray, gaps: Gaps) -> _CoarseCells:
        gap, foot = gaps(self._samples, u, CONTINUATION)
        closest = _least(gap)
        row = np.flatnonzero(closest < PLACED * self._size)
        ends = foot[row][:, [0, -1], 0]
        cells, _, faces = self._divided(row, ends, np.ones((len(row), PIECES), dtype=np.int64))
        gap = gaps(faces, u, None)[0].reshape(len(row), PIECES, 2)
        middle = 0.5 * (cells.low + cells.high).reshape(len(row), PIECES)
        return _CoarseCells(closest, row, ends, middle, gap)

    def _parts(self, coarse: _CoarseCells, across: int) -> np.ndarray:
        """Cells (n_row, PIECES) of the pieces: as many as an overlap of their line asks for, where
        the flanks are near. A line beside the deepest one of its flank is taken to lie deeper by
        the gap that forces there may close. Lines that do not touch have cells too, which meet
        while the cells are frozen."""
        size, closest, gap = self._size[coarse.row], coarse.closest[coarse.row], coarse.gap
        numbers, of_row = np.unique(self._line[coarse.row], return_inverse=True)
        mean, of_cell = gap.mean(axis=2), np.repeat(of_row, PIECES)
        overlap = np.zeros(len(numbers))
        least, nearest = np.full((2, len(numbers)), np.inf)
        np.minimum.at(least, of_row, np.minimum(closest, mean.min(axis=1)))
        _, of_line = np.unique(numbers // self._lines_of_flank, return_inverse=True)
        deepest = np.zeros(len(numbers))
        np.maximum.at(deepest, of_line, -least)
        depth = deepest[of_line]
        deeper = np.clip(least + depth, 0.0, CLOSED * depth)[of_row]
        behind, ahead = coarse.middle * size[:, None], (1.0 - coarse.middle) * size[:, None]
        reduced = mean - deeper[:, None]
        lengths = _negative_parts(of_cell, behind.ravel(), ahead.ravel(), reduced.ravel())
        np.add.at(overlap, of_cell[:-1], lengths)
        closing = np.minimum(closest, gap.min(axis=(1, 2))) - deeper
        np.minimum.at(nearest, of_row, closing / size)
        # a face beside one of another length has cells of the same width
        shares = overlap[of_row] / size
        wanted = np.minimum(across / np.maximum(PIECES * shares, 1e-3), FINEST * across)
        fine = PARTS[np.searchsorted(PARTS, wanted)]
        fine[nearest[of_row] >= TOUCHES] = 1
        within = gap.min(axis=2) < (TOUCHES * size + CLOSED * depth[of_row])[:, None]
        return np.where(within, fine[:, None], 1)

    def _divided(
        self, row: np.ndarray, ends: np.ndarray, parts: np.ndarray
    ) -> tuple[Cells, np.ndarray, Faces]:
        """Cells of rows (n_row,); their lines; their quadrature points. ends : (n_row, 2) mm, on
        the master;  parts : (n_row, n_piece) cells of the pieces"""
        of, low, high = divided(ends, -self._size[row], self._pairs.masters.s, parts)
        row = row[of]
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


def _negative_parts(
    line: np.ndarray, behind: np.ndarray, ahead: np.ndarray, gap: np.ndarray
) -> np.ndarray:
    """Lengths (n - 1,) mm where the gap is negative between the middles of neighbouring cells of a
    line.

    line, gap : (n,) of the cells, their gaps mm;  behind, ahead : (n,) mm, of their middles from
    both ends of the face
    """
    step = np.diff(behind)
    step = np.where(step > 0.0, step, ahead[:-1] + behind[1:])
    depth = np.maximum(-gap, 0.0)
    height = np.where(np.isfinite(gap), np.maximum(gap, 0.0), np.inf)
    deep, high = depth[:-1] + depth[1:], height[:-1] + height[1:]
    share = np.divide(deep, deep + high, out=np.zeros_like(deep), where=deep > 0.0)
    return np.where(line[1:] == line[:-1], step * share, 0.0)
