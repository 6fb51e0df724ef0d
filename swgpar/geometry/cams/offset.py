"""Parallel curves of cams: the outside of a bearing on a cam, a fit with clearance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.geometry.arrays import SignedDistance
from swgpar.geometry.cams.curve import Cam


@dataclass(frozen=True)
class OffsetCam:
    """The curve at the distance `offset` (mm) outside of a cam; inside where it is below 0."""

    cam: Cam
    offset: float

    def evaluate(self, xy: np.ndarray) -> SignedDistance:
        """Signed distance, outward normal and Hessian factor at points (n, 2) mm near the curve.

        Curves at a constant distance from each other have the same normals and Hessians.
        """
        distance, normal, k = self.cam.evaluate(xy)
        return distance - self.offset, normal, k

    def outline(self, n: int) -> np.ndarray:
        """Points (n, 2), mm, of the curve, on the normals of those of the cam."""
        points = self.cam.outline(n)
        return points + self.offset * self.cam.evaluate(points)[1]
