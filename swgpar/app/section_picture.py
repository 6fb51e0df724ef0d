"""Section of the teeth at an angle of the cam: outlines of the rigid bodies and gaps of their
flanks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GEARS
from swgpar.geometry.arrays import Floats
from swgpar.presentation.body_curves import body_curves, moved_points, tooth_angles
from swgpar.profiles.mesh_gap import outline

STRIDE = 32
"""Samples of a flank's outline from one place whose distance is taken to the next."""


@dataclass(frozen=True)
class FlankGaps:
    """Gaps of undeformed flanks of the flexible spline from the ring gear, of those of +x first.

    tooth : (n,) numbers from the one that is on +y at the cam's angle 0, counter-clockwise
    place : (n, 2) mm, of the flank, where it is nearest to the ring gear
    gap : (n,) mm, below 0 where flanks overlap
    """

    tooth: np.ndarray
    place: Floats
    gap: Floats


@dataclass(frozen=True)
class SectionPicture:
    """The section at an angle of the cam.

    angle_deg : of the cam, counter-clockwise
    curves : closed curves (n, 2) mm of every body, by its name
    gaps : of both flanks of all teeth
    """

    angle_deg: float
    curves: dict[str, list[Floats]]
    gaps: FlankGaps


def section_picture(design: DriveDesign, angle_deg: float = 0.0) -> SectionPicture:
    """The undeformed teeth of a design on its neutral line, the ring gear at rest."""
    angle = float(np.radians(angle_deg))
    return SectionPicture(
        angle_deg,
        body_curves(design, angle),
        _gaps(design, angle),
    )


def _gaps(design: DriveDesign, cam_angle: float) -> FlankGaps:
    """cam_angle : rad"""
    spline, ring = (outline(design.profile(gear)) for gear in GEARS)
    motion, psi = design.tooth_motion(), tooth_angles(design, cam_angle)
    pose = motion.pose(psi)
    flank = spline.point[spline.flank][::STRIDE]
    to_tooth = np.exp(1j * np.pi / motion.teeth_rg)
    place, gap = [], []
    for points in (flank, -np.conj(flank)):
        moved = pose.c[:, None] + np.exp(1j * pose.angle)[:, None] * points
        places, _ = ring.folded((moved * to_tooth).ravel())
        distance = ring.distance(places).distance.reshape(moved.shape)
        nearest = distance.argmin(axis=1)
        gap.append(distance.min(axis=1))
        both = np.column_stack([points.real, points.imag])
        every = moved_points(design, psi, both, cam_angle)
        place.append(every[np.arange(len(psi)), nearest])
    return FlankGaps(np.tile(np.arange(len(psi)), 2), np.concatenate(place), np.concatenate(gap))
