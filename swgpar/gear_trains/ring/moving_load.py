"""Mean and covariance of a ring under equally spaced loads that move around in it (chapter 6).

Each load is F0 + f sin(w t) + b W(t) with a white noise W of its own, of unit intensity; the harmonic part of load k is
that of the first at the time when the first comes to its place (eq. 6.16). It pushes outward by the sine and along the
motion by the cosine of the pressure angle, as in eq. 3.21 (eq. 6.14 has it against the motion; but the planets drive
the ring along). Damping is proportional, so that the modes of the ring separate; all of them are kept. A step is then
exact for forces that are linear in it and noises that keep their place, and has to resolve the way of the loads alone.

The source takes the stochastic Newmark scheme (eqs 6.28 to 6.32; P. Bernard, G. Fleury, Stochastic Newmark scheme,
Probabilistic Engineering Mechanics 17 (2002) 45-61), whose variance depends on the step unless that resolves the ring's
vibrations: it is the check of this (tests/verification/test_ring.py).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import expm

from swgpar.gear_trains.ring.curved_beam import Ring
from swgpar.gear_trains.ring.design import RingDesign
from swgpar.gear_trains.sample_moments import SampleMoments


@dataclass(frozen=True)
class Response:
    """Outward displacements in the last revolution, at the moving point of the first load and at the middle node.

    Attributes
    ----------
    angle : (rows,) rad, of the first load
    mean, deviation : (rows, 2) m
    """

    angle: np.ndarray
    mean: np.ndarray
    deviation: np.ndarray


def middle_node(design: RingDesign) -> int:
    """The node in the middle between the first two supports, or the one before it."""
    return design.ring.elements // design.supports.count // 2


class MovingLoads:
    """Loads on the modes of a ring."""

    def __init__(self, design: RingDesign) -> None:
        self.load, ring = design.moving_load, Ring.of(design)
        self.frequencies, self.shapes = ring.modes()
        alpha, n = np.radians(self.load.pressure_angle), self.load.steps
        direction = np.array([np.sin(alpha), np.cos(alpha), 0.0])
        # at the ends of all steps, and in their middle for the noise
        at = [ring.interpolation(np.pi * k / n) for k in range(2 * n)]
        self.load_vectors = np.array([direction @ rows for rows in at]) @ self.shapes
        self.outward = np.array([rows[0] for rows in at[::2]]) @ self.shapes
        self.middle = self.shapes[3 * middle_node(design)]

    def forces(self, step: int, time: float, speed: float) -> np.ndarray:
        """Modal forces (modes,) of the steady and harmonic parts at the end of a step, at a time in s."""
        load = self.load
        ahead = 2.0 * np.pi * np.arange(load.loads) / load.loads
        sizes = load.force + load.harmonic * np.sin(load.frequency * (time + ahead / speed))
        return sizes @ self.load_vectors[[self._position_index(2 * step, k) for k in range(load.loads)]]

    def noises(self, step: int) -> np.ndarray:
        """Modal forces (modes, loads) of unit white noises, in the middle of a step."""
        return (
            self.load.noise
            * np.array([self.load_vectors[self._position_index(2 * step - 1, k)] for k in range(self.load.loads)]).T
        )

    def _position_index(self, half_steps: int, number: int) -> int:
        count = len(self.load_vectors)
        return (half_steps + number * count // self.load.loads) % count

    def respond(self, speed: float) -> Response:
        """Go round at a speed (rad/s), from rest at the steady deflection under the loads at their first places."""
        load, n = self.load, self.load.steps
        h = 2.0 * np.pi / speed / n
        modes = ModalStepper(self.frequencies**2, load.damping_mass + load.damping_stiffness * self.frequencies**2, h)
        force = self.forces(0, 0.0, speed)
        q, v = force / modes.k, np.zeros_like(force)
        spread = np.zeros((2, 2, len(q), len(q)))
        mean, deviation = np.empty((n, 2)), np.empty((n, 2))
        for step in range(1, load.revolutions * n + 1):
            before, force = force, self.forces(step % n, step * h, speed)
            q, v = modes.step(q, v, before, force)
            spread = modes.spread(spread, self.noises(step % n))
            row = step - (load.revolutions - 1) * n - 1
            if row >= 0:
                watched = np.stack([self.outward[step % n], self.middle])
                mean[row] = watched @ q
                deviation[row] = np.sqrt(np.maximum(np.einsum("pi,ij,pj->p", watched, spread[0, 0], watched), 0.0))
        return Response(2.0 * np.pi * np.arange(1, n + 1) / n, mean, deviation)

    def quasi_static(self, speed: float) -> np.ndarray:
        """Mean displacements (rows, 2), m, as in `Response` of a ring without inertia and damping."""
        load, n = self.load, self.load.steps
        h, mean = 2.0 * np.pi / speed / n, np.empty((n, 2))
        for row in range(n):
            step = (load.revolutions - 1) * n + row + 1
            force = self.forces(step % n, step * h, speed)
            mean[row] = np.stack([self.outward[step % n], self.middle]) @ (force / self.frequencies**2)
        return mean

    def simulate(self, speed: float, samples: int, random: np.random.Generator) -> SampleMoments:
        """The displacements (rows, 2) of `Response` in `samples` simulations at a speed; noise alone varies."""
        load, n = self.load, self.load.steps
        h = 2.0 * np.pi / speed / n
        modes = ModalStepper(self.frequencies**2, load.damping_mass + load.damping_stiffness * self.frequencies**2, h)
        root = modes.noise_root()
        force = self.forces(0, 0.0, speed)
        q, v = np.tile(force / modes.k, (samples, 1)), np.zeros((samples, len(force)))
        mean, squares = np.empty((n, 2)), np.empty((n, 2))
        for step in range(1, load.revolutions * n + 1):
            before, force = force, self.forces(step % n, step * h, speed)
            q, v = modes.step(q, v, before, force)
            for noise in self.noises(step % n).T:
                shaken = random.standard_normal((samples, root.shape[1])) @ root.T
                q += noise * shaken[:, : len(noise)]
                v += noise * shaken[:, len(noise) :]
            row = step - (load.revolutions - 1) * n - 1
            if row >= 0:
                values = q @ np.stack([self.outward[step % n], self.middle]).T
                mean[row], squares[row] = values.mean(axis=0), values.var(axis=0) * samples
        return SampleMoments(samples, mean, squares, values[:, 1])


class ModalStepper:
    """Separate unit masses with stiffness k and damping c (modes,), moved on by steps of h seconds exactly.

    The force is linear in a step; white noise has unit intensity, one and the same for all modes.
    """

    def __init__(self, k: np.ndarray, c: np.ndarray, h: float) -> None:
        self.k, n = k, len(k)
        rates = np.zeros((n, 2, 2))
        rates[:, 0, 1], rates[:, 1, 0], rates[:, 1, 1] = 1.0, -k, -c
        # of the state (q, v), the force at the start and its growth
        big = np.zeros((n, 4, 4))
        big[:, :2, :2] = rates
        big[:, 1, 2] = 1.0
        big[:, 2, 3] = 1.0 / h
        transition = expm(h * big)
        self.of_state = transition[:, :2, :2].transpose(1, 2, 0)  # (2, 2, modes)
        self.of_start = (transition[:, :2, 2] - transition[:, :2, 3]).T
        self.of_end = transition[:, :2, 3].T
        self.rates = rates

    @cached_property
    def noise(self) -> np.ndarray:
        """Covariance (2, 2, modes, modes) that the noise of a step leaves: of A X + X A^T = E Q E^T - Q."""
        rates = self.rates
        n, eye = len(rates), np.eye(2)
        left = np.einsum("iab,cd->iacbd", rates, eye)[:, None] + np.einsum("ab,jcd->jacbd", eye, rates)[None]
        e = self.of_state[:, 1]  # (2, modes): what becomes of a unit of velocity
        right = np.einsum("ai,bj->ijab", e, e)
        right[:, :, 1, 1] -= 1.0
        solved = np.linalg.solve(left.reshape(n, n, 4, 4), right.reshape(n, n, 4, 1))
        return solved.reshape(n, n, 2, 2).transpose(2, 3, 0, 1)

    def step(self, q: np.ndarray, v: np.ndarray, start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """State (..., modes) after a step in which the forces (modes,) go from `start` to `end`."""
        (qq, qv), (vq, vv) = self.of_state
        p = self.of_start * start + self.of_end * end
        return qq * q + qv * v + p[0], vq * q + vv * v + p[1]

    def spread(self, old: np.ndarray, noises: np.ndarray) -> np.ndarray:
        """Covariance (2, 2, modes, modes) of displacements and velocities after a step with noises (modes, loads)."""
        e, common = self.of_state, noises @ noises.T
        rows = [[e[a, 0][:, None] * old[0, c] + e[a, 1][:, None] * old[1, c] for c in (0, 1)] for a in (0, 1)]
        new = np.empty_like(old)
        for a in (0, 1):
            for c in (0, 1):
                new[a, c] = rows[a][0] * e[c, 0] + rows[a][1] * e[c, 1] + common * self.noise[a, c]
        return new

    def noise_root(self) -> np.ndarray:
        """(2 modes, r): what turns r standard normal numbers into displacements and velocities by unit noise."""
        n = len(self.k)
        values, vectors = np.linalg.eigh(self.noise.transpose(0, 2, 1, 3).reshape(2 * n, 2 * n))
        kept = values > 1e-12 * values[-1]
        return vectors[:, kept] * np.sqrt(values[kept])
