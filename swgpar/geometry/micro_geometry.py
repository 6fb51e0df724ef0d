"""Crowning and slope: microns taken from the cam and from the flanks (section 7.12).

Sign of the slope, with theta from the major axis and z towards the closed end: the cam's surface is
moved radially by -s (2 z / F_w) cos(n theta), n lobes. s > 0 raises the edge under the open end at
the major axis, so that the surface follows the cone of the deflected cup (section 7.12); s < 0 is
the sense of the words of section 7.13.3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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


Waves = tuple[np.ndarray, tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]
"""A function of x and y, (n,), its derivatives by x and y, and those by xx, xy and yy."""


def _two_waves(x: np.ndarray, y: np.ndarray) -> Waves:
    """cos 2 theta = (y^2 - x^2) / r^2."""
    r2 = x * x + y * y
    q = (y * y - x * x) / r2
    qx, qy = -2.0 * x * (1.0 + q) / r2, 2.0 * y * (1.0 - q) / r2
    qxx = (-2.0 * (1.0 + q) - 4.0 * x * qx) / r2
    qyy = (2.0 * (1.0 - q) - 4.0 * y * qy) / r2
    qxy = (-2.0 * x * qy - 2.0 * y * qx) / r2
    return q, (qx, qy), (qxx, qxy, qyy)


def _three_waves(x: np.ndarray, y: np.ndarray) -> Waves:
    """cos 3 theta = cos theta (2 cos 2 theta - 1), cos theta = y / r."""
    q, (qx, qy), (qxx, qxy, qyy) = _two_waves(x, y)
    r = np.hypot(x, y)
    p, px, py = y / r, -x * y / r**3, x * x / r**3
    pxx, pxy, pyy = (
        y * (2.0 * x * x - y * y) / r**5,
        x * (2.0 * y * y - x * x) / r**5,
        -3.0 * x * x * y / r**5,
    )
    f = 2.0 * q - 1.0
    return (
        p * f,
        (px * f + 2.0 * p * qx, py * f + 2.0 * p * qy),
        (
            pxx * f + 4.0 * px * qx + 2.0 * p * qxx,
            pxy * f + 2.0 * (px * qy + py * qx + p * qxy),
            pyy * f + 4.0 * py * qy + 2.0 * p * qyy,
        ),
    )


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

    def evaluate(self, xyz: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Level h (n,) mm, gradient (n, 3), Hessian (n, 3, 3) 1/mm at points (n, 3) on the cam."""
        x, y, z = np.asarray(xyz, dtype=float).T
        distance, normal, k = self.cam.evaluate(xyz[:, :2])
        gradient = np.zeros((len(x), 3))
        hessian = np.zeros((len(x), 3, 3))
        gradient[:, :2] = normal
        tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
        hessian[:, :2, :2] = k[:, None, None] * tangent[:, :, None] * tangent[:, None, :]
        c, dc, ddc = crowning(self.crowning, z, self.width, self.shape)
        level = distance + c
        gradient[:, 2] += dc
        hessian[:, 2, 2] += ddc
        if self.slope:
            q, (qx, qy), (qxx, qxy, qyy) = (_two_waves if self.lobes == 2 else _three_waves)(x, y)
            rate = 2.0 * self.slope / self.width
            level = level + rate * z * q
            gradient[:, 0] += rate * z * qx
            gradient[:, 1] += rate * z * qy
            gradient[:, 2] += rate * q
            hessian[:, 0, 0] += rate * z * qxx
            hessian[:, 1, 1] += rate * z * qyy
            for i, j, value in ((0, 1, rate * z * qxy), (0, 2, rate * qx), (1, 2, rate * qy)):
                hessian[:, i, j] += value
                hessian[:, j, i] += value
        return level, gradient, hessian
