"""Deviating flanks in the contact: the teeth of the ring gear are moved, those of the flexible
spline get heights.

The stiffness of a tooth sector stays that of the ideal one. The flanks of the ring gear are the
master curves of the contact: their points and tangents are moved. Heights of the flexible spline's
flanks count along the normal there and turn with the tooth, as the heights of exact flanks over
their facets do. A tilt of the ring gear changes along the width, which its curves cannot: it is
counted as height of the facing flank.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from swgpar.contact.flank_faces import face_samples
from swgpar.contact.search import FlankPair
from swgpar.fem.body_layout import BodyLayout
from swgpar.geometry.rotation import MIRROR, rotated
from swgpar.profiles.flank_deviations import GearDeviations

SIDES = (1, -1)
"""Sides of the flanks in the order of the tables."""


@dataclass(frozen=True, eq=False)
class FlankDeviations:
    """Tables of the deviations of all flanks, by tooth and side (`SIDES`).

    heights : (teeth_fs, 2, n_face, n, n) mm, of the flexible spline's flanks at the samples of
    their faces
    points, tangents : (teeth_rg, 2, n_s + 1, 2) mm and 1, of the ring gear's flanks in the frames
    of their teeth
    leans : (teeth_rg, 2, n_face, n, n) mm, heights that stand for the tilt of the ring gear; None
    without tilt
    """

    heights: np.ndarray
    points: np.ndarray
    tangents: np.ndarray
    leans: np.ndarray | None = None

    def rolled(self, teeth: int) -> FlankDeviations:
        """The deviations after the teeth have been renamed: tooth k has those of tooth k +
        `teeth`."""
        leans = None if self.leans is None else np.roll(self.leans, -teeth, axis=0)
        return FlankDeviations(
            heights=np.roll(self.heights, -teeth, axis=0),
            points=np.roll(self.points, -teeth, axis=0),
            tangents=np.roll(self.tangents, -teeth, axis=0),
            leans=leans,
        )

    def scaled(self, share: float) -> FlankDeviations:
        """A share of the deviations."""
        leans = None if self.leans is None else share * self.leans
        return FlankDeviations(
            share * self.heights, share * self.points, share * self.tangents, leans
        )

    def periods(self) -> tuple[int, int]:
        """Numbers of teeth of the flexible spline and of the ring gear after which the deviations
        repeat."""
        ring = [table for table in (self.points, self.tangents, self.leans) if table is not None]
        return _period([self.heights]), _period(ring)

    def slave_heights(self, pairs: Sequence[FlankPair], first_tooth: int) -> np.ndarray:
        """Heights (n_pair * n_face, n, n) mm of the flexible spline's faces of pairs. first_tooth :
        of sector 0"""
        side = [SIDES.index(pair.side) for pair in pairs]
        tooth = np.array([first_tooth + pair.sector for pair in pairs]) % len(self.heights)
        heights = self.heights[tooth, side]
        if self.leans is not None:
            heights = (
                heights + self.leans[[pair.ring_tooth % len(self.leans) for pair in pairs], side]
            )
        return heights.reshape(-1, *heights.shape[2:])

    def master_shifts(self, pairs: Sequence[FlankPair]) -> tuple[np.ndarray, np.ndarray]:
        """Shifts of points and changes of tangents (n_pair, n_s + 1, 2) of the ring gear's flanks
        of pairs."""
        side = [SIDES.index(-pair.side) for pair in pairs]
        tooth = [pair.ring_tooth % len(self.points) for pair in pairs]
        return self.points[tooth, side], self.tangents[tooth, side]


def _period(tables: Sequence[np.ndarray]) -> int:
    """Smallest number of teeth after which all tables repeat."""
    teeth = len(tables[0])
    scale = max(float(np.abs(table).max(initial=0.0)) for table in tables)
    for period in range(1, teeth):
        if teeth % period == 0 and all(
            np.abs(np.roll(table, -period, axis=0) - table).max() <= 1e-12 * scale
            for table in tables
        ):
            return period
    return teeth


def flank_deviations(
    spline: BodyLayout,
    ring: BodyLayout,
    of_spline: GearDeviations,
    of_ring: GearDeviations,
    axial_travel: float,
) -> FlankDeviations:
    """Tables of the deviations of both gears.

    axial_travel : mm, by which teeth in mesh have moved along z: they meet the tilted ring gear
    there
    """
    profile, teeth = spline.mesh.profile, np.arange(spline.mesh.n_sectors)
    angle = spline.sector_angle(teeth)
    heights = []
    points = []
    tangents = []
    leans = []
    ring_profile, ring_teeth = ring.mesh.profile, np.arange(ring.mesh.n_sectors)
    ring_angle = ring.sector_angle(ring_teeth)
    spline_grids = {grid.side: grid for grid in spline.mesh.flanks}
    ring_grids = {grid.side: grid for grid in ring.mesh.flanks}
    for side in SIDES:
        s, z = face_samples(spline_grids[side])
        of_tooth = of_spline.heights(profile, s.ravel(), z.ravel(), angle, side)
        heights.append(of_tooth.reshape(len(teeth), *s.shape))
        moved, turned = of_ring.flank_shift(ring_profile, ring_grids[side].s, ring_angle, side)
        points.append(moved)
        tangents.append(turned)
        if of_ring.tilt.any():
            # the facing flank lies in the slot beside the tooth; what moves the ring gear towards
            # it adds height
            normal = profile.normal(s.ravel()) * (MIRROR if side < 0 else np.ones(2))
            slot = ring_angle + 0.5 * side * ring.mesh.pitch
            away = rotated(np.broadcast_to(of_ring.tilt, (len(slot), 2)), -slot)
            leans.append(
                -((z.ravel() + axial_travel) * (away @ normal.T)).reshape(len(ring_teeth), *s.shape)
            )
    return FlankDeviations(
        heights=np.stack(heights, axis=1),
        points=np.stack(points, axis=1),
        tangents=np.stack(tangents, axis=1),
        leans=np.stack(leans, axis=1) if leans else None,
    )
