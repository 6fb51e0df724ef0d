"""Which teeth can meet: the tooth of the flexible spline in a slot of the ring gear.

A tooth in slot J (at angle J 2 pi / N_rg for a ring gear with a slot on +y) faces ring-gear tooth J
- 1 with its clockwise flank and tooth J with its counter-clockwise one. It can only touch where its
tip reaches past the tips of the ring gear.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.fem.body import FLEXIBLE_SPLINE
from swgpar.fem.body_layout import BodyLayout
from swgpar.fem.elements import BodyElements
from swgpar.fem.partition import Partition


@dataclass(frozen=True)
class FlankPair:
    """A flank of the flexible spline and the ring-gear flank it faces.

    sector : chain index in the flexible spline;  side : +1 clockwise flank, -1 counter-clockwise
    flank
    ring : chain index in the ring gear;  ring_sixths : sixths of a turn by which that tooth is
    rotated, an image
    ring_tooth : tooth number, images not brought back
    """

    sector: int
    side: int
    ring: int
    ring_sixths: int
    ring_tooth: int

    @property
    def key(self) -> tuple[int, int, int]:
        """What tells the pair from others: sector, side, number of the ring gear's tooth."""
        return self.sector, self.side, self.ring_tooth


def facing_flanks(
    partition: Partition,
    spline: BodyElements,
    ring: BodyLayout,
    u: np.ndarray,
    ring_rotation: float,
    margin: float,
) -> list[FlankPair]:
    """Pairs of flanks that can meet at displacement u (n_local, 3); the same list on every rank.

    ring : the ring gear whose flanks are meant;  ring_rotation : rad, of the ring gear as a whole
    margin : mm, how far the tip of a tooth may stay inside the tip circle of the ring gear
    """
    layout = partition.layouts[FLEXIBLE_SPLINE]
    first, end = partition.owned_sectors(FLEXIBLE_SPLINE)
    rows = np.arange(len(spline.sectors))[spline.owned]
    tips = np.concatenate([f.nodes[0] for f in layout.mesh.flanks])
    body = np.unique(np.concatenate([f.nodes.ravel() for f in layout.mesh.flanks]))
    x = spline.positions()[rows] + spline.displacement(u)[rows]
    angle = layout.chain_angle(np.arange(first, end))
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    flank = x[:, body]
    local_x, local_y = c * flank[..., 0] + s * flank[..., 1], -s * flank[..., 0] + c * flank[..., 1]
    lean = np.arctan2(-local_x.mean(axis=1), local_y.mean(axis=1))
    tip_radius = np.hypot(x[:, tips, 0], x[:, tips, 1]).max(axis=1) if len(rows) else np.zeros(0)
    table = np.concatenate(
        partition.comm.allgather(np.column_stack([angle + lean, tip_radius]).reshape(-1, 2))
    )
    pairs = []
    for k in np.flatnonzero(table[:, 1] > ring.mesh.profile.r_tip_circle - margin):
        slot = int(np.rint((table[k, 0] - ring_rotation) / ring.mesh.pitch))
        for side, tooth in ((1, slot - 1), (-1, slot)):
            index, sixths = ring.sector_of_tooth(np.array(tooth))
            if index >= 0:
                pairs.append(FlankPair(int(k), side, int(index), int(sixths), tooth))
    return pairs
