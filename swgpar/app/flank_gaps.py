"""Gaps of the rigid flanks in the section of the teeth, at an angle of the cam."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GearName
from swgpar.geometry.arrays import Floats, as_points
from swgpar.presentation.body_curves import moved_points, tooth_angles
from swgpar.profiles.mesh_gap import outline

STRIDE = 32
"""Samples of a flank's outline from one place whose distance is taken to the next."""

NEAR = 0.2
"""Gap over the module below which a flank is near its partner."""


@dataclass(frozen=True)
class FlankGaps:
    """Gaps of the undeformed flanks of the flexible spline that are near a ring gear.

    tooth : (n,) numbers from the one that is on +y at the cam's angle 0, counter-clockwise
    clockwise : (n,) whether it is the flank on that side of the tooth
    place : (n, 2) mm, of the flank, where it is nearest to that ring gear
    gap : (n,) mm, below 0 where flanks overlap
    """

    tooth: np.ndarray
    clockwise: np.ndarray
    place: Floats
    gap: Floats

    def taken(self, index: np.ndarray) -> FlankGaps:
        """Some of these, or all in another order. index : their numbers, or (n,) whether each is"""
        return FlankGaps(*(getattr(self, one.name)[index] for one in fields(self)))


def flank_gaps(
    design: DriveDesign, angle_deg: float = 0.0, gear: GearName = "ring_gear"
) -> FlankGaps:
    """Gaps of undeformed teeth on the neutral line, those of the flanks of +x first.

    angle_deg : of the cam, counter-clockwise; the ring gear rests
    gear : ring gear to which they are, that at rest or the dynamic spline
    """
    cam_angle = float(np.radians(angle_deg))
    spline, ring = (outline(design.profile(one)) for one in ("flexible_spline", gear))
    motion = design.tooth_motion(ring=gear)
    psi = tooth_angles(design.tooth_motion(), cam_angle)
    # teeth have the same gaps at all lobes, where these are whole pitches apart
    alike = motion.line.lobes if motion.teeth_fs % motion.line.lobes == 0 else 1
    pose, near = motion.pose(psi[: len(psi) // alike]), NEAR * design.drive.module
    flank = spline.point[spline.flank][::STRIDE]
    to_tooth = np.exp(1j * np.pi / motion.teeth_rg)
    found = []
    for clockwise, points in ((True, flank), (False, -np.conj(flank))):
        moved = pose.c[:, None] + pose.turn[:, None] * points
        # the ring gear has no material nearer to the axis than its tips
        looked = np.abs(moved) > np.abs(ring.point).min() - near
        distance = np.full(moved.shape, np.inf)
        distance[looked] = ring.distance(ring.folded(moved[looked] * to_tooth)[0]).distance
        distance = np.tile(distance, (alike, 1))
        tooth = np.flatnonzero(distance.min(axis=1) < near)
        nearest = distance[tooth].argmin(axis=1)
        both = as_points(points)
        places = moved_points(motion.line, psi[tooth], both, cam_angle)
        index = np.arange(len(tooth))
        side = np.full(len(tooth), clockwise)
        found.append((tooth, side, places[index, nearest], distance[tooth, nearest]))
    return FlankGaps(*map(np.concatenate, zip(*found, strict=True)))
