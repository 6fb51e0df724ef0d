"""The outer surface of a bearing's race in a known state, as a rigid surface.

Windows of the flexible spline touch it. The gap is that of `RaceContact`: the distance across the
axis from the smooth curve through the nodes of the race at the same z, both undeformed.
"""

from __future__ import annotations

import numpy as np

from swgpar.contact.smooth_curve import NODES, foot_points, smooth_curve


class RaceSurface:
    """A part of the race's outer surface, for points of known height; meets `RigidSurface`.

    undeformed, deformed : (n_around, n_z, 3) mm, positions of its nodes in the cam's frame,
    counter-clockwise, one more on each side than the part has
    z, relief : (n,) mm, of the points that are evaluated, undeformed, and the gap there
    """

    def __init__(
        self, undeformed: np.ndarray, deformed: np.ndarray, z: np.ndarray, relief: np.ndarray
    ) -> None:
        pieces = np.arange(len(deformed) - NODES + 1)[:, None] + np.arange(NODES)
        self.nodes = deformed[pieces][..., :2]
        self.polynomials = smooth_curve(undeformed[pieces][:, :, 0, :2])
        self.relief, heights = relief, undeformed[0, :, 2]
        self.layer = np.clip(np.searchsorted(heights, z) - 1, 0, len(heights) - 2)
        low, high = heights[self.layer], heights[self.layer + 1]
        self.upper = np.clip((z - low) / (high - low), 0.0, 1.0)[:, None, None]
        self._middle = complex(*deformed[len(deformed) // 2, 0, :2])
        self._angle = self._angle_of(deformed[1:-1, 0])

    def _angle_of(self, points: np.ndarray) -> np.ndarray:
        """Angles (n,) rad of points (n, 2 or 3) from the middle of the part."""
        return np.angle((points[:, 0] + 1j * points[:, 1]) / self._middle)

    def evaluate(self, xyz: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """See `RigidSurface`. As that of `RaceContact` the gradient has no part along z."""
        angle = self._angle_of(xyz)
        piece = np.clip(np.searchsorted(self._angle, angle) - 1, 0, len(self.nodes) - 1)
        low, high = self._angle[piece], self._angle[piece + 1]
        nodes = (1.0 - self.upper) * self.nodes[piece, :, self.layer]
        nodes += self.upper * self.nodes[piece, :, self.layer + 1]
        place = (angle - low) / (high - low)
        foot = foot_points(self.polynomials[piece], nodes, xyz[:, :2], place)
        length = np.sum(foot.tangent**2, axis=1)
        distance, bend = (np.sum(foot.normal * one, axis=1) for one in (foot.away, foot.bend))
        gradient, hessian = np.zeros((len(xyz), 3)), np.zeros((len(xyz), 3, 3))
        gradient[:, :2] = foot.normal
        factor = -bend / (length * (length - distance * bend))
        hessian[:, :2, :2] = np.einsum("n,ni,nj->nij", factor, foot.tangent, foot.tangent)
        return distance + self.relief, gradient, hessian
