"""The neutral line of a thin ring that a cam bends without extension.

The ring's tangents turn by the tilt L(theta), a series of the harmonics of the lobes in the
material angle theta. Its curve follows exactly: X' = -r exp(i (theta + L)), with the plane's points
as complex numbers x + i y and the major axis along +y. Its energy is that of L'^2. It keeps at
least the distance of the ring's half thickness from the cam: where the ring lies on the cam, the
line is the cam's exact offset, elsewhere it is an elastica.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from swgpar.geometry.arrays import Complex, Floats, as_complex, as_points
from swgpar.geometry.bent_ring import HARMONICS, bent_ring, waves_around
from swgpar.geometry.cams import Cam, WaveGenerator, make_cam, taut_length

LINE_HARMONICS, LINE_POINTS = 32, 2048
"""The same of the exact line."""

LINE_PENALTY = 1e5
"""Stiffness of the cam at a point of the exact line, over that of the first harmonic; multipliers
make the contact exact."""

LINE_ROUNDS, LINE_CHANGE, MAX_CHANGES = 12, 1e-8, 50
"""Most steps of Newton's method, the change of the tilt, rad, at which it ends, and most changes
of the points that touch in a step."""

ROUND_OFF = 1e-14
"""Amplitude of the tilt, rad, below which the last harmonics are left out."""

SYMMETRY = 1e-9
"""Amplitudes over the first below which a cam counts as symmetric to its major axis."""

SERIES_POINTS = 1024
"""Points around one lobe for the Fourier series of the curve, whose terms fall to round-off long
before."""


@dataclass(frozen=True)
class _RingOnCam:
    """The ring of least bending energy that keeps clear of the cam.

    inner_radius, radius : mm, of the undeformed ring's inner surface and of its neutral line
    stretched : mm, radius of the line under the extension that the cam forces on it
    """

    cam: Cam
    inner_radius: float
    radius: float
    stretched: float
    lobes: int

    def tilts(self) -> Complex:
        """Complex amplitudes (LINE_HARMONICS,) rad of the tilt, Im(L_n exp(i lobes n theta)).

        Newton's method on the Lagrangian of the energy and of the distances at points around one
        lobe, from the shape of first order. The points that touch change until they are those that
        the cam presses on. On a cam whose lobes are symmetric, half a lobe is looked at.
        """
        order = float(self.lobes) * np.arange(1, LINE_HARMONICS + 1)
        cosines, sines = waves_around(LINE_POINTS, LINE_HARMONICS)
        waves, energy, weight = sines, order**2, np.ones(LINE_POINTS)
        start = bent_ring(self.cam, self.inner_radius, self.radius, self.lobes).amplitudes[1:]
        first = np.zeros(LINE_HARMONICS, dtype=complex)
        # v = -int w, L = (v - w') / r of the radial displacement w: both of the imaginary part
        first[:HARMONICS] = (order - 1.0 / order)[:HARMONICS] * start / self.radius
        amplitudes, symmetric = first.real, np.abs(first.imag).max() < SYMMETRY * abs(first[0])
        if symmetric:
            waves, weight = sines[: LINE_POINTS // 2 + 1], np.full(LINE_POINTS // 2 + 1, 2.0)
            weight[[0, -1]] = 1.0
        else:
            waves, energy = np.hstack([sines, cosines]), np.tile(energy, 2)
            amplitudes = np.append(amplitudes, first.imag)
        pressure, penalty = np.zeros(len(waves)), LINE_PENALTY * self.lobes**2
        for _ in range(LINE_ROUNDS):
            gap, slope, stiffness = self._gaps(waves, amplitudes, weight * pressure)
            stiffness += np.diag(energy)
            acting = pressure - penalty * gap
            rows, forces = np.sqrt(weight)[:, None] * slope, np.sqrt(weight) * acting
            for _ in range(MAX_CHANGES):
                touching = acting > 0.0
                pressed = rows[touching]
                force = pressed.T @ forces[touching] - energy * amplitudes
                change = np.linalg.solve(stiffness + penalty * (pressed.T @ pressed), force)
                acting = pressure - penalty * (gap + slope @ change)
                if np.array_equal(acting > 0.0, touching):
                    break
            amplitudes, pressure = amplitudes + change, np.maximum(acting, 0.0)
            if np.abs(change).max() < LINE_CHANGE:
                break
        real, imaginary = np.split(amplitudes, 2) if not symmetric else (amplitudes, 0.0)
        return real + 1j * imaginary

    def _gaps(
        self, waves: Floats, amplitudes: Floats, pressure: Floats
    ) -> tuple[Floats, Floats, Floats]:
        """Gaps (n,) between cam and ring at points around one lobe over the radius, their
        derivatives (n, k) by the amplitudes (k,), and the second derivatives (k, k) of their sum
        with the factors -`pressure` (n,).

        waves : (n, k), of the tilt; over half a lobe the other half is its mirror image
        """
        half = len(waves) < LINE_POINTS
        around = np.exp(2j * np.pi / self.lobes * np.arange(len(waves)) / LINE_POINTS)
        order = 1.0 + self.lobes * np.fft.fftfreq(LINE_POINTS, 1.0 / LINE_POINTS)

        def integral(along: Complex) -> Complex:
            """Of along exp(i theta), without a mean. Terms of a mirror image are real."""
            if half:
                terms = np.fft.hfft(along, LINE_POINTS, axis=0) / order[:, None]
                return -1j * around[:, None] * np.fft.ihfft(terms, axis=0)
            terms = np.fft.fft(along, axis=0) / (1j * order)[:, None]
            return around[:, None] * np.fft.ifft(terms, axis=0)

        def transposed(forces: Complex) -> Complex:
            """The integral's transpose, of `forces` exp(-i theta)."""
            if half:
                terms = np.fft.hfft(np.conj(1j * forces), LINE_POINTS) / LINE_POINTS
                return -np.fft.rfft(terms / order)
            return np.fft.fft(np.fft.ifft(forces) / (1j * order))

        along = -self.stretched * np.exp(1j * (waves @ amplitudes))[:, None]
        points = integral(along)[:, 0]
        distance, xy, hessian = self.cam.evaluate(as_points(points))
        normal = as_complex(xy)
        gap = distance - (self.radius - self.inner_radius)
        moved = integral(1j * along * waves) * np.conj(normal)[:, None]
        curved = np.zeros((waves.shape[1], waves.shape[1]))
        if pressure.any():
            back = transposed(around * np.conj(normal) * pressure)
            bent = (back * along[:, 0]).real[:, None]
            # products of parts of complex numbers are slow
            along_cam = np.ascontiguousarray(moved.imag)
            sideways = (hessian * pressure)[:, None] * along_cam
            curved = waves.T @ (bent * waves) - along_cam.T @ sideways
        return gap / self.radius, moved.real / self.radius, curved / self.radius


