"""The mesh of the rigid limit: undeformed teeth on the neutral line that the cam gives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import GearName
from swgpar.geometry.profiles import ToothProfile
from swgpar.geometry.profiles.mesh_gap import smallest_gaps

WIDEST = np.radians(120.0)
"""Angle from the tip of a lobe, to both sides, in which teeth can touch, times the number of lobes."""

STEP = 1e-5
"""Rotation (rad) from which the rotation that closes a gap is extrapolated."""

NEAR = 1e-3
"""Gap (mm) below which a pair of flanks counts as in contact: what loads of rated size close."""


def flank_clearance(design: DriveDesign, n_angles: int = 721, ring: GearName = "ring_gear") -> float:
    """Smallest distance (mm; negative is interference) between the undeformed flanks in the deflected position.

    n_angles : angles of the tooth within half of a lobe;  ring : whose flanks are meant
    """
    pair, motion = (design.profile("flexible_spline"), design.profile(ring)), design.tooth_motion(ring=ring)
    widest = 0.5 * np.pi / design.lobes
    psi = np.linspace(-widest, widest, n_angles)
    # the other flank of a tooth moves like this one on the mirror image of the cam
    return min(float(smallest_gaps(*pair, side, psi).min()) for side in {motion, motion.mirror_image()})


Flanks = tuple[ToothProfile, ToothProfile]


@dataclass(frozen=True)
class RigidMesh:
    """Contact of rigid teeth.

    transmission_error : arc seconds, peak to peak of the output's rotation at which the first pair touches; inf where
        the teeth do not reach each other, or overlap at every rotation
    teeth_share : share of the flexible spline's teeth whose gap is below `NEAR` then, mean over a pitch
    """

    transmission_error: float
    teeth_share: float


def rigid_mesh(design: DriveDesign, phases: int = 8, n_points: int = 300) -> RigidMesh:
    """Contact of rigid teeth over one pitch.

    In every phase the flexible spline's material is rotated until the first pair of one side touches.

    phases : positions of the cam within a pitch of the flexible spline;  n_points : points on a flank
    """
    flanks = design.profile("flexible_spline"), design.profile("ring_gear")
    touching, gaps = _touching(design, flanks, phases, n_points)
    if not np.isfinite(touching).all():
        return RigidMesh(np.inf, 0.0)
    share = np.count_nonzero(gaps < NEAR) / phases * design.lobes / design.drive.teeth_fs
    return RigidMesh(float(np.degrees(np.ptp(touching))) * 3600.0, share)


def touching_rotation(design: DriveDesign, flanks: Flanks, n_points: int = 300) -> float:
    """Rotation (rad) of the flexible spline's material at which the first pair of one side touches, cam at angle zero.

    -inf where the teeth do not reach each other, or overlap at every rotation.

    flanks : of the spline and of the ring gear;  n_points : points on a flank
    """
    touching, _ = _touching(design, flanks, 1, n_points)
    return float(touching.item())


def _touching(design: DriveDesign, flanks: Flanks, phases: int, n_points: int) -> tuple[np.ndarray, np.ndarray]:
    """Rotations (phases, 1) rad at which the first pair touches, and the gaps (phases, n) mm of all teeth then.

    -inf where the teeth do not reach each other, or overlap at every rotation.
    """
    motion = design.tooth_motion()
    pitch = 2.0 * np.pi / design.drive.teeth_fs
    reach = int(WIDEST / design.lobes / pitch)
    psi = pitch * (np.arange(-reach, reach + 1) + np.arange(phases)[:, None] / phases)

    def gaps(rotation: np.ndarray) -> np.ndarray:
        flat = np.broadcast_to(rotation, psi.shape).ravel()
        found = smallest_gaps(*flanks, motion, psi.ravel(), n_points, flat, 0.02 * design.drive.module)
        return found.reshape(psi.shape)

    touching = np.zeros((phases, 1))
    for _ in range(2):  # the second time from where the first pair touches, so that the extrapolation is short
        before, after = gaps(touching), gaps(touching - STEP)
        with np.errstate(invalid="ignore"):
            closing = touching - STEP * before / (before - after)
        touching = np.where(np.isfinite(before) & (after < before), closing, -np.inf).max(axis=1, keepdims=True)
        if not (np.abs(touching) < 0.5 * pitch).all():
            return np.full_like(touching, -np.inf), before
    found = gaps(touching)
    if np.abs(found.min(axis=1)).max() > NEAR:
        touching = np.full_like(touching, -np.inf)
    return touching, found
