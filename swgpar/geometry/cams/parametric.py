"""Cam curves that are smooth functions of a parameter."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from swgpar.geometry.arrays import SignedDistance

MOST_STEPS = 30
"""Newton steps to a foot point: near the curve some 5 reach round-off."""


class ParametricCam(ABC):
    """Closed curve X(t), 0 <= t <= 2 pi, of points x + i y (mm), counter-clockwise from +y."""

    @abstractmethod
    def curve(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """X (n,) complex, and its first two derivatives by t."""

    @abstractmethod
    def near(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Parameters (n,) of points of the curve near the points x, y (n,), mm."""

    def evaluate(self, xy: np.ndarray) -> SignedDistance:
        """Signed distance, outward normal and Hessian factor at points (n, 2), mm, near the curve.

        The foot point X solves (X - p) . X' = 0 by Newton's method. Points inside must be nearer to
        the curve than its radius of curvature.
        """
        x, y = np.asarray(xy, dtype=float).T
        point, t = x + 1j * y, self.near(x, y)
        for _ in range(MOST_STEPS):
            foot, rate, bend = self.curve(t)
            away = foot - point
            value = away.real * rate.real + away.imag * rate.imag
            slope = rate.real**2 + rate.imag**2 + away.real * bend.real + away.imag * bend.imag
            step = value / slope
            t = t - step
            if np.max(np.abs(step), initial=0.0) < 1e-15:
                break
        foot, rate, bend = self.curve(t)
        speed = np.abs(rate)
        normal = -1j * rate / speed
        distance = ((point - foot) * normal.conj()).real
        curvature = (rate.conj() * bend).imag / speed**3
        normal = np.column_stack([normal.real, normal.imag])
        return distance, normal, curvature / (1.0 + curvature * distance)

    def outline(self, n: int) -> np.ndarray:
        """Points (n, 2), mm, of the curve at equal parameters."""
        points = self.curve(2.0 * np.pi * np.arange(n) / n)[0]
        return np.column_stack([points.real, points.imag])
