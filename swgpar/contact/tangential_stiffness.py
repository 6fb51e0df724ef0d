"""Stiffness against slip of the cells that touch: it follows from the law of their normal forces.

A half plane yields as much to a tangential line load as to a normal one (Johnson, Contact
Mechanics, 2.18 and 2.22). So the elements lack the same compliance in both directions, and a line
of contact yields to a tangential force as it does to the normal one: with overlaps -g that the
forces f close, by C = sum f (-g) / (sum f)² per force.

Every cell is a spring of its own, with the stiffness eps per area, that slips at mu p. The springs
share 1 / C as p^(-1/2). Under an elliptical pressure the part of them that slips then grows in
proportion to the tangential force, and the loss of a small cycle with its third power, as in the
contact of Cattaneo and Mindlin (Johnson, 7.2), where cells at the edges slip first as well. With
the same stiffness for all cells the loss grows with the fourth power.
"""

from __future__ import annotations

import numpy as np

from swgpar.contact.active_cells import ActiveCells

ELLIPTICAL = 1.193
"""Integral of p^(-1/2) over an elliptical pressure, over W / p_m^(1/2); see below."""

LEAST = 1e-3
"""Least pressure, over that of the line, that makes a cell stiffer."""


def tangential_stiffness(active: ActiveCells, modulus: float, facet: float) -> np.ndarray:
    """Stiffness eps (n,) MPa / mm of cells against slip.

    With p_m = sum p f / sum f and W = sum f / p_m of a line, eps = (p_m / p)^(1/2) / (1.193 C W):
    sums that change continuously where a cell begins to carry.

    modulus : MPa and facet : mm, whose quotient cells of lines without a force have
    """
    force = active.forces.force
    number, line = np.unique(active.placed.line, return_inverse=True)

    def summed(values: np.ndarray) -> np.ndarray:
        return np.bincount(line, np.where(force > 0.0, values, 0.0), len(number))

    pressure = force / active.width
    total, squares = summed(force), summed(pressure * force)
    closed = summed(-force * np.where(force > 0.0, active.gap, 0.0))
    touches = closed > 0.0
    # 1 / (C W) = total² / closed * (squares / total) / total
    mean, stiffness = np.ones(len(number)), np.full(len(number), modulus / facet)
    mean[touches] = squares[touches] / total[touches]
    stiffness[touches] = squares[touches] / closed[touches] / ELLIPTICAL
    relative = np.where(touches[line], np.maximum(pressure / mean[line], LEAST), 1.0)
    return stiffness[line] / np.sqrt(relative)
