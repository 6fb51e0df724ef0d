"""Forces on the cells of lines of contact: a complementarity of gaps and forces, line by line.

A line runs along the profile at one station of the face width. Its cells are narrower than an
element. With g the gap of the finite elements' surfaces averaged over a cell, f the force on it per
length of the line (N/mm), and D what both bodies' elements lack in compliance
(`swgpar.contact.missing_compliance`):

    0 <= f,   0 <= g + D f,   f (g + D f) = 0.

The stiffness is the physical one: there is no penalty. D is symmetric and positive, so that the
forces are unique, and -f is the derivative of a potential of the gaps with the second derivative
D_active^-1 on the cells that carry.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.contact.missing_compliance import MissingCompliance

TOGETHER, MAX_CHANGES = 20, 1000
"""Changes of the cells that carry on one line: of all wrong ones together, and in all, one after
the other (K. G. Murty, Linear Complementarity, 1988, chapter 4)."""

CLOSED = 2.0
"""Gap, over the deepest overlap of its line, that forces may close."""

ROUND_OFF = 1e-14
"""Overlap (mm) that is round-off of positions."""


@dataclass(frozen=True)
class Strips:
    """Cells as strips of both flanks. low, high : (n,) mm, their ends on the flank of each body"""

    low: np.ndarray
    high: np.ndarray


@dataclass
class LineForces:
    """Forces on cells and the stiffness of those that carry.

    force : (n,) N/mm
    lines : of each line that carries, its cells (m,) and their stiffness (m, m) N/mm²
    """

    force: np.ndarray
    lines: list[tuple[np.ndarray, np.ndarray]]


def line_starts(line: np.ndarray) -> np.ndarray:
    """First cell of each line and the number of cells, (n_line + 1,); line : (n,) ascending."""
    return np.append(np.flatnonzero(np.diff(line, prepend=-1)), len(line)).astype(np.int64)


def forces(
    line: np.ndarray,
    gap: np.ndarray,
    strips: tuple[Strips, Strips],
    missing: tuple[MissingCompliance, MissingCompliance],
    softness: np.ndarray,
    share: float,
) -> LineForces:
    """Forces on the cells of lines.

    line : (n,) number of the line of each cell, ascending;  gap : (n,) mm, infinite where a cell
    has no foot point;  strips, missing : of both bodies
    softness : (n,) mm / (N/mm), further compliance of each cell by itself
    share : of the stiffness that acts, above 0, at most 1
    """
    force = np.zeros(len(gap))
    deepest = np.full(int(line.max(initial=-1)) + 1, np.inf)
    np.minimum.at(deepest, line, gap)
    # forces close no gap that is much wider than the deepest overlap of their line
    near = np.flatnonzero(gap < -CLOSED * deepest[line])
    start = line_starts(line[near])
    count = np.diff(start)
    values = np.zeros(int((count**2).sum()))
    for body, ends in zip(missing, strips):
        body.add(start, ends.low[near], ends.high[near], values)
    carrying, first = [], 0
    for k, n in enumerate(count):
        cells = near[start[k] : start[k + 1]]
        flexibility = values[first : first + n**2].reshape(n, n) + np.diag(softness[cells])
        flexibility /= share
        first += n**2
        force[cells], acts = complementary_forces(flexibility, gap[cells])
        if acts.any():
            stiffness = np.linalg.inv(flexibility[np.ix_(acts, acts)])
            carrying.append((cells[acts], stiffness))
    return LineForces(force, carrying)


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
