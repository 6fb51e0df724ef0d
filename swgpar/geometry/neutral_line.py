"""The neutral line of a thin ring that a cam bends without extension.

The ring's tangents turn by the tilt L(theta), a series of the harmonics of the lobes in the
material angle theta. Its curve follows
exactly: X' = -r exp(i (theta + L)), with the plane's points as complex numbers x + i y and the
major axis along +y.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from swgpar.geometry.arrays import Floats
from swgpar.geometry.cams import Cam, WaveGenerator, make_cam, taut_length

HARMONICS, POINTS = 16, 1440
"""Harmonics of the shape, and points around one lobe of the ring that stay outside of the cam."""

PENALTY = 1e3 / 9.0
"""Stiffness of the cam at a point, over that of the first harmonic: 9 with two lobes."""

ROUNDS, MAX_CHANGES = 4, 50
"""Rounds in which the points find their places on the cam as they move around; changes of the
points that touch."""

SERIES_POINTS = 1024
"""Points of the Fourier series of the curve, whose terms fall to round-off long before."""


def bent_ring(cam: Cam, inner_radius: float, radius: float, lobes: int = 2) -> np.ndarray:
    """Complex amplitudes c_n (HARMONICS + 1,) mm of the radial displacement Re(c_n exp(i lobes n
    theta)) on the cam.

    The energy of a harmonic k = lobes n is that of the change of curvature, (k² - 1)² a_n². The
    ring shrinks by what its waves need.

    inner_radius, radius : mm, of the undeformed ring's inner surface, which touches the cam, and of
    its neutral line
    """
    theta = np.linspace(0.0, 2.0 * np.pi / lobes, POINTS, endpoint=False)
    order = float(lobes) * np.arange(1, HARMONICS + 1)
    outline = cam.outline(7200)
    polar = np.arctan2(-outline[:, 0], outline[:, 1])
    around = np.argsort(polar)
    polar, distance = polar[around], np.hypot(*outline[around].T)
    cosines, sines = np.cos(np.outer(theta, order)), np.sin(np.outer(theta, order))
    waves, energy = np.hstack([cosines, -sines]), np.tile((order**2 - 1.0) ** 2, 2)
    penalty = PENALTY * energy[0]
    amplitudes, shrink = np.zeros(2 * HARMONICS), 0.0
    for _ in range(ROUNDS):
        place = theta - np.hstack([sines, cosines]) @ (amplitudes / np.tile(order, 2)) / radius
        needed = np.interp(place, polar, distance, period=2.0 * np.pi) - inner_radius - shrink
        touches = np.zeros(POINTS, dtype=bool)
        for _ in range(MAX_CHANGES):
            inside = waves @ amplitudes < needed
            if np.array_equal(inside, touches):
                break
            touches = inside
            pressed = penalty * waves[touches]
            amplitudes = np.linalg.solve(
                np.diag(energy) + pressed.T @ waves[touches], pressed.T @ needed[touches]
            )
        shrink = -float((np.sqrt(energy) * amplitudes**2).sum()) / (4.0 * radius)
    return np.append(shrink, amplitudes[:HARMONICS] + 1j * amplitudes[HARMONICS:])


@dataclass(frozen=True)
class NeutralLine:
    """A closed curve of given length.

    Attributes
    ----------
    amplitudes : tuple of complex, mm
        Those of the radial displacement by the harmonics lobes, 2 lobes, …, counted from the major
        axis counter-clockwise.
    radius : float, mm
        That of the undeformed line.
    stretched : float, mm
        That of the line under the uniform extension that a cam longer than the ring forces on it.
    lobes : int
        Lobes of the cam, 2 or more.
    """

    amplitudes: tuple[complex, ...]
    radius: float
    stretched: float
    lobes: int = 2

    def tilt(self, theta: Floats) -> tuple[Floats, Floats, Floats]:
        """Tilt L (n,) rad of the tangents at material angles `theta` : (n,) rad, and its first two
        derivatives."""
        order = float(self.lobes) * np.arange(1, len(self.amplitudes) + 1)[:, None]
        # v = -int w, L = (v - w') / r: both of the imaginary part
        wave = (
            (order - 1.0 / order)
            * np.array(self.amplitudes)[:, None]
            * np.exp(1j * order * theta)
            / self.radius
        )
        return (
            wave.imag.sum(axis=0),
            (order * wave.real).sum(axis=0),
            -(order**2 * wave.imag).sum(axis=0),
        )

    @cached_property
    def _series(self) -> tuple[np.ndarray, np.ndarray]:
        """Orders and complex amplitudes, mm, of X."""
        theta = 2.0 * np.pi * np.arange(SERIES_POINTS) / SERIES_POINTS
        slope = (
            np.fft.fft(-self.stretched * np.exp(1j * (theta + self.tilt(theta)[0]))) / SERIES_POINTS
        )
        order = np.fft.fftfreq(SERIES_POINTS, 1.0 / SERIES_POINTS)
        # the mean is zero: the tangents of all lobes cancel
        terms = np.divide(slope, 1j * order, out=np.zeros_like(slope), where=order != 0.0)
        kept = np.abs(terms) > 1e-16 * self.radius
        return order[kept], terms[kept]

    def position(self, theta: Floats) -> np.ndarray:
        """Points x + i y (n,), mm, at the material angles `theta` : (n,) rad."""
        order, terms = self._series
        return np.exp(1j * np.outer(theta, order)) @ terms


@lru_cache(maxsize=16)
def neutral_line(
    keys: WaveGenerator, a: float, b: float | None, inner_radius: float, radius: float, share: float
) -> NeutralLine:
    """The neutral line on a cam; kept, because a design asks for its profiles again and again.

    keys : of the cam;  a, b : mm, its semi-axes
    inner_radius, radius : mm, of the undeformed ring's inner surface and of its neutral line
    share : of the deflection that reaches the section; less than 1 towards the closed end of a cup
    """
    cam, lobes = make_cam(keys, a, b), keys.lobes
    amplitudes = share * bent_ring(cam, inner_radius, radius, lobes)[1:]
    excess = max(taut_length(cam) / (2.0 * np.pi) - inner_radius, 0.0)
    return NeutralLine(tuple(map(complex, amplitudes)), radius, radius + share * excess, lobes)
