"""Hertz's contact of a ball in a groove: approach, ellipse and pressure by the force on it.

With the relative curvatures kx and ky, k = kx + ky, the ratio e of the semi-axes of the ellipse
solves

    |kx - ky| / k = ((e² + 1) E - 2 K) / ((e² - 1) E)

with the complete elliptic integrals K and E of 1 - 1 / e² (Harris, Rolling Bearing Analysis,
6.20-6.38):

    a = (2 e² E / pi)^(1/3) (3 F / (2 k E*))^(1/3),    b = a / e,
    delta = (2 K / pi) (pi / (2 e² E))^(1/3) (3 F / (2 k E*))^(2/3) k / 2,    p = 3 F / (2 pi a b).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.special import ellipe, ellipk

from swgpar.geometry.bracketed_root import root_between

ROUND, LONGEST = 1e-9, 1e7
"""Relative difference of the curvatures below which the ellipse is a circle; largest ratio of its
semi-axes."""


@dataclass(frozen=True)
class PointContact:
    """Contact of two bodies at a point, by the force F (N).

    approach : mm / N^(2/3), over F^(2/3);  major, minor : mm / N^(1/3), semi-axes over F^(1/3)
    """

    approach: float
    major: float
    minor: float

    def pressure(self, force: np.ndarray | float) -> np.ndarray:
        """Largest pressure (MPa) at forces (N) of any shape."""
        return 1.5 * np.cbrt(force) / (np.pi * self.major * self.minor)


def point_contact(along: float, across: float, modulus: float) -> PointContact:
    """Contact of two bodies.

    along, across : 1/mm, sums of their curvatures in both principal planes, positive;  modulus :
    E*, MPa
    """
    total, difference = along + across, abs(along - across) / (along + across)
    ratio = (
        1.0
        if difference < ROUND
        else float(np.exp(root_between(partial(_excess, difference), 1e-6, np.log(LONGEST))))
    )
    first, second = ellipk(1.0 - ratio**-2), ellipe(1.0 - ratio**-2)
    size = np.cbrt(1.5 / (total * modulus))
    major = float(size * np.cbrt(2.0 * ratio**2 * second / np.pi))
    approach = (
        2.0 * first / np.pi * np.cbrt(np.pi / (2.0 * ratio**2 * second)) * size**2 * 0.5 * total
    )
    return PointContact(float(approach), major, major / ratio)


def _excess(difference: float, log_ratio: float) -> float:
    square = np.exp(2.0 * log_ratio)
    first, second = ellipk(1.0 - 1.0 / square), ellipe(1.0 - 1.0 / square)
    return float(((square + 1.0) * second - 2.0 * first) / ((square - 1.0) * second) - difference)


@dataclass(frozen=True)
class BallSpring:
    """A ball between two grooves: F = stiffness * approach^1.5.

    inner, outer : contacts on the inner and on the outer race;  factor : on the stiffness of both
    in series
    """

    inner: PointContact
    outer: PointContact
    factor: float = 1.0

    @property
    def stiffness(self) -> float:
        """N / mm^1.5"""
        return self.factor * (self.inner.approach + self.outer.approach) ** -1.5

    def force(self, approach: np.ndarray) -> np.ndarray:
        """Forces (n,) N at approaches (n,) mm; only pressure."""
        return self.stiffness * np.maximum(approach, 0.0) ** 1.5


def ball_spring(
    diameter: float,
    inner_groove: float,
    outer_groove: float,
    conformities: tuple[float, float],
    modulus: float,
    factor: float = 1.0,
) -> BallSpring:
    """Spring of a ball between two races.

    diameter : mm, of the ball;  inner_groove, outer_groove : mm, radii of the races at the bottom
    of their grooves
    conformities : of inner and outer race, radius of the groove over the ball's diameter;  modulus
    : E*, MPa
    factor : on the stiffness
    """
    ball = 2.0 / diameter
    inner, outer = (ball - 1.0 / (conformity * diameter) for conformity in conformities)
    return BallSpring(
        point_contact(ball + 1.0 / inner_groove, inner, modulus),
        point_contact(ball - 1.0 / outer_groove, outer, modulus),
        factor,
    )
