"""Crowning and slope: microns taken from the cam and from the flanks (section 7.12).

Sign of the slope, with theta from the major axis and z towards the closed end: the cam's surface is
moved radially by -s (2 z / F_w) cos(n theta), n lobes. s > 0 raises the edge under the open end at
the major axis, so that the surface follows the cone of the deflected cup (section 7.12); s < 0 is
the sense of the words of section 7.13.3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.geometry.arrays import Floats, SignedDistance
from swgpar.geometry.cams import Cam


def crowning(
    amount: float, z: np.ndarray, width: float, shape: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Material removed at z (n,), mm, and its first two derivatives (mm, -, 1/mm).

    `amount` at |z| = width / 2, nothing at mid-width; "parabolic", or "circular": an arc.
    """
    z = np.asarray(z, dtype=float)
    if amount == 0.0:
        return np.zeros_like(z), np.zeros_like(z), np.zeros_like(z)
    if shape == "parabolic":
        k = 4.0 * amount / width**2
        return k * z**2, 2.0 * k * z, np.full_like(z, 2.0 * k)
    radius = (0.25 * width**2 + amount**2) / (2.0 * amount)
    root = np.sqrt(radius**2 - z**2)
    return radius - root, z / root, radius**2 / root**3


@dataclass(frozen=True)
class FlankCrowning:
    """Crowning of the flanks of a gear.

    amount : mm, at the ends of its face width, `width` (mm);  shape : see `crowning`
    middle : mm, z of the middle of its face width
    """

    amount: float = 0.0
    width: float = 1.0
    shape: str = "parabolic"
    middle: float = 0.0

    def removed(self, z: np.ndarray) -> Floats:
        """Material removed (n,) mm along the normal of a flank at z (n,) mm; beyond the ends as
        much as there."""
        half = 0.5 * self.width
        along = np.clip(np.asarray(z) - self.middle, -half, half)
        return crowning(self.amount, along, self.width, self.shape)[0]


NO_CROWNING = FlankCrowning()
"""Of flanks that are cylinders."""

Level = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Level h (n,) mm, gradient (n, 3) and Hessian (n, 3, 3) 1/mm of a surface."""


def crowned(curve: SignedDistance, removed: tuple[np.ndarray, np.ndarray, np.ndarray]) -> Level:
    """Level function of a curve along z. removed : along z, see `crowning`"""
    (distance, normal, k), (c, dc, ddc) = curve, removed
    hessian = np.zeros((len(c), 3, 3))
    tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
    hessian[:, :2, :2] = k[:, None, None] * tangent[:, :, None] * tangent[:, None, :]
    hessian[:, 2, 2] = ddc
    return distance + c, np.column_stack([normal, dc]), hessian


def _waves(
    x: np.ndarray, y: np.ndarray, lobes: int
) -> tuple[np.ndarray, list[np.ndarray], list[np.ndarray]]:
    """q = cos(lobes theta), (n,), its derivatives by x and y, and those by xx, yy and xy."""
    r2, angle = x * x + y * y, lobes * np.arctan2(x, y)
    q, rate = np.cos(angle), lobes * np.sin(angle)
    # derivatives of the angle from +y, clockwise
    ax, ay, axx, axy = y / r2, -x / r2, -2.0 * x * y / r2**2, (x * x - y * y) / r2**2
    pairs = ((ax * ax, axx), (ay * ay, -axx), (ax * ay, axy))
    second = [-(lobes**2) * q * squares - rate * bend for squares, bend in pairs]
    return q, [-rate * ax, -rate * ay], second


@dataclass(frozen=True, eq=False)
class WaveGeneratorSurface:
    """Level function of the crowned cam: exact in-plane distance less the radial modification.

    The zero level is the surface; away from it h is the distance but for |grad h|, 1.002 at most.

    cam : curve of the cross-section at mid-width
    width : mm, face width of the cam
    crowning, slope : mm, at |z| = width / 2 (section 7.12; sign of the slope: above)
    shape : "parabolic" or "circular", of the crowning;  lobes : 2 or 3, of the cam
    """

    cam: Cam
    width: float
    crowning: float = 0.0
    slope: float = 0.0
    shape: str = "parabolic"
    lobes: int = 2

    def evaluate(self, xyz: np.ndarray) -> Level:
        """Level, gradient and Hessian at points (n, 3) mm on the cam."""
        x, y, z = np.asarray(xyz, dtype=float).T
        removed = crowning(self.crowning, z, self.width, self.shape)
        level, gradient, hessian = crowned(self.cam.evaluate(xyz[:, :2]), removed)
        if self.slope:
            q, (qx, qy), (qxx, qyy, qxy) = _waves(x, y, self.lobes)
            rate = 2.0 * self.slope / self.width
            level += rate * z * q
            gradient += rate * np.column_stack([z * qx, z * qy, q])
            hessian[:, 0, 0] += rate * z * qxx
            hessian[:, 1, 1] += rate * z * qyy
            for i, j, value in ((0, 1, rate * z * qxy), (0, 2, rate * qx), (1, 2, rate * qy)):
                hessian[:, i, j] += value
                hessian[:, j, i] += value
        return level, gradient, hessian
