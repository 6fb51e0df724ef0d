"""Chains of points in the plane: polar angles, crossings with themselves, distances of two."""

from __future__ import annotations

import numpy as np

from swgpar.geometry.arrays import Complex, Floats

BLOCK = 256
"""Chords that are compared with all others at once."""

PARALLEL = 1e-9
"""Sine of the angle between chords that count as parallel."""

MOST_CHORDS = 4096
"""Chords of a chain that are compared; of finer ones every second point, fourth point, ..."""


def clockwise_from_y(points: Complex) -> Floats:
    """Polar angles (n,), rad, from +y and clockwise, of points x + i y (n,)."""
    return -np.angle(-1j * points)


def first_crossing(points: Complex) -> complex | None:
    """Where the chain through points x + i y (n,) first crosses itself; None if it does not."""
    points = points[:: max(1, -(-len(points) // MOST_CHORDS))]
    start, chord = points[:-1], np.diff(points)
    index = np.arange(len(start))
    for begin in range(0, len(start), BLOCK):
        rows = slice(begin, begin + BLOCK)
        a, u = start[rows, None], chord[rows, None]
        away = start[None, :] - a
        across = _cross(u, chord[None, :])
        with np.errstate(divide="ignore", invalid="ignore"):
            s = _cross(away, chord[None, :]) / across
            t = _cross(away, u) / across
        later = index[None, :] > index[rows, None] + 1
        # chords of one straight line do not cross
        later &= np.abs(across) > PARALLEL * np.abs(u) * np.abs(chord[None, :])
        hits = np.argwhere(later & (0.0 <= s) & (s <= 1.0) & (0.0 <= t) & (t <= 1.0))
        if len(hits):
            row, column = hits[0]
            return complex(start[begin + row] + s[row, column] * chord[begin + row])
    return None


def _cross(a: Complex, b: Complex) -> Floats:
    return (np.conj(a) * b).imag


def largest_distance(points: Complex, other: Complex) -> tuple[float, complex]:
    """Largest distance of points x + i y (n,) from the chain through `other` (m,), and of which
    one; points beyond the ends of that chain do not count."""
    points, chord = points[:: max(1, len(points) // 512)], np.diff(other)
    share = (np.conj(chord) * (points[:, None] - other[None, :-1])).real / np.abs(chord) ** 2
    nearest = other[None, :-1] + np.clip(share, 0.0, 1.0) * chord
    distance = np.abs(points[:, None] - nearest).min(axis=1)
    beyond = (share[:, 0] < 0.0) & (share.max(axis=1) < 0.0) | (share[:, -1] > 1.0) & (
        share.min(axis=1) > 1.0
    )
    distance = np.where(beyond, 0.0, distance)
    at = int(distance.argmax())
    return float(distance[at]), complex(points[at])
