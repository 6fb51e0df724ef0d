"""Rigid teeth: undeformed flanks on the neutral line that the cam gives."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from swgpar.profiles.flank import ToothProfile
from swgpar.profiles.mesh_gap import NearestPlace, OutlinePair, nearest_place, outline
from swgpar.profiles.tooth_motion import ToothMotion

STEP = 1e-5
"""Rotation (rad) from which the rotation that closes a gap is extrapolated."""

NEAR = 1e-3
"""Gap (mm) below which a pair of flanks counts as in contact: what loads of rated size close."""


EXACT = 0.02
"""Gap over the module below which a pair is looked at closely: the first to touch is one of
these."""


@dataclass(frozen=True)
class RigidMesh:
    """Contact of rigid teeth.

    transmission_error : arc seconds, peak to peak of the output's rotation at which the first pair
    touches; inf where the teeth do not reach each other, or overlap at every rotation
    teeth_share : share of the flexible spline's teeth whose gap is below `NEAR` then, mean over a
    pitch
    """

    transmission_error: float
    teeth_share: float


@dataclass(frozen=True)
class RigidTeeth:
    """Undeformed teeth of the flexible spline and of a ring gear in the deflected position.

    spline, ring : flanks;  motion : of the spline's tooth in its slot;  module : mm
    """

    spline: ToothProfile
    ring: ToothProfile
    motion: ToothMotion
    module: float

    @cached_property
    def _pair(self) -> OutlinePair:
        return OutlinePair(outline(self.spline), outline(self.ring), self.motion)

    def nearest_place(self) -> NearestPlace:
        """Where teeth come nearest to each other, or overlap most, between the minor axes.

        Both flanks, top lands and roots of a tooth meet those of all slots that it passes.
        """
        # the other half of a tooth moves like this one on the mirror image of the cam
        image = self.motion.mirror_image()
        nearest = nearest_place(self.spline, self.ring, self.motion)
        if image != self.motion:
            other = nearest_place(self.spline, self.ring, image)
            if other.distance < nearest.distance:
                nearest = replace(other, psi=-other.psi)
        return nearest

    def clearance(self) -> float:
        """Smallest distance (mm; negative is interference) between the teeth."""
        return self.nearest_place().distance

    def mesh(self, phases: int = 8) -> RigidMesh:
        """Contact over one pitch.

        In every phase the flexible spline's material is rotated until the first pair of one side
        touches.

        phases : positions of the cam within a pitch of the flexible spline
        """
        touching, gaps = self._touching(phases)
        if not np.isfinite(touching).all():
            return RigidMesh(np.inf, 0.0)
        near = np.count_nonzero(gaps < NEAR) / phases
        share = near * self.motion.line.lobes / self.motion.teeth_fs
        return RigidMesh(float(np.degrees(np.ptp(touching))) * 3600.0, share)

    def touching_rotation(self) -> float:
        """Rotation (rad) of the spline's material at which the first pair of one side touches, cam
        at angle zero.

        -inf where the teeth do not reach each other, or overlap at every rotation.
        """
        touching, _ = self._touching(1)
        return float(touching.item())

    def _touching(self, phases: int) -> tuple[np.ndarray, np.ndarray]:
        """Rotations (phases, 1) rad at which the first pair touches, and the gaps (phases, n) mm of
        all teeth then.

        -inf where the teeth do not reach each other, or overlap at every rotation.
        """
        pitch = 2.0 * np.pi / self.motion.teeth_fs
        reach = self.motion.teeth_fs // (2 * self.motion.line.lobes)
        psi = pitch * (np.arange(-reach, reach + 1) + np.arange(phases)[:, None] / phases)

        near = np.ones(psi.shape, dtype=bool)

        def gaps(rotation: np.ndarray) -> np.ndarray:
            """Gaps (phases, n) mm of the teeth that are near; inf of the others."""
            found = np.full(psi.shape, np.inf)
            turned = np.broadcast_to(rotation, psi.shape)[near]
            found[near] = self._pair.facing_gaps(psi[near], turned, EXACT * self.module)
            return found

        touching = np.zeros((phases, 1))
        # the second time from where the first pair touches, so that the extrapolation is short
        for _ in range(2):
            before = gaps(touching)
            after = gaps(touching - STEP)
            with np.errstate(divide="ignore", invalid="ignore"):
                closing = touching - STEP * before / (before - after)
            touching = np.where(after < before, closing, -np.inf).max(axis=1, keepdims=True)
            if not (np.abs(touching) < 0.5 * pitch).all():
                return np.full_like(touching, -np.inf), before
            # no gap changes by more than the rotation moves the tips
            moved = self.spline.r_tip_circle * (np.abs(touching) + STEP)
            near &= before < EXACT * self.module + 2.0 * moved
        smallest = gaps(touching)
        if np.abs(smallest.min(axis=1)).max() > NEAR:
            touching = np.full_like(touching, -np.inf)
        return touching, smallest
