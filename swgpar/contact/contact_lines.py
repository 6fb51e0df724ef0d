"""Forces on the cells of lines of contact: a complementarity of gaps and forces, flank by flank.

A line runs along the profile at one station of the face width. Its cells are narrower than an
element. With g the gap of the finite elements' surfaces averaged over a cell, f the force on it per
length of the line (N/mm), and D what both bodies' elements lack in compliance on a line
(`swgpar.contact.missing_compliance`) and between lines (`swgpar.contact.line_coupling`):

    0 <= f,   0 <= g + D f,   f (g + D f) = 0.

The stiffness is the physical one: there is no penalty. D is symmetric and positive, so that the
forces are unique, and -f is the derivative of a potential of the gaps with the second derivative
D_active^-1 on the cells that carry.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.contact.line_coupling import LineCoupling
from swgpar.contact.missing_compliance import MissingCompliance

TOGETHER, MAX_CHANGES = 20, 1000
"""Changes of the cells that carry on one line: of all wrong ones together, and in all, one after
the other (K. G. Murty, Linear Complementarity, 1988, chapter 4)."""

CLOSED = 2.0
"""Gap, over the deepest overlap of its flank, that forces may close."""

ROUND_OFF = 1e-14
"""Overlap (mm) that is round-off of positions."""


@dataclass(frozen=True)
class Strips:
    """Cells as strips of both flanks. low, high : (n,) mm, their ends on the flank of each body"""

    low: np.ndarray
    high: np.ndarray


@dataclass
class CellLoads:
    """Forces on cells and the stiffness of those that carry.

    force : (n,) N/mm
    flanks : of each flank that carries, its cells (m,) and their stiffness (m, m) N/mm²
    """

    force: np.ndarray
    flanks: list[tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class FlankCompliance:
    """What the elements under the flanks of a body lack: on each line, and between the lines; None
    where there is one."""

    missing: MissingCompliance
    coupling: LineCoupling | None

    def add(self, line: np.ndarray, low: np.ndarray, high: np.ndarray, out: np.ndarray) -> None:
        """Add the compliance among cells of a flank.

        line : (n,) number of each cell's line, ascending;  low, high : (n,) mm, ends of the cells,
        each within a facet;  out : (n, n) mm / (N/mm)
        """
        start = line_starts(line)
        count = np.diff(start)
        values = np.zeros(int((count**2).sum()))
        self.missing.add(start, low, high, values)
        parts = np.split(values, np.cumsum(count**2)[:-1])
        for first, n, part in zip(start, count, parts):
            out[first : first + n, first : first + n] += part.reshape(n, n)
        if self.coupling is not None:
            self.coupling.add(start, line[start[:-1]], low, high, out)


def line_starts(line: np.ndarray) -> np.ndarray:
    """First cell of each line and the number of cells, (n_line + 1,); line : (n,) ascending."""
    return np.append(np.flatnonzero(np.diff(line, prepend=-1)), len(line)).astype(np.int64)


def forces(
    flank: np.ndarray,
    line: np.ndarray,
    gap: np.ndarray,
    length: np.ndarray,
    strips: tuple[Strips, Strips],
    bodies: tuple[FlankCompliance, FlankCompliance],
    softness: np.ndarray,
    share: float,
) -> CellLoads:
    """Forces on the cells of lines.

    flank, line : (n,) number of the flank of each cell, ascending, and of its line on it, ascending
    on a flank
    gap : (n,) mm, infinite where a cell has no foot point;  length : (n,) mm, share of its line in
    the face width
    strips, bodies : cells and compliance of both bodies
    softness : (n,) mm / (N/mm), further compliance of each cell by itself
    share : of the stiffness that acts, above 0, at most 1
    """
    force, carrying = np.zeros(len(gap)), []
    for cells in np.split(np.arange(len(gap)), line_starts(flank)[1:-1]):
        # forces close no gap that is much wider than the deepest overlap
        near = cells[gap[cells] < -CLOSED * gap[cells].min(initial=0.0)]
        if not len(near):
            continue
        flexibility = np.diag(softness[near])
        for body, ends in zip(bodies, strips):
            body.add(line[near], ends.low[near], ends.high[near], flexibility)
        flexibility /= share
        # loads and gaps times the roots of the lengths make it symmetric
        root = np.sqrt(length[near])
        found, acts = complementary_forces(flexibility, gap[near] * root)
        force[near] = found / root
        if acts.any():
            stiffness = np.linalg.inv(flexibility[np.ix_(acts, acts)])
            stiffness *= root[acts] / root[acts][:, None]
            carrying.append((near[acts], stiffness))
    return CellLoads(force, carrying)


def complementary_forces(flexibility: np.ndarray, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Forces (n,) with 0 <= f, 0 <= g + D f, f (g + D f) = 0, and the cells that carry.

    flexibility : D (n, n), symmetric and positive;  gap : (n,)
    """
    acts, force = gap < 0.0, np.zeros(len(gap))
    for change in range(MAX_CHANGES):
        force[:] = 0.0
        force[acts] = np.linalg.solve(flexibility[np.ix_(acts, acts)], -gap[acts])
        new = np.where(acts, force > 0.0, gap + flexibility @ force < -ROUND_OFF)
        wrong = np.flatnonzero(new != acts)
        if not len(wrong):
            break
        if change < TOGETHER:
            acts = new
        else:  # one after the other no set of cells returns
            acts[wrong[0]] = new[wrong[0]]
    return np.maximum(force, 0.0), acts & (force > 0.0)
