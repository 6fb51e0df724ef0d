"""Cells of a cylinder on a flat flank, nothing deformed: enough of them, where they carry, in few
numbers."""

from __future__ import annotations

import numpy as np

from support.contact_blocks import Blocks, Surface, arc_block
from swgpar.contact.cell_placement import ACROSS, PARTS
from swgpar.materials import Isotropic

STEEL = Isotropic(E=210e3, nu=0.3)
Z, DEPTHS = np.array([-0.5, 0.5]), np.linspace(0.0, 0.5, 3)


def pressed(overlap: float) -> tuple[int, int, float]:
    """Cells of both lines, those that carry, and the force (N). overlap : mm"""
    line = np.linspace(0.0, 1.0, 5)
    lower = arc_block(line, DEPTHS, Z, Surface((0.0, 0.0), 0.0, 1), STEEL)
    upper = arc_block(line - 0.5, DEPTHS, Z, Surface((0.6, -overlap), -0.5, -1, 20.0), STEEL)
    blocks = Blocks(lower, upper, np.zeros((len(lower.points) + len(upper.points), 3), dtype=bool))
    u = np.zeros_like(blocks.points)
    blocks.search(u)
    force = -float(blocks.forces(u)[blocks.first :, 1].sum())
    active = blocks.flanks.cells.active
    assert active is not None
    return len(active.gap), int(active.carries.sum()), force


def test_the_number_of_cells_seldom_changes() -> None:
    """While the overlap grows sixteenfold. With a number for every length of the overlap the force
    has hundreds of jumps, at which states have no solution."""
    overlaps = np.geomspace(2e-4, 3.2e-3, 200)
    found = [pressed(overlap) for overlap in overlaps]
    cells, carry, force = (np.array(column) for column in zip(*found))
    assert len(np.unique(cells)) <= len(PARTS)
    assert (np.diff(cells) != 0).sum() <= 15
    # a jump is less than a fifth of what 1.4 % more overlap make
    stiffness = np.diff(force) / np.diff(overlaps)
    assert (np.abs(np.diff(stiffness)) / stiffness[:-1]).max() < 0.2
    assert carry.min() >= 2 * ACROSS and carry.max() < 6 * ACROSS


def test_far_pieces_of_a_line_have_one_cell() -> None:
    """Two lines on four faces: with equal cells everywhere they would have 1,000."""
    cells, carry, _ = pressed(2e-4)
    assert carry >= 2 * ACROSS and cells < 6 * carry
