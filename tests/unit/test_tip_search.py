"""A flank whose tip reaches past the other tip by less than half of a face: the middle of the face
has no foot there."""

from __future__ import annotations

import numpy as np
import pytest

from support.contact_blocks import CLOSED, PAIR, Blocks, Surface, arc_block
from swgpar.materials import Isotropic

STEEL = Isotropic(E=210e3, nu=0.3)
Z, DEPTHS = np.array([-0.5, 0.5]), np.linspace(0.0, 0.5, 3)
OVERLAP = 1e-3


def blocks_at_tips(reach: float) -> Blocks:
    """The upper block's faces are 0.5 mm long and begin `reach` (mm) before the end of the lower
    one, whose last facet is 0.02 mm long."""
    ends = np.array([0.0, 0.3, 0.6, 0.98, 1.0])
    lower = arc_block(ends, DEPTHS, Z, Surface((0.0, 0.0), 0.0, 1), STEEL)
    surface = Surface((1.0 - reach, -OVERLAP), 0.0, -1)
    upper = arc_block(np.array([0.0, 0.5, 1.0]), DEPTHS, Z, surface, STEEL)
    return Blocks(lower, upper, np.zeros((len(lower.points) + len(upper.points), 3), dtype=bool))


@pytest.mark.parametrize("reach", [0.1, 0.3])
def test_a_short_overlap_of_tips_is_found(reach: float) -> None:
    """With 0.3 mm the middle of the face has a foot. The force is that of all faces."""
    blocks = blocks_at_tips(reach)
    u = np.zeros_like(blocks.points)
    blocks.search(u)
    force = -float(blocks.forces(u)[blocks.first :, 1].sum())
    assert force > 0.0
    blocks.take_all_faces()
    blocks.flanks.reset()
    assert force == -float(blocks.forces(u)[blocks.first :, 1].sum())


def test_a_short_overlap_of_tips_is_not_overlooked() -> None:
    """Where a search before it left the face out, there is another one."""
    blocks = blocks_at_tips(0.1)
    u = np.zeros_like(blocks.points)
    blocks.search(u)
    assert not blocks.flanks.overlooked([PAIR], u, CLOSED)
    blocks.flanks.cells.near = np.zeros(0, dtype=np.int64)
    assert blocks.flanks.overlooked([PAIR], u, CLOSED)
