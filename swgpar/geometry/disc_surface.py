"""Two discs beside each other along the axis, one for each lobe."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from swgpar.geometry.cams import Cam, RollerCam, WaveGenerator
from swgpar.geometry.cams.piecewise import Circle
from swgpar.geometry.micro_geometry import Level, WaveGeneratorSurface, crowned, crowning

APART = 1.0
"""Level (mm) of points beside a disc: nothing touches there."""


@dataclass(frozen=True, eq=False)
class TwoDiscSurface:
    """Level function of two crowned discs: that on +y lies at z > 0, the other one at z < 0.

    cam : circles of the discs
    width, distance : mm, of a disc, and between the middles of both
    crowning : mm, at the ends of a disc;  shape : "parabolic" or "circular", of the crowning
    """

    slope: ClassVar[float] = 0.0

    cam: RollerCam
    width: float
    distance: float
    crowning: float
    shape: str

    def evaluate(self, xyz: np.ndarray) -> Level:
        """Level, gradient and Hessian at points (n, 3) mm of the cam.

        Points between the discs are `APART`.
        """
        z = xyz[:, 2]
        side = np.where(z < 0.0, -1.0, 1.0)
        disc = Circle(self.cam.center, self.cam.radius)
        distance, normal, k = disc.evaluate(xyz[:, :2] * side[:, None])
        along = z - 0.5 * side * self.distance
        half = 0.5 * self.width * (1.0 + 1e-9)
        removed = crowning(self.crowning, np.clip(along, -half, half), self.width, self.shape)
        curve = distance, normal * side[:, None], k
        level, gradient, hessian = crowned(curve, removed)
        return np.where(np.abs(along) > half, APART, level), gradient, hessian


CamSurface = WaveGeneratorSurface | TwoDiscSurface


class GrownSurface:
    """Level function of a surface that has grown alike in all directions.

    surface : before;  strain : of its growth
    """

    def __init__(self, surface: CamSurface, strain: float) -> None:
        self.surface, self.factor = surface, 1.0 + strain

    def evaluate(self, xyz: np.ndarray) -> Level:
        """Level, gradient and Hessian at points (n, 3) mm."""
        level, gradient, hessian = self.surface.evaluate(xyz / self.factor)
        return level * self.factor, gradient, hessian / self.factor


def cam_surface(
    keys: WaveGenerator, cam: Cam, crowned: float, slope: float, shape: str
) -> CamSurface:
    """Surface of a cam, or of two discs.

    keys : section [wave_generator] of the design file;  cam : its curve
    crowned, slope : mm, at the ends of the cam, or of each disc
    """
    if isinstance(cam, RollerCam) and keys.width > keys.face_width:
        distance = keys.width - keys.face_width
        return TwoDiscSurface(cam, keys.face_width, distance, crowned, shape)
    return WaveGeneratorSurface(cam, keys.face_width, crowned, slope, shape, keys.lobes)
