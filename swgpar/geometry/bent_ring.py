"""The shape of first order of a thin ring that a cam or the balls of a bearing bend without
extension: the one of least bending energy that keeps outside of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from swgpar.geometry.arrays import Complex, Floats
from swgpar.geometry.cams import Cam

HARMONICS, POINTS = 16, 480
"""Harmonics of the lobes in the shape, and points around one lobe of the ring that stay outside of
the cam."""

PENALTY, STIFF = 3e3 / 9.0, 1e6
"""Stiffness of the cam at a point, and of a ball, over that of the first harmonic: 9 with two
lobes."""

HELD = 0.1
"""Root of the energy of a shift of the whole ring, in which it does not bend."""

ROUNDS, MAX_CHANGES = 4, 50
"""Rounds in which the points find their places as they move around; changes of the points that
touch."""


@dataclass(frozen=True)
class RingShape:
    """Radial displacement of a ring, the sum of Re(c exp(i k theta)).

    orders : (n,) numbers k of waves around, 0 first;  amplitudes : (n,) c, mm; that of order 0 is
    what the ring shrinks by, for the length that its waves need
    """

    orders: Floats
    amplitudes: Complex


@cache
def waves_around(points: int, harmonics: int) -> tuple[Floats, Floats]:
    """Cosines and sines (points, harmonics) of the harmonics of the lobes at points around one."""
    angle = np.outer(2.0 * np.pi / points * np.arange(points), np.arange(1, harmonics + 1))
    return np.cos(angle), np.sin(angle)


def bent_ring(cam: Cam, inner_radius: float, radius: float, lobes: int = 2) -> RingShape:
    """The ring on a cam.

    inner_radius, radius : mm, of the undeformed ring's inner surface, which touches the cam, and of
    its neutral line
    """
    theta = np.linspace(0.0, 2.0 * np.pi / lobes, POINTS, endpoint=False)
    order = float(lobes) * np.arange(1, HARMONICS + 1)
    outline = cam.outline(7200)
    polar = np.arctan2(-outline[:, 0], outline[:, 1])
    around = np.argsort(polar)
    polar, distance = polar[around], np.hypot(*outline[around].T)
    cosines, sines = waves_around(POINTS, HARMONICS)
    amplitudes, shrink = np.zeros(2 * HARMONICS), 0.0
    for _ in range(ROUNDS):
        place = theta - np.hstack([sines, cosines]) @ (amplitudes / np.tile(order, 2)) / radius
        needed = np.interp(place, polar, distance, period=2.0 * np.pi) - inner_radius - shrink
        amplitudes = _least_energy(np.hstack([cosines, -sines]), needed, order, PENALTY)
        shrink = _shrink(amplitudes, order, radius)
    return _shape(amplitudes, shrink, order)


def ring_on_points(
    points: Floats, inner_radius: float, radius: float, lobes: int, *, shifts: bool
) -> RingShape:
    """The ring on points (n, 2) mm, evenly around it, as those over balls are.

    shifts : whether it may move as a whole, where the points of two lobes are not alike
    inner_radius, radius, lobes : see `bent_ring`
    """
    base = math.gcd(len(points), lobes)
    order = float(base) * np.arange(1, HARMONICS * lobes // base + 1)
    if not shifts:
        order = order[order > 1.0]
    place, distance = np.arctan2(-points[:, 0], points[:, 1]), np.hypot(*points.T)
    amplitudes, shrink, theta = np.zeros(2 * len(order)), 0.0, place
    for _ in range(ROUNDS):
        cosines, sines = np.cos(np.outer(theta, order)), np.sin(np.outer(theta, order))
        needed = distance - inner_radius - shrink
        amplitudes = _least_energy(np.hstack([cosines, -sines]), needed, order, STIFF)
        shrink = _shrink(amplitudes, order, radius)
        theta = place + np.hstack([sines, cosines]) @ (amplitudes / np.tile(order, 2)) / radius
    return _shape(amplitudes, shrink, order)


def _least_energy(waves: Floats, needed: Floats, order: Floats, penalty: float) -> Floats:
    """Amplitudes (2 k,) of least energy with at least the displacements `needed` (n,) mm at points.

    The energy of a harmonic is that of the change of curvature, (order² - 1)² times its amplitude².
    waves : (n, 2 k) of the points;  penalty : see `PENALTY`
    """
    bends = order > 1.0
    energy = np.tile(np.where(bends, order**2 - 1.0, HELD) ** 2, 2)
    stiffness = penalty * energy[bends.argmax()]
    amplitudes, touches = np.zeros(len(energy)), np.zeros(len(needed), dtype=bool)
    for _ in range(MAX_CHANGES):
        inside = waves @ amplitudes < needed
        if np.array_equal(inside, touches):
            break
        touches = inside
        pressed = stiffness * waves[touches]
        amplitudes = np.linalg.solve(
            np.diag(energy) + pressed.T @ waves[touches], pressed.T @ needed[touches]
        )
    return amplitudes


def _shrink(amplitudes: Floats, order: Floats, radius: float) -> float:
    """Displacement (mm) of the whole ring, which its length gives to the waves."""
    return -float((np.tile(order**2 - 1.0, 2) * amplitudes**2).sum()) / (4.0 * radius)


def _shape(amplitudes: Floats, shrink: float, order: Floats) -> RingShape:
    cosines, sines = np.split(amplitudes, 2)
    return RingShape(np.append(0.0, order), np.append(shrink, cosines + 1j * sines))
