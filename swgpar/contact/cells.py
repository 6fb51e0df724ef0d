"""Cells of lines of contact on the faces of slave flanks.

A line runs along the profile at a station of the face width. It is cut along the edges of the
facets of both flanks, so that gap and shape functions of both sides are smooth in a cell. A face
has equal pieces, each with equal cells: away from the cuts they stay at their places in the
material.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

POINTS = 0.5 * (1.0 + np.array([-1.0, 1.0]) / np.sqrt(3.0))
"""Places of the quadrature points of a cell along the profile, with equal shares."""


@dataclass(frozen=True)
class Cells:
    """Cells of lines on faces; a station stands for a share of the face's width.

    parent (n,) face of each;  low, high (n,) ends along the profile, station (n,) place along z, in
    [0, 1] on the face;  share : (n,) of the width that a station stands for
    """

    parent: np.ndarray
    low: np.ndarray
    high: np.ndarray
    station: np.ndarray
    share: np.ndarray

    @property
    def a(self) -> np.ndarray:
        """Places (n, 2) of the quadrature points along the profile."""
        return self.low[:, None] + (self.high - self.low)[:, None] * POINTS

    @property
    def b(self) -> np.ndarray:
        """Places (n, 2) of the quadrature points along z."""
        return np.repeat(self.station[:, None], 2, axis=1)

    @property
    def area(self) -> np.ndarray:
        """Shares (n, 2) of the quadrature points in the face's area."""
        return np.repeat((0.5 * self.share * (self.high - self.low))[:, None], 2, axis=1)


@dataclass(frozen=True)
class Stations:
    """Lines on a layer of faces. place : (n,) over its width, in [0, 1];  share : (n,) of it"""

    place: np.ndarray
    share: np.ndarray

    @classmethod
    def of(cls, number: int, plane: bool) -> Stations:
        """Gauss points; nothing changes along z in the plane, where one line does."""
        place, weight = np.polynomial.legendre.leggauss(1 if plane else number)
        return cls(0.5 * (1.0 + place), 0.5 * weight)


def divided(
    foot: np.ndarray, length: np.ndarray, lines: np.ndarray, parts: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cells of lines: row (n,) in `foot` of each, ascending, and its ends (n,) in [0, 1], ascending
    in a row.

    foot : (n_row, 2) mm, place on the master of both ends of a line on a face. Places beyond the
    end of the flank lie on its straight continuation: the line is cut where the flank ends, so that
    what touches changes continuously
    length : (n_row,) mm of the face along the master, with sign, which stands in for a foot that is
    much farther off still, or across the tooth
    lines : (m,) mm, ascending, places of the master's nodes
    parts : (n_row, n_piece) cells of each of the equal pieces of a face
    """
    low, high = foot.T
    low = np.where(np.isnan(low), high - length, low)
    high = np.where(np.isnan(high), low + length, high)
    first = np.searchsorted(lines, np.minimum(low, high))
    count = np.where(
        np.isfinite(low + high), np.searchsorted(lines, np.maximum(low, high)) - first, 0
    )
    step = np.arange(count.max(initial=0))
    crossed = lines[np.minimum(first[:, None] + step, len(lines) - 1)]
    with np.errstate(invalid="ignore", divide="ignore"):
        place = (crossed - low[:, None]) / (high - low)[:, None]
    pieces, in_piece = parts.shape[1], parts.ravel()
    of_piece = np.repeat(np.arange(in_piece.size), in_piece)
    start = np.cumsum(in_piece) - in_piece
    row, piece = np.divmod(of_piece, pieces)
    within = np.arange(len(of_piece)) - start[of_piece]
    begin, end = ((piece + (within + k) / in_piece[of_piece]) / pieces for k in (0, 1))
    # the end of a cell that is nearest to an edge moves there
    of, k = np.nonzero((step < count[:, None]) & (place > 0.0) & (place < 1.0))
    along = place[of, k] * pieces
    at = np.minimum(along.astype(np.int64), pieces - 1)
    piece_at, number = of * pieces + at, parts.sum(axis=1)[of]
    nearest = start[piece_at] + np.rint((along - at) * in_piece[piece_at]).astype(np.int64)
    nearest -= start[of * pieces]
    # the end of the flank is met exactly, by cells of any width
    is_end = np.isin(first[of] + k, (0, len(lines) - 1))
    nearest = np.where(is_end, np.clip(nearest, 1, number - 1), nearest)
    inside = (nearest > 0) & (nearest < number)
    moved = (start[of * pieces] + nearest)[inside]
    begin[moved] = end[moved - 1] = place[of, k][inside]
    return row, begin, end
