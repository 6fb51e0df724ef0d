"""Couplings of the flexible spline and of a rotating ring gear, and what supports them."""

from __future__ import annotations

import numpy as np

from swgpar.constraints.distributing_coupling import DistributingCoupling, NodeMeans
from swgpar.constraints.output_springs import OutputSprings
from swgpar.constraints.race_coupling import RaceCoupling
from swgpar.constraints.radial_guide import RadialGuide
from swgpar.constraints.rigid_attachment import RigidAttachment, face_sides
from swgpar.constraints.supports import SPLINE_COUPLING, Supports
from swgpar.design.cup_section import Cup
from swgpar.design.drive_design import DriveDesign
from swgpar.design.output_bearing import OutputBearing
from swgpar.fem.body import FLEXIBLE_SPLINE, OUTER_RACE, RING_GEAR
from swgpar.fem.elements import BodyElements, Elements
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


def build_supports(design: DriveDesign, partition: Partition, elements: Elements) -> Supports:
    """Couplings of the spline, of a ring gear that is not clamped and of a bearing; the guide of a
    rotating ring."""
    spline, copies = elements.bodies[FLEXIBLE_SPLINE], design.copies
    output_gear, bearing = design.kinematics.output_gear, design.output_bearing
    rotates, guide = output_gear != "flexible_spline", None
    couplings: list[NodeMeans] = []
    if design.has_attachment:
        attachment = spline_attachment(
            partition,
            spline,
            design.cup,
            design.penalty("flexible_spline"),
            images=copies > 1,
            moves=bearing is not None and not rotates,
        )
        couplings.append(attachment)
    else:
        # a plane section with deviations is centred by its cam alone: the wall of the cup gives way
        centred = design.has_cup or (design.drive.model == "plane" and design.deviations is None)
        couplings.append(DistributingCoupling(partition, spline, "bore", copies > 1, centred))
    if rotates or not design.frame_is_rigid:
        ring = elements.bodies[output_gear if rotates else RING_GEAR]
        ring_coupling = DistributingCoupling(partition, ring, "outer", copies > 1)
        couplings.append(ring_coupling)
        if design.frame_is_rigid:
            guide = _ring_guide(design, ring_coupling)
    spline_ratio = None
    if design.dynamic_spline is not None:  # the flexible spline rotates with the dynamic one
        spline_ratio = 1.0 if output_gear == "dynamic_spline" else 0.0
    output, race = len(couplings) - 1 if rotates else SPLINE_COUPLING, None
    if design.bearing is not None:
        outer = DistributingCoupling(partition, elements.bodies[OUTER_RACE], "outer", copies > 1)
        race = RaceCoupling(outer, couplings[0])
    return Supports(
        partition,
        couplings,
        output=output,
        guide=guide,
        scale=design.modulus_of("flexible_spline") * design.drive.module,
        share=1.0 / copies,
        race=race,
        spline_ratio=spline_ratio,
        bearing=None if bearing is None else _output_springs(bearing, couplings[output], copies),
    )


def _output_springs(section: OutputBearing, output: NodeMeans, copies: int) -> OutputSprings:
    """Springs and forces on the output. output : its coupling"""
    lever = 0.0 if section.position is None else section.position - float(output.center[2])
    return OutputSprings(section.stiffness, section.load, lever, output.movable, 1.0 / copies)


def _ring_guide(design: DriveDesign, coupling: NodeMeans) -> RadialGuide:
    """Guide around a rotating ring gear, which it follows where a bearing carries the output."""
    gear = design.kinematics.output_gear
    first, last = design.axial_range(gear)
    outer = float(np.hypot(*coupling.undeformed[:, :2].T).max(initial=0.0))
    area = 2.0 * np.pi * outer * (last - first) / design.copies
    follows = design.output_bearing is not None and design.copies == 1
    return RadialGuide(coupling, area, design.penalty(gear), design.frame_growth, follows=follows)
