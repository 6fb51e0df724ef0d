"""Two discs beside each other along the axis, one for each lobe."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from swgpar.geometry.cams import Cam, RollerCam, WaveGenerator
from swgpar.geometry.micro_geometry import WaveGeneratorSurface, crowning

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

    def evaluate(self, xyz: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Level h (n,) mm, gradient (n, 3), Hessian (n, 3, 3) 1/mm at points (n, 3) of the cam.

        Points between the discs are `APART`.
        """
        x, y, z = np.asarray(xyz, dtype=float).T
        side = np.where(z < 0.0, -1.0, 1.0)
        reach = np.hypot(x, y - side * self.cam.reach)
        safe = np.maximum(reach, 1e-12 * self.cam.radius)
        normal = np.column_stack([x, y - side * self.cam.reach]) / safe[:, None]
        along = z - 0.5 * side * self.distance
        half = 0.5 * self.width * (1.0 + 1e-9)
        c, dc, ddc = crowning(self.crowning, np.clip(along, -half, half), self.width, self.shape)
        gradient, hessian = np.zeros((len(x), 3)), np.zeros((len(x), 3, 3))
        gradient[:, :2], gradient[:, 2] = normal, dc
        tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
        hessian[:, :2, :2] = tangent[:, :, None] * tangent[:, None, :] / safe[:, None, None]
        hessian[:, 2, 2] = ddc
        beside = np.abs(along) > half
        return np.where(beside, APART, reach - self.cam.radius + c), gradient, hessian


CamSurface = WaveGeneratorSurface | TwoDiscSurface


class GrownSurface:
    """Level function of a surface that has grown alike in all directions.

    surface : before;  strain : of its growth
    """

    def __init__(self, surface: CamSurface, strain: float) -> None:
        self.surface, self.factor = surface, 1.0 + strain

    def evaluate(self, xyz: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Level h (n,) mm, gradient (n, 3), Hessian (n, 3, 3) 1/mm at points (n, 3) mm."""
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
