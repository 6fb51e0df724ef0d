"""The attachment of the flexible spline, and the springs of a bearing of the output."""

from __future__ import annotations

import numpy as np

from swgpar.constraints.distributing_coupling import NodeMeans
from swgpar.constraints.output_springs import OutputSprings
from swgpar.constraints.rigid_attachment import RigidAttachment, face_sides
from swgpar.design.cup_section import Cup
from swgpar.design.output_bearing import OutputBearing
from swgpar.fem.elements import BodyElements
from swgpar.fem.partition import Partition
from swgpar.log import logger
from swgpar.materials import NO_GROWTH
from swgpar.meshing.sector import SectorMesh


def spline_attachment(
    partition: Partition,
    spline: BodyElements,
    cup: Cup,
    penalty: float,
    *,
    images: bool,
    moves: bool = False,
) -> RigidAttachment:
    """Attachment of closed end or flange, which is clamped or bolted to a flange that grows as it.

    penalty : MPa / mm;  images : whether the model is a part of the drive
    moves : whether a bearing carries the flange
    """
    if cup.attachment == "bolted":
        _warn_of_wide_elements(spline.layout.mesh, cup)
    return RigidAttachment(
        partition,
        spline,
        "end",
        cup.is_attached,
        cup.attached_width,
        penalty=penalty,
        images=images,
        growth=spline.layout.body.growths[0] if spline.layout.body.growths else NO_GROWTH,
        moves=moves,
    )


def _warn_of_wide_elements(mesh: SectorMesh, cup: Cup) -> None:
    """Tell where elements in the ring of the washers are wider than these."""
    middles = np.hypot(*mesh.coords[mesh.faces["end"]][..., :2].mean(axis=1).T)
    low, high = cup.attached_ring
    longest = float(face_sides(mesh, "end")[(low < middles) & (middles < high)].max())
    if longest > cup.washer_diameter:
        logger.warning(
            "elements between the bolts are up to %.3g mm wide, a washer is %.3g mm wide: a mesh "
            "with narrower elements there holds the bolts better",
            longest,
            cup.washer_diameter,
        )


def output_springs(section: OutputBearing, output: NodeMeans, copies: int) -> OutputSprings:
    """Springs and forces on the output. output : its coupling"""
    lever = 0.0 if section.position is None else section.position - float(output.center[2])
    return OutputSprings(section.stiffness, section.load, lever, output.movable, 1.0 / copies)
