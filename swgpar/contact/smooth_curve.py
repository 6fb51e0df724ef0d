"""Smooth curves through the nodes of a race's surface, around the axis.

Between two nodes the curve is a cubic with the slopes of the parabolas through three nodes, so that
its direction is the same on both sides of a node. On straight facets the direction of a
frictionless force would jump at the nodes, and two surfaces that slide on each other would hold
each other back.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

NODES = 4
"""Nodes of a piece of the curve: its ends are the second and the third."""

STEPS, CLOSE = 6, 1e-8
"""Most Newton steps to a point of the curve, and the change of lambda after which no other one
follows: pieces are nearly straight, and the iteration is quadratic."""

REACH = 1.0
"""Lengths of a piece by which its cubic continues it; farther out it is straight. Surfaces slide so
far in iterations that have not settled, where a cubic has no bounds; and by one or two lengths more
on very fine meshes, where the line leaves the circle by hundredths of a micrometre."""


def curve_nodes(
    grid: np.ndarray, sector: np.ndarray, column: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of pieces of the curve.

    grid : (n_around + 1, n_z) nodes of a sector's surface, clockwise side first
    sector, column : (n,) index of a piece's sector, and of the piece in it

    Returns indices of the sectors (n, 4) and nodes (n, 4, n_z) of the pieces; those at the ends of
    a sector reach into the next ones.
    """
    n = len(grid) - 1
    further, position = np.divmod(column[:, None] + np.arange(-1, 3), n)
    return sector[:, None] + further, grid[position]


def smooth_curve(nodes: np.ndarray) -> np.ndarray:
    """Polynomials (n, 4, 4) in lambda of the four nodes, 0 to 1 on a piece; coefficients of 1 to
    lambda³ come last.

    nodes : (n, 4, 2) mm, undeformed
    """
    left, middle, right = np.linalg.norm(np.diff(nodes, axis=1), axis=2).T
    out = np.zeros((len(nodes), NODES, 4))
    out[:, 1], out[:, 2] = (1.0, 0.0, -3.0, 2.0), (0.0, 0.0, 3.0, -2.0)
    at_start, at_end = np.array([0.0, 1.0, -2.0, 1.0]), np.array([0.0, 0.0, -1.0, 1.0])
    for node, hermite, before, after in ((1, at_start, left, middle), (2, at_end, middle, right)):
        low = -middle * after / (before * (before + after))
        high = middle * before / (after * (before + after))
        for k, weight in ((node - 1, low), (node, -low - high), (node + 1, high)):
            out[:, k] += weight[:, None] * hermite
    return out


def _on_cubic(place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The parts of places lambda on the cubic and on the straight line beyond it."""
    cubic = np.clip(place, -REACH, 1.0 + REACH)
    return cubic, place - cubic


def shape_functions(
    polynomials: np.ndarray, place: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Shape functions of the nodes at places lambda, and their first and second derivatives by
    lambda; (..., 4) each.

    polynomials : (..., 4, 4);  place : (...)
    """
    cubic, beyond = _on_cubic(place)
    one, zero = np.ones_like(cubic), np.zeros_like(cubic)
    powers = (
        np.stack([one, cubic, cubic**2, cubic**3], axis=-1),
        np.stack([zero, one, 2.0 * cubic, 3.0 * cubic**2], axis=-1),
        np.stack([zero, zero, 2.0 * one, 6.0 * cubic], axis=-1),
    )
    value, rate, second = (np.einsum("...np,...p->...n", polynomials, power) for power in powers)
    value += beyond[..., None] * rate
    second[beyond != 0.0] = 0.0
    return value, rate, second


@dataclass(frozen=True)
class FootPoints:
    """Points of pieces of the curve that are nearest to given points.

    polynomials : (..., 4, 4) of the pieces;  place : (...) lambda there
    away : (..., 2) mm, from there to the given points
    tangent, bend : (..., 2) mm, first and second derivative of the curve by lambda
    """

    polynomials: np.ndarray
    place: np.ndarray
    away: np.ndarray
    tangent: np.ndarray
    bend: np.ndarray

    def __getitem__(self, chosen: np.ndarray) -> FootPoints:
        """Those of the chosen pieces. chosen : (n,) places in the first axis"""
        return FootPoints(
            self.polynomials[chosen],
            self.place[chosen],
            self.away[chosen],
            self.tangent[chosen],
            self.bend[chosen],
        )

    def shape_functions(self) -> tuple[np.ndarray, np.ndarray]:
        """Shape functions of the nodes there (..., 4), and their derivatives by lambda."""
        value, rate, _ = shape_functions(self.polynomials, self.place)
        return value, rate

    @property
    def normal(self) -> np.ndarray:
        """Unit vectors (..., 2) across the curve: outward where it runs counter-clockwise."""
        x, y = self.tangent[..., 0], self.tangent[..., 1]
        return np.stack([y, -x], axis=-1) / np.hypot(x, y)[..., None]


def foot_points(
    polynomials: np.ndarray, nodes: np.ndarray, points: np.ndarray, place: np.ndarray
) -> FootPoints:
    """Where the normal of a piece of the curve meets a point; pieces continue beyond their ends,
    see `REACH`.

    polynomials : (..., 4, 4);  nodes : (..., 4, 2) mm, deformed;  points : (..., 2) mm
    place : (...) lambda, first guess
    """
    curve = np.einsum("...np,...ni->...pi", polynomials, nodes)
    c0, c1, c2, c3 = (curve[..., power, :] for power in range(4))
    change, step = np.ones(1), 0
    while True:
        t, beyond = _on_cubic(place[..., None])
        tangent = c1 + t * (2.0 * c2 + t * (3.0 * c3))
        bend = np.where(beyond == 0.0, 2.0 * c2 + 6.0 * t * c3, 0.0)
        away = points - (c0 + t * (c1 + t * (c2 + t * c3)) + beyond * tangent)
        if step == STEPS or np.abs(change).max(initial=0.0) < CLOSE:
            return FootPoints(polynomials, place, away, tangent, bend)
        steepness = np.sum(tangent * tangent - away * bend, axis=-1)
        change = np.sum(away * tangent, axis=-1) / steepness
        place, step = place + change, step + 1
