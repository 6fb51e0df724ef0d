"""Areas of the ring gear that undeformed teeth of the flexible spline cover: where they overlap at
one angle of the cam, and on their whole path between the minor axes.

In the frame of a slot, at every radius, the tooth reaches to an angle on either side, and the
material of the ring gear begins at another one. Samples of the flank, and of the path, are joined
by chords.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from swgpar.geometry.arrays import Floats
from swgpar.geometry.rotation import rotated
from swgpar.presentation.body_curves import tooth_angles
from swgpar.profiles.flank import ToothProfile
from swgpar.profiles.mesh_gap import Outline, outline
from swgpar.profiles.polyline import clockwise_from_y
from swgpar.profiles.tooth_motion import ToothMotion

STRIDE = 8
"""Samples of an outline from one point to the next."""

RADII, PLACES = 129, 361
"""Radii of the ring gear's teeth, and places of the path between minor axes."""

TURN = 2.0 * np.pi

SIDES = 1.0, -1.0
"""Clockwise of the middle of a slot, and counter-clockwise."""

SHALLOW = 1e-5
"""Overlap over the module that is not drawn: chords of a concave flank leave it."""


@dataclass(frozen=True, eq=False)
class SlotOverlap:
    """The ring gear's flanks of one slot, and how far the other gear's tooth reaches into them.

    spline : outline of the other gear's tooth;  motion : its motion;  module : mm
    radii : (r,) mm;  pitch : rad, of the ring gear
    flank : (r,) rad, angles from the middle of the slot at which its material begins
    """

    spline: Outline
    motion: ToothMotion
    module: float
    radii: Floats
    pitch: float
    flank: Floats

    def reach(self, psi: Floats, side: float) -> Floats:
        """Largest angles (n, r) rad of the tooth from the middle of the slot at the material angles
        psi (n,) rad, to the side +1, clockwise, or -1; -inf beyond its tip."""
        half, edge = self.spline.point, self.spline.flank.start
        land, flank = half[:edge:STRIDE], half[edge : self.spline.flank.stop + 1 : STRIDE]
        points = np.concatenate([land, flank])
        points = points if side > 0.0 else -np.conj(points)
        pose, end = self.motion.pose(psi), len(land)
        turn = pose.turn[:, None]
        tips = np.abs(pose.c[:, None] + turn * points[: end + 1])
        rows = np.flatnonzero(tips.max(axis=1) > self.radii[0])
        placed = pose.c[rows, None] + turn[rows] * points
        radius, angle = np.abs(placed), side * clockwise_from_y(placed)
        reach = np.empty((len(rows), len(self.radii)))
        for k in range(len(rows)):
            # from the root, below which there is the rim, to the edge of the tip
            known = radius[k, end:][::-1], angle[k, end:][::-1]
            reach[k] = np.interp(self.radii, *known, left=self.pitch)
        beyond = self.radii > radius[:, end, None]
        reach[beyond] = -np.inf
        row, at = np.nonzero(beyond & (self.radii <= tips[rows].max(axis=1)[:, None]))
        below = radius[row, : end + 1] >= self.radii[at, None]
        reach[row, at] = np.where(below, angle[row, : end + 1], -np.inf).max(axis=1)
        found = np.full((len(psi), len(self.radii)), -np.inf)
        found[rows] = reach
        return np.minimum(found, 0.5 * self.pitch)

    def areas(self, reach: Floats, side: float) -> list[Floats]:
        """Closed curves (m, 2) mm around what a tooth covers that reaches to the angles (r,) rad,
        in the slot on +y."""
        over = reach - self.flank
        deep = np.isfinite(over) & (over * self.radii > SHALLOW * self.module)
        ends = np.flatnonzero(np.diff(np.concatenate([[0], deep.astype(int), [0]])))
        curves = []
        for begin, end in ends.reshape(-1, 2):
            radius, first, last = (each[begin:end] for each in (self.radii, self.flank, reach))
            angle = side * np.concatenate([first, last[::-1]])
            around = np.concatenate([radius, radius[::-1]])
            curves.append(np.column_stack([around * np.sin(angle), around * np.cos(angle)]))
        return curves

    @cached_property
    def path(self) -> list[Floats]:
        """What teeth cover while the cam turns by one lobe: closed curves (m, 2) mm in the slot on
        +y, the same in all slots."""
        psi = np.linspace(-np.pi, np.pi, PLACES) / self.motion.line.lobes
        alike = self.motion == self.motion.mirror_image()
        reaches = [self.reach(psi, side).max(axis=0) for side in SIDES[: 1 if alike else 2]]
        return self._areas_of([reaches[0], reaches[-1]])

    def covered(self, cam_angle: float) -> list[Floats]:
        """What the teeth of the whole drive cover at an angle of the cam, rad; closed curves (m, 2)
        mm. The ring gear rests, with a slot on +y."""
        lobe, psi = 2.0 * np.pi / self.motion.line.lobes, tooth_angles(self.motion, cam_angle)
        passed = np.round(psi / lobe)
        # at every lobe the teeth are one slot further, or several
        slots = np.arange(len(psi)) + passed * (self.motion.teeth_rg - len(psi)) * lobe / TURN
        reaches = [self.reach(psi - passed * lobe, side) for side in SIDES]
        return [
            rotated(curve, slots[k] * self.pitch)
            for k in range(len(psi))
            for curve in self._areas_of([reach[k] for reach in reaches])
        ]

    def _areas_of(self, reaches: Sequence[Floats]) -> list[Floats]:
        """Closed curves on both sides."""
        return [
            curve
            for side, reach in zip(SIDES, reaches, strict=True)
            for curve in self.areas(reach, side)
        ]


@lru_cache(maxsize=16)
def slot_overlap(
    spline: ToothProfile, ring: ToothProfile, motion: ToothMotion, module: float
) -> SlotOverlap:
    """Of two profiles and the motion of the flexible spline's tooth. module : mm"""
    moving, resting = outline(spline), outline(ring)
    psi = np.linspace(-np.pi, np.pi, PLACES) / motion.line.lobes
    pose, tips = motion.pose(psi), moving.point[: moving.flank.start + 1 : STRIDE]
    farthest = float(np.abs(pose.c[:, None] + pose.turn[:, None] * tips).max())
    radii = np.linspace(ring.r_tip_circle, max(farthest, ring.r_tip_circle), RADII)
    flank = resting.point[resting.flank]
    begins = np.interp(
        radii, np.abs(flank), 0.5 * resting.pitch - clockwise_from_y(flank), right=0.0
    )
    return SlotOverlap(moving, motion, module, radii, resting.pitch, begins)