class LinePoints(NamedTuple):
    """Points of a neutral line at material angles theta (n,).

    offset : (n,) complex, mm, the points X times exp(-i theta)
    tilt, tilt1, tilt2 : (n,) rad, of the tangents, and its derivatives by theta
    """

    offset: Complex
    tilt: Floats
    tilt1: Floats
    tilt2: Floats


@dataclass(frozen=True)
class NeutralLine:
    """A closed curve of given length.

    Attributes
    ----------
    tilts : tuple of complex, rad
        Amplitudes of the tilt by the harmonics lobes, 2 lobes, …, counted from the major axis
        counter-clockwise.
    radius : float, mm
        That of the undeformed line.
    stretched : float, mm
        That of the line under the uniform extension that a cam longer than the ring forces on it.
    lobes : int
        Lobes of the cam, 2 or more.
    """

    tilts: tuple[complex, ...]
    radius: float
    stretched: float
    lobes: int = 2

    def _powers(self, theta: Floats, count: int) -> Complex:
        """Powers (count, n) from 1 on of exp(i lobes theta)."""
        powers = np.empty((count, len(theta)), dtype=complex)
        powers[0], known = np.exp(1j * self.lobes * theta), 1
        # products of powers take a tenth of the time of exponentials
        while known < count:
            further = powers[known : 2 * known]
            np.multiply(powers[: len(further)], powers[known - 1], out=further)
            known *= 2
        return powers

    @cached_property
    def _series(self) -> tuple[complex, Complex]:
        """Mean of X exp(-i theta), mm, and amplitudes (5, k) of the powers of exp(i lobes theta):
        of its other terms, those of negative powers as their conjugates, and of the tilt and its
        first two derivatives, which are imaginary parts."""
        index = np.fft.fftfreq(SERIES_POINTS, 1.0 / SERIES_POINTS)
        theta = 2.0 * np.pi / self.lobes / SERIES_POINTS * np.arange(SERIES_POINTS)
        tilts = np.array(self.tilts)
        tilt = (tilts @ self._powers(theta, len(tilts))).imag
        slope = np.fft.fft(-self.stretched * np.exp(1j * tilt)) / SERIES_POINTS
        terms = slope / (1j * (1.0 + self.lobes * index))
        kept = np.abs(terms) > 1e-16 * self.radius
        count = max(int(np.abs(index[kept]).max()), len(tilts))
        series = np.zeros((5, count), dtype=complex)
        series[:2] = terms[1 : count + 1], np.conj(terms[: -count - 1 : -1])
        order = 1j * self.lobes * np.arange(1, len(tilts) + 1)
        series[2:, : len(tilts)] = tilts * order ** np.arange(3)[:, None]
        return complex(terms[0]), series

    def at(self, theta: Floats) -> LinePoints:
        """State at the material angles `theta` : (n,) rad."""
        mean, series = self._series
        ahead, behind, *tilts = series @ self._powers(theta, series.shape[1])
        return LinePoints(mean + ahead + np.conj(behind), *(each.imag for each in tilts))

    def tilt(self, theta: Floats) -> tuple[Floats, Floats, Floats]:
        """Tilt L (n,) rad of the tangents at material angles `theta` : (n,) rad, and its first two
        derivatives."""
        return self.at(theta)[1:]

    def position(self, theta: Floats) -> Complex:
        """Points x + i y (n,), mm, at the material angles `theta` : (n,) rad."""
        return np.exp(1j * theta) * self.at(theta).offset

    @property
    def stretch(self) -> float:
        """Strain of the line, which a cam longer than the ring forces on it."""
        return self.stretched / self.radius - 1.0

    @property
    def deflections(self) -> tuple[float, float]:
        """Radial deflections (mm) outwards at the tip of a lobe and midway between two."""
        lobe, valley = np.abs(self.position(np.array([0.0, np.pi / self.lobes]))) - self.radius
        return float(lobe), float(valley)


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
    excess = max(taut_length(cam) / (2.0 * np.pi) - inner_radius, 0.0)
    tilts = share * _RingOnCam(cam, inner_radius, radius, radius + excess, lobes).tilts()
    kept = tilts[: 1 + int(np.flatnonzero(np.abs(tilts) > ROUND_OFF).max(initial=0))]
    return NeutralLine(tuple(map(complex, kept)), radius, radius + share * excess, lobes)
