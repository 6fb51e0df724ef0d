"""Mean and covariance of a ring under equally spaced loads that move around in it (chapter 6).

Each load is F0 + f sin(w t) + b W(t) with a white noise W of its own, of unit intensity. The
harmonic part of load k is that of the first load at the time when the first load reaches the
initial position of load k (eq. 6.16). A load acts outward with the sine and along the motion with
the cosine of the pressure angle, as in eq. 3.21. (Eq. 6.14 has it against the motion; but the
planets drive the ring along.) Damping is proportional, so that the modes of the ring separate; all
of them are kept. A step is exact for forces that vary linearly within it and for noise that acts at
the middle of the step. Steps have to resolve only the travel of the loads.

The source takes the stochastic Newmark scheme (eqs 6.28 to 6.32; P. Bernard, G. Fleury, Stochastic
Newmark scheme, Probabilistic Engineering Mechanics 17 (2002) 45-61), whose variance depends on the
step unless that resolves the ring's vibrations: it is the check of this
(tests/verification/test_ring.py).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from swgpar.gear_trains.ring.design import RingDesign
from swgpar.vibration.modal_stepping import ModalStepper
from swgpar.vibration.moments import Moments, SampleMoments


@dataclass(frozen=True)
class Response(Moments):
    """Outward displacements (rows, 2) in the last revolution: moving point of the first load,
    middle node.

    angle : (rows,) rad, of the first load
    """

    angle: np.ndarray


def middle_node(design: RingDesign) -> int:
    """The node in the middle between the first two supports, or the one before it."""
    return design.ring.elements // design.supports.count // 2


class MovingLoads:
    """Loads on the modes of a ring."""

    def __init__(self, design: RingDesign) -> None:
        self.load, ring = design.moving_load, design.elastic_ring()
        self.frequencies, self.shapes = ring.modes()
        alpha, n = np.radians(self.load.pressure_angle), self.load.steps
        direction = np.array([np.sin(alpha), np.cos(alpha), 0.0])
        # at the ends of all steps, and in their middle for the noise
        at = [ring.interpolation(np.pi * k / n) for k in range(2 * n)]
        self.load_vectors = np.array([direction @ rows for rows in at]) @ self.shapes
        self.outward = np.array([rows[0] for rows in at[::2]]) @ self.shapes
        self.middle = self.shapes[3 * middle_node(design)]

    def forces(self, step: int, time: float, speed: float) -> np.ndarray:
        """Modal forces (modes,) of the steady and harmonic parts at the end of a step, at a time in
        s."""
        load = self.load
        ahead = 2.0 * np.pi * np.arange(load.loads) / load.loads
        sizes = load.force + load.harmonic * np.sin(load.frequency * (time + ahead / speed))
        return (
            sizes
            @ self.load_vectors[[self._position_index(2 * step, k) for k in range(load.loads)]]
        )

    def noises(self, step: int) -> np.ndarray:
        """Modal forces (modes, loads) of unit white noises, in the middle of a step."""
        return (
            self.load.noise
            * np.array(
                [
                    self.load_vectors[self._position_index(2 * step - 1, k)]
                    for k in range(self.load.loads)
                ]
            ).T
        )

    def _position_index(self, half_steps: int, number: int) -> int:
        count = len(self.load_vectors)
        return (half_steps + number * count // self.load.loads) % count

    def respond(self, speed: float) -> Response:
        """Response at a speed (rad/s), from the static deflection under the loads at their initial
        positions."""
        load, n = self.load, self.load.steps
        h = 2.0 * np.pi / speed / n
        modes = ModalStepper(
            self.frequencies**2, load.damping_mass + load.damping_stiffness * self.frequencies**2, h
        )
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
                monitored = np.stack([self.outward[step % n], self.middle])
                mean[row] = monitored @ q
                deviation[row] = np.sqrt(
                    np.maximum(np.einsum("pi,ij,pj->p", monitored, spread[0, 0], monitored), 0.0)
                )
        return Response(mean, deviation, 2.0 * np.pi * np.arange(1, n + 1) / n)

    def quasi_static(self, speed: float) -> np.ndarray:
        """Mean displacements (rows, 2), m, as in `Response` of a ring without inertia and
        damping."""
        load, n = self.load, self.load.steps
        h, mean = 2.0 * np.pi / speed / n, np.empty((n, 2))
        for row in range(n):
            step = (load.revolutions - 1) * n + row + 1
            force = self.forces(step % n, step * h, speed)
            mean[row] = np.stack([self.outward[step % n], self.middle]) @ (
                force / self.frequencies**2
            )
        return mean

    def simulate(self, speed: float, samples: int, random: np.random.Generator) -> SampleMoments:
        """The displacements (rows, 2) of `Response` in `samples` simulations at a speed; noise
        alone varies."""
        load, n = self.load, self.load.steps
        h = 2.0 * np.pi / speed / n
        modes = ModalStepper(
            self.frequencies**2, load.damping_mass + load.damping_stiffness * self.frequencies**2, h
        )
        root = modes.noise_root()
        force = self.forces(0, 0.0, speed)
        q, v = np.tile(force / modes.k, (samples, 1)), np.zeros((samples, len(force)))

        def rows() -> Iterator[np.ndarray]:
            nonlocal q, v, force
            for step in range(1, load.revolutions * n + 1):
                before, force = force, self.forces(step % n, step * h, speed)
                q, v = modes.step(q, v, before, force)
                for noise in self.noises(step % n).T:
                    shaken = random.standard_normal((samples, root.shape[1])) @ root.T
                    q += noise * shaken[:, : len(noise)]
                    v += noise * shaken[:, len(noise) :]
                if step > (load.revolutions - 1) * n:
                    yield np.stack([self.outward[step % n], self.middle]) @ q.T

        return SampleMoments.of(rows())
