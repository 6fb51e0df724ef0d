"""Cam curves that are chains of circular arcs, straight lines and parabolas, smoothly joined."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swgpar.geometry.arrays import SignedDistance
from swgpar.geometry.cams.curve import on_rays


@dataclass(frozen=True)
class Circle:
    """Arc of a circle, the material inside; `center` (x, y) and `radius` in mm."""

    center: tuple[float, float]
    radius: float

    def evaluate(self, xy: np.ndarray) -> SignedDistance:
        away = xy - self.center
        reach = np.hypot(away[:, 0], away[:, 1])
        # a point in the centre has no normal and is far from the surface: any finite value will do
        safe = np.maximum(reach, 1e-12 * self.radius)
        return reach - self.radius, away / safe[:, None], 1.0 / safe


@dataclass(frozen=True)
class Line:
    """Straight line through `point` (x, y), mm, with the outward unit `normal`."""

    point: tuple[float, float]
    normal: tuple[float, float]

    def evaluate(self, xy: np.ndarray) -> SignedDistance:
        normal = np.asarray(self.normal)
        return (xy - self.point) @ normal, np.broadcast_to(normal, xy.shape), np.zeros(len(xy))


@dataclass(frozen=True)
class Parabola:
    """Parabola y = height - p x^2 (eq. 3.5), rotated about its apex by `tilt`, material below.

    height : mm;  p : 1/mm, above 0;  tilt : rad, counter-clockwise
    """

    height: float
    p: float
    tilt: float = 0.0

    def _rotation(self) -> np.ndarray:
        c, s = np.cos(self.tilt), np.sin(self.tilt)
        return np.array([[c, -s], [s, c]])

    def at(self, x: float) -> tuple[np.ndarray, np.ndarray]:
        """Point (2,) mm and outward normal (2,) at the abscissa x, own frame (eqs 3.5, 3.7)."""
        point = np.array([x, -self.p * x * x])
        normal = np.array([2.0 * self.p * x, 1.0]) / np.hypot(1.0, 2.0 * self.p * x)
        return self._rotation() @ point + (0.0, self.height), self._rotation() @ normal

    def evaluate(self, xy: np.ndarray) -> SignedDistance:
        """The foot's abscissa is a root of x^3 + u x = v, by its closed form and a Newton step.

        It is the root of largest size, on the point's side of the axis: the only one until the
        point lies more than 1 / (2 p) below the apex.
        """
        x, y = ((xy - (0.0, self.height)) @ self._rotation()).T
        p = self.p
        u, v = (0.5 + p * y) / p**2, 0.5 * x / p**2
        root = np.sqrt(np.maximum(np.abs(u), 1e-12 / p**2) / 3.0)
        q = 0.5 * np.abs(v) / root**3
        # each form in its own range of u and q
        hollow = np.sinh(np.arcsinh(q) / 3.0)
        single = np.cosh(np.arccosh(np.maximum(q, 1.0)) / 3.0)
        triple = np.cos(np.arccos(np.minimum(q, 1.0)) / 3.0)
        foot = np.copysign(
            2.0 * root * np.where(u > 0.0, hollow, np.where(q > 1.0, single, triple)), x
        )
        foot -= (foot**3 + u * foot - v) / np.maximum(3.0 * foot**2 + u, 1e-12 / p**2)
        slope = 2.0 * p * foot
        length = np.hypot(1.0, slope)
        normal = np.column_stack([slope, np.ones_like(slope)]) / length[:, None]
        distance = (x - foot) * normal[:, 0] + (y + p * foot**2) * normal[:, 1]
        curvature = 2.0 * p / length**3
        return distance, normal @ self._rotation().T, curvature / (1.0 + curvature * distance)


@dataclass(frozen=True)
class PiecewiseCam:
    """Convex curve with continuous tangent that equals itself after a rotation by 180 degrees.

    The nearest piece to a point near the curve follows from which side of the joints' normals it
    lies on, on the point's own side of the major axis: this holds as long as the point is nearer
    than the smallest radius of curvature.

    pieces : the upper half, counter-clockwise, from (w, 0), where its normal is (1,
        0), to (-w, 0)
    joints, tangents : (len(pieces) - 1, 2) points between them, mm, and counter-clockwise tangents
    """

    pieces: tuple[Circle | Line | Parabola, ...]
    joints: np.ndarray
    tangents: np.ndarray

    def evaluate(self, xy: np.ndarray) -> SignedDistance:
        """Signed distance, outward normal and Hessian factor at points (n, 2) mm near the curve."""
        xy = np.asarray(xy, dtype=float)
        sign = np.where(xy[:, 1] < 0.0, -1.0, 1.0)
        upper = xy * sign[:, None]
        along = upper @ self.tangents.T - np.einsum("ij,ij->i", self.joints, self.tangents)
        # for a joint on the other side of the major axis the far end of its normal does not
        # separate the pieces
        side = np.sign(self.joints[:, 0])
        passed = np.where(side * upper[:, :1] < 0.0, side > 0.0, along > 0.0)
        index = np.count_nonzero(passed, axis=1)
        distance, normal, k = np.empty(len(xy)), np.empty((len(xy), 2)), np.empty(len(xy))
        for i, piece in enumerate(self.pieces):
            inside = np.flatnonzero(index == i)
            if len(inside):
                distance[inside], normal[inside], k[inside] = piece.evaluate(upper[inside])
        return distance, normal * sign[:, None], k

    def outline(self, n: int) -> np.ndarray:
        """Points (n, 2), mm, of the curve at equal polar angles, counter-clockwise from +x."""
        angle = 2.0 * np.pi * np.arange(n) / n
        ray = np.column_stack([np.cos(angle), np.sin(angle)])
        return on_rays(self, ray, 2.0 * float(np.abs(self.joints).max()))
