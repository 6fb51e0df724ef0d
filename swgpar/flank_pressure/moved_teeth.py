"""Exact flanks, crowning included, moved with their teeth: each section of a tooth follows the mesh
as a rigid body."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy

from swgpar.fem.body_layout import BodyLayout
from swgpar.geometry.micro_geometry import FlankCrowning
from swgpar.geometry.rotation import MIRROR, rotated
from swgpar.meshing.sector import FlankGrid
from swgpar.profiles import ToothProfile


class MovedTooth:
    """A flank of a tooth, moved section by section.

    Parameters
    ----------
    layout, tooth, side : body, number and flank;  u : (n_node, 3) mm, displacement of its sector in
    the drive's frame
    crowned : crowning of the flank

    Attributes
    ----------
    body : its name;  profile : of the flank
    angle : rad, of the sector;  ends : mm, of its face width
    """

    def __init__(
        self,
        layout: BodyLayout,
        tooth: int,
        side: int,
        u: np.ndarray,
        crowned: FlankCrowning,
    ) -> None:
        assert layout.mesh.profile is not None  # all gears have one
        self.body, self.profile = layout.name, layout.mesh.profile
        self.mirror = MIRROR if side < 0 else np.ones(2)
        self.angle = float(layout.sector_angle(np.array(tooth)))
        self.crowned = crowned
        z = layout.mesh.flanks[0].z
        self.ends = float(z[0]), float(z[-1])
        self._at: Callable[[np.ndarray], np.ndarray]
        if layout.mesh.plane:  # its sections move alike
            motion = self._motion(layout, u, 0)
            self._at = lambda at: np.broadcast_to(motion, (len(at), len(motion)))
        else:
            motions = np.array([self._motion(layout, u, station) for station in range(len(z))])
            self._at = scipy.interpolate.CubicSpline(z, motions)

    def _motion(self, layout: BodyLayout, u: np.ndarray, station: int) -> np.ndarray:
        """Middle before and after (2 + 2) mm and rotation (rad) of the section that fits its nodes
        best."""
        nodes = np.concatenate(
            [_active(grid, self.profile, station) for grid in layout.mesh.flanks]
        )
        before = layout.mesh.coords[nodes, :2]
        after = before + rotated(u[nodes, :2], -self.angle)
        # the rotation that fits best is that of the polar decomposition
        middle, moved = before.mean(axis=0), after.mean(axis=0)
        a, b = (before - middle).T @ (after - moved)
        return np.array([*middle, *moved, np.arctan2(a[1] - b[0], a[0] + b[1])])

    def sections(self, z: np.ndarray) -> Sections:
        """The sections at z (n,) mm."""
        return Sections(self, self._at(z), self.crowned.removed(z))


class Sections:
    """Sections of a tooth. motion : (n, 5), as of `MovedTooth`;  cut : (n,) mm, crowning"""

    def __init__(self, tooth: MovedTooth, motion: np.ndarray, cut: np.ndarray) -> None:
        self.tooth, self._cut = tooth, cut
        self._middle, self._moved, self._turn = motion[:, :2], motion[:, 2:4], motion[:, 4]

    def from_profile(self, s: np.ndarray) -> np.ndarray:
        """Points (m, n, 2) of the drive's frame, of the flank at arc lengths s (m, n) mm on the n
        sections."""
        profile, flat = self.tooth.profile, s.ravel()
        removed = profile.crowning_weight(flat).reshape(s.shape) * self._cut
        point = profile.point(flat).reshape(*s.shape, 2)
        point = (
            point - removed[..., None] * profile.normal(flat).reshape(point.shape)
        ) * self.tooth.mirror
        return rotated(self._moved + rotated(point - self._middle, self._turn), self.tooth.angle)

    def distance(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distance (m, n) mm of points (m, n, 2) of the drive's frame, and arc length (m, n) mm of
        their feet."""
        local = rotated(points, -self.tooth.angle)
        local = (self._middle + rotated(local - self._moved, -self._turn)) * self.tooth.mirror
        distance, foot = self.tooth.profile.distance(local.reshape(-1, 2))
        removed = self.tooth.profile.crowning_weight(foot).reshape(points.shape[:2]) * self._cut
        return distance.reshape(points.shape[:2]) + removed, foot.reshape(points.shape[:2])


def _active(grid: FlankGrid, profile: ToothProfile, station: int) -> np.ndarray:
    """Nodes (n,) of the active part of a flank, above its root, at a station."""
    above = grid.s <= profile.root_start * (1.0 + 1e-9)
    return grid.nodes[above if above.sum() > 2 else slice(None), station]
