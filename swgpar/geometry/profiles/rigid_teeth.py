"""Rigid teeth: undeformed flanks on the neutral line that the cam gives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.geometry.profiles.flank import ToothProfile
from swgpar.geometry.profiles.mesh_gap import smallest_gaps
from swgpar.geometry.profiles.tooth_motion import ToothMotion

WIDEST = np.radians(120.0)
"""Angle from the tip of a lobe, to both sides, in which teeth can touch, times the number of
lobes."""

STEP = 1e-5
"""Rotation (rad) from which the rotation that closes a gap is extrapolated."""

NEAR = 1e-3
"""Gap (mm) below which a pair of flanks counts as in contact: what loads of rated size close."""


@dataclass(frozen=True)
class RigidMesh:
    """Contact of rigid teeth.

    transmission_error : arc seconds, peak to peak of the output's rotation at which the first pair
    touches; inf where
        the teeth do not reach each other, or overlap at every rotation
    teeth_share : share of the flexible spline's teeth whose gap is below `NEAR` then, mean over a
    pitch
    """

    transmission_error: float
    teeth_share: float


@dataclass(frozen=True)
class RigidTeeth:
    """Undeformed teeth of the flexible spline and of a ring gear in the deflected position.

    spline, ring : flanks;  motion : of the spline's tooth in its slot
    lobes : of the cam;  teeth : of the flexible spline;  module : mm
    """

    spline: ToothProfile
    ring: ToothProfile
    motion: ToothMotion
    lobes: int
    teeth: int
    module: float

    def clearance(self, n_angles: int = 721) -> float:
        """Smallest distance (mm; negative is interference) between the flanks.

        n_angles : angles of the tooth within half of a lobe
        """
        widest = 0.5 * np.pi / self.lobes
        psi = np.linspace(-widest, widest, n_angles)
        # the other flank of a tooth moves like this one on the mirror image of the cam
        sides = {self.motion, self.motion.mirror_image()}
        return min(float(smallest_gaps(self.spline, self.ring, side, psi).min()) for side in sides)

    def mesh(self, phases: int = 8, n_points: int = 300) -> RigidMesh:
        """Contact over one pitch.

        In every phase the flexible spline's material is rotated until the first pair of one side
        touches.

        phases : positions of the cam within a pitch of the flexible spline;  n_points : points on a
        flank
        """
        touching, gaps = self._touching(phases, n_points)
        if not np.isfinite(touching).all():
            return RigidMesh(np.inf, 0.0)
        share = np.count_nonzero(gaps < NEAR) / phases * self.lobes / self.teeth
        return RigidMesh(float(np.degrees(np.ptp(touching))) * 3600.0, share)

    def touching_rotation(self, n_points: int = 300) -> float:
        """Rotation (rad) of the spline's material at which the first pair of one side touches, cam
        at angle zero.

        -inf where the teeth do not reach each other, or overlap at every rotation. n_points :
        points on a flank
        """
        touching, _ = self._touching(1, n_points)
        return float(touching.item())

    def _touching(self, phases: int, n_points: int) -> tuple[np.ndarray, np.ndarray]:
        """Rotations (phases, 1) rad at which the first pair touches, and the gaps (phases, n) mm of
        all teeth then.

        -inf where the teeth do not reach each other, or overlap at every rotation.
        """
        pitch = 2.0 * np.pi / self.teeth
        reach = int(WIDEST / self.lobes / pitch)
        psi = pitch * (np.arange(-reach, reach + 1) + np.arange(phases)[:, None] / phases)

        def gaps(rotation: np.ndarray) -> np.ndarray:
            flat, exact = np.broadcast_to(rotation, psi.shape).ravel(), 0.02 * self.module
            smallest = smallest_gaps(
                self.spline, self.ring, self.motion, psi.ravel(), n_points, flat, exact
            )
            return smallest.reshape(psi.shape)

        touching = np.zeros((phases, 1))
        for _ in range(
            2
        ):  # the second time from where the first pair touches, so that the extrapolation is short
            before, after = gaps(touching), gaps(touching - STEP)
            with np.errstate(invalid="ignore"):
                closing = touching - STEP * before / (before - after)
            touching = np.where(np.isfinite(before) & (after < before), closing, -np.inf).max(
                axis=1, keepdims=True
            )
            if not (np.abs(touching) < 0.5 * pitch).all():
                return np.full_like(touching, -np.inf), before
        smallest = gaps(touching)
        if np.abs(smallest.min(axis=1)).max() > NEAR:
            touching = np.full_like(touching, -np.inf)
        return touching, smallest
