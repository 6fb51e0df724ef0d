"""Coulomb friction between flanks: the history of the last converged state, on the cells of that
state.

Lines are cut anew in every increment, so that their cells are not the same. The tangential traction
of the last state is constant on each of its cells; a new cell takes the mean over its own length.
The foot point of that state is not stored: the point is projected again at the converged
displacement, exactly. Components are those of the master's undeformed coordinates, arc length and
z, with the current base vectors (see kernel/friction.hpp).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from mpi4py import MPI

PairKey = tuple[int, int, int]
"""Sector of the flexible spline, side of its tooth, number of the ring gear's tooth."""


@dataclass
class Friction:
    """Law and history at the quadrature points of the present cells; see
    `swgpar.kernel.contact_flanks`.

    coefficient : of friction;  stiffness : (n_face, n_q) MPa / mm, tangential
    foot_point (n_face, n_q, 2) mm, gap (n_face, n_q) mm : of the last converged state, nan and inf
    without a foot traction (n_face, n_q, 2) MPa : of the last converged state
    current (n_face, n_q, 2) MPa : set by the kernel
    lagged (n_face, n_q) MPa : pressures that stand for the present ones in the law, or None
    """

    coefficient: float
    stiffness: np.ndarray
    foot_point: np.ndarray
    gap: np.ndarray
    traction: np.ndarray
    current: np.ndarray
    lagged: np.ndarray | None = None

    def subset(self, rows: np.ndarray) -> Friction:
        """The same of some of the faces."""
        lagged = None if self.lagged is None else np.ascontiguousarray(self.lagged[rows])
        return replace(
            self,
            stiffness=np.ascontiguousarray(self.stiffness[rows]),
            foot_point=np.ascontiguousarray(self.foot_point[rows]),
            gap=np.ascontiguousarray(self.gap[rows]),
            traction=np.ascontiguousarray(self.traction[rows]),
            current=np.ascontiguousarray(self.current[rows]),
            lagged=lagged,
        )


def begin(
    coefficient: float,
    stiffness: np.ndarray,
    foot_point: np.ndarray,
    gap: np.ndarray,
    traction: np.ndarray,
) -> Friction:
    """Friction at points whose last converged state is given; see `Friction`."""
    return Friction(coefficient, stiffness, foot_point, gap, traction, np.zeros_like(traction))


@dataclass(frozen=True)
class CellTractions:
    """Tangential tractions on the cells of a pair of flanks, by lines, then along the profile.

    line : (n,) of the flank;  low, high : (n,) mm, ends on the slave flank;  traction : (n, 2) MPa
    """

    line: np.ndarray
    low: np.ndarray
    high: np.ndarray
    traction: np.ndarray

    def means(self, line: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Mean tractions (m, 2) MPa over cells of the same flank."""
        out = np.zeros((len(line), 2))
        for number in np.intersect1d(self.line, line):
            mine, theirs = self.line == number, line == number
            # the integral along the line, linear on cells and constant between them
            ends = np.column_stack([self.low[mine], self.high[mine]]).ravel()
            width = (self.high - self.low)[mine]
            for c in range(2):
                steps = np.zeros(len(ends))
                steps[1::2] = self.traction[mine, c] * width
                integral = np.cumsum(steps)
                difference = np.interp(high[theirs], ends, integral) - np.interp(
                    low[theirs], ends, integral
                )
                out[theirs, c] = difference / (high - low)[theirs]
        return out


NO_TOOTH = np.iinfo(np.int64).min
"""Stands in a file where a flank has no traction."""

ROWS = ("tooth", "cells")
"""Names of the rows for a file, by sector of the flexible spline."""


def to_rows(
    store: Mapping[PairKey, CellTractions], first: int, end: int, comm: MPI.Comm
) -> dict[str, np.ndarray]:
    """The tractions of the sectors first .. end - 1 as rows for a file; collective.

    Returns teeth (end - first, 2) of the ring gear that the flanks of side +1 and -1 touch, and
    their cells (end - first, 2, n, 5): line, -1 beyond the last cell, both ends mm, tractions MPa.
    """
    here = {key: cells for key, cells in store.items() if first <= key[0] < end}
    most = comm.allreduce(max((len(c.line) for c in here.values()), default=0), op=MPI.MAX)
    tooth = np.full((end - first, 2), NO_TOOTH)
    table = np.full((end - first, 2, max(most, 1), 5), -1.0)
    for (sector, side, ring_tooth), cells in here.items():
        entry = sector - first, int(side < 0)
        tooth[entry] = ring_tooth
        columns = np.column_stack([cells.line, cells.low, cells.high, cells.traction])
        table[entry][: len(columns)] = columns
    return dict(zip(ROWS, (tooth, table)))


def from_rows(rows: Mapping[str, np.ndarray]) -> dict[PairKey, CellTractions]:
    """The tractions that `to_rows` made rows of, those of all sectors from 0 on."""
    tooth, table = (rows[name] for name in ROWS)
    out = {}
    for k, side in zip(*np.nonzero(tooth != NO_TOOTH)):
        cells = table[k, side]
        line, low, high, *traction = cells[cells[:, 0] >= 0.0].T
        out[int(k), (1, -1)[side], int(tooth[k, side])] = CellTractions(
            line.astype(np.int64), low, high, np.column_stack(traction)
        )
    return out
